#include <algorithm>
#include <limits>
#include <span>

#include "ngs/io/formats/quantise.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/formats/splat_table.h"
#include "ngs/math/median.h"
#include "ngs/scene/precision/local_origin.h"

namespace ngs::io {
namespace {

constexpr std::size_t kChunkRows = 256;

/// Position, ln scale and rgb of a row: the values that are quantised within the chunk's range.
using Ranged = std::array<float, 9>;

Ranged ranged_of(const SplatRow& row) {
  Ranged values;
  for (std::size_t a = 0; a < 3; ++a) {
    values[a] = row.position[a];
    values[3 + a] = row.log_scale[a];
    values[6 + a] = float(colour_of_dc(double(row.sh_dc[a])));
  }
  return values;
}

struct Chunk {
  Ranged low, high;

  explicit Chunk(const std::vector<SplatRow>& rows) {
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
    for (const SplatRow& row : rows) {
      const Ranged values = ranged_of(row);
      for (std::size_t k = 0; k < values.size(); ++k) {
        low[k] = std::min(low[k], values[k]);
        high[k] = std::max(high[k], values[k]);
      }
    }
  }
  /// Value k, quantised within its range to `bits` bits.
  std::uint32_t within(std::size_t k, float value, int bits) const {
    const double span = double(high[k]) - double(low[k]), most = double((1u << bits) - 1);
    return span > 0 ? std::uint32_t(std::lround((double(value) - double(low[k])) / span * most)) : 0;
  }
  /// Three values from k on, packed in 11, 10 and 11 bits.
  std::uint32_t three(std::size_t k, const Ranged& values) const {
    return within(k, values[k], 11) << 21 | within(k + 1, values[k + 1], 10) << 11 | within(k + 2, values[k + 2], 11);
  }
};

/// The two highest bits are the index of the largest of (w, x, y, z); the other three follow in order, in ±√½.
std::uint32_t packed_rotation(const std::array<float, 4>& q) {
  const std::size_t largest = largest_component(q);
  std::uint32_t bits = std::uint32_t(largest);
  for (std::size_t k = 0; k < 4; ++k) {
    if (k == largest) continue;
    const double signed_value = q[largest] < 0 ? -double(q[k]) : double(q[k]);
    bits = bits << 10 | std::uint32_t(std::lround(clamp3(signed_value * std::sqrt(0.5) + 0.5, 0.0, 1.0) * 1023));
  }
  return bits;
}

std::uint32_t packed_colour(const Chunk& chunk, const Ranged& values, float logit_opacity) {
  std::uint32_t bits = 0;
  for (std::size_t k = 6; k < 9; ++k) bits = bits << 8 | chunk.within(k, values[k], 8);
  return bits << 8 | alpha_byte(logit_opacity);
}

/// Steps of 1/32 from -4 to 4; the reader decodes the centre of a step.
std::uint8_t sh_byte(float value) {
  return std::uint8_t(clamp3(std::floor((double(value) / 8 + 0.5) * 256), 0.0, 255.0));
}

std::string header_of(const SplatSelection& model) {
  const std::string count = std::to_string(model.rows.size());
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  if (model.cloud.antialiased) text += "comment antialiased 1\n";
  text += "element chunk " + std::to_string((model.rows.size() + kChunkRows - 1) / kChunkRows) + "\n";
  const auto add = [&](const std::string& type, const std::string& prefix, const std::string& axes) {
    for (const char* end : {"min_", "max_"})
      for (const char axis : axes) text += "property " + type + " " + end + prefix + axis + "\n";
  };
  add("float", "", "xyz");
  add("float", "scale_", "xyz");
  add("float", "", "rgb");
  text += "element vertex " + count + "\n";
  for (const char* name : {"position", "rotation", "scale", "color"})
    text += "property uint packed_" + std::string(name) + "\n";
  if (model.cloud.sh_degree > 0) text += "element sh " + count + "\n";
  for (int k = 0; k < 3 * model.cloud.rest_count(); ++k) text += "property uchar f_rest_" + std::to_string(k) + "\n";
  return text + "end_header\n";
}

/// The widest position step over the axes of a chunk, and the row that is farthest from the others along that axis.
Rounding widest_axis(const SplatSelection& model, std::span<const std::int64_t> rows) {
  constexpr double kSteps[] = {2047, 1023, 2047};
  Rounding widest{.rows = std::ssize(rows)};
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<double> values;
    for (const std::int64_t i : rows) values.push_back(double(load_row(model, i).position[a]));
    const auto [low, high] = std::ranges::minmax_element(values);
    if ((*high - *low) / kSteps[a] <= widest.step) continue;
    const double middle = upper_median(values);
    const auto far = *high - middle > middle - *low ? high : low;
    widest.step = (*high - *low) / kSteps[a];
    widest.farthest = rows[std::size_t(far - values.begin())];
    widest.coordinate = *far;
  }
  return widest;
}

class Encoder {
 public:
  explicit Encoder(const SplatSelection& model) : coefficients_(std::size_t(model.cloud.rest_count())) {
    const std::string header = header_of(model);
    bytes_.assign(header.begin(), header.end());
    std::vector<SplatRow> rows;
    for (std::size_t i = 0; i < model.rows.size(); ++i) {
      rows.push_back(load_row(model, model.rows[i]));
      if (rows.size() == kChunkRows || i + 1 == model.rows.size()) {
        add(rows);
        rows.clear();
      }
    }
    bytes_.insert(bytes_.end(), vertices_.begin(), vertices_.end());
    bytes_.insert(bytes_.end(), sh_.begin(), sh_.end());
  }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  template <class T>
  static void append(std::vector<std::uint8_t>& to, const T& value) {
    const auto* from = reinterpret_cast<const std::uint8_t*>(&value);
    to.insert(to.end(), from, from + sizeof value);
  }

  void add(const std::vector<SplatRow>& rows) {
    const Chunk chunk(rows);
    for (std::size_t group = 0; group < 9; group += 3)
      for (const Ranged& end : {chunk.low, chunk.high})
        for (std::size_t a = 0; a < 3; ++a) append(bytes_, end[group + a]);
    for (const SplatRow& row : rows) {
      const Ranged values = ranged_of(row);
      append(vertices_, chunk.three(0, values));
      append(vertices_, packed_rotation(row.rotation));
      append(vertices_, chunk.three(3, values));
      append(vertices_, packed_colour(chunk, values, row.logit_opacity));
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t k = 0; k < coefficients_; ++k) sh_.push_back(sh_byte(row.sh_rest[k * 3 + c]));
    }
  }

  std::size_t coefficients_;
  std::vector<std::uint8_t> bytes_, vertices_, sh_;
};

}  // namespace

std::vector<std::uint8_t> encode_compressed_ply(const SplatSelection& model) {
  return Encoder(along_morton_curve(model)).take();
}

Rounding compressed_ply_rounding(const SplatSelection& model) {
  const double usual = usual_size(model.cloud);
  const SplatSelection sorted = along_morton_curve(model);
  Rounding coarse;
  for (std::size_t begin = 0; begin < sorted.rows.size(); begin += kChunkRows) {
    const std::span<const std::int64_t> chunk(&sorted.rows[begin], std::min(kChunkRows, sorted.rows.size() - begin));
    const Rounding widest = widest_axis(sorted, chunk);
    if (0.5 * widest.step <= usual) continue;
    const std::int64_t rows = coarse.rows + widest.rows;
    if (widest.step > coarse.step) coarse = widest;
    coarse.rows = rows;
  }
  return coarse;
}

}  // namespace ngs::io
