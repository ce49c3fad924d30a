#include <cmath>

#include "ngs/core/error.h"
#include "ngs/io/ply/gaussian_columns.h"
#include "ngs/math/sh.h"

namespace ngs::io {
namespace {

constexpr std::int64_t kChunkRows = 256;

double unorm(std::uint32_t value, int shift, int bits) {
  const std::uint32_t top = (1u << bits) - 1;
  return double((value >> shift) & top) / double(top);
}

double mix(double low, double high, double t) { return low * (1 - t) + high * t; }

struct Range {
  std::array<PlyColumn, 3> low, high;
  double at(std::int64_t chunk, std::size_t axis, double t) const {
    return mix(low[axis].value(chunk), high[axis].value(chunk), t);
  }
};

class Decoder {
 public:
  explicit Decoder(const PlyFile& file)
      : name_(file.name()), chunks_(file.table(*file.find("chunk"))), rows_(file.table(*file.find("vertex"))) {
    const std::int64_t expected = rows_.rows / kChunkRows + (rows_.rows % kChunkRows != 0);
    if (chunks_.rows < expected)
      bad(std::to_string(chunks_.rows) + " chunks, expected " + std::to_string(expected) + " for " +
          std::to_string(rows_.rows) + " Gaussians");
    position_ = range("", {"x", "y", "z"});
    scale_ = range("scale_", {"x", "y", "z"});
    has_colour_range_ = chunks_.find("min_r") >= 0;
    if (has_colour_range_) colour_ = range("", {"r", "g", "b"});
    packed_ = {packed("packed_position"), packed("packed_rotation"), packed("packed_scale"), packed("packed_color")};
    if (file.find("sh") != nullptr) {
      sh_ = file.table(*file.find("sh"));
      if (sh_.rows != rows_.rows)
        bad(std::to_string(sh_.rows) + " rows of 'sh', expected " + std::to_string(rows_.rows));
      for (std::size_t k = 0; sh_.column("f_rest_" + std::to_string(k)); ++k)
        rest_.push_back(sh_.column("f_rest_" + std::to_string(k)));
      if (rest_.size() != 0 && rest_.size() != 9 && rest_.size() != 24 && rest_.size() != 45 &&
          excess_sh_degree(rest_.size()) == 0)
        bad(std::to_string(rest_.size()) + " properties f_rest_*, expected 0, 9, 24 or 45 (SH degree 0 to 3)");
    }
  }

  PlyTable decode() const {
    PlyTable table;
    std::vector<PlyProperty> properties;
    for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2"}) properties.push_back({.name = name});
    for (std::size_t k = 0; k < rest_.size(); ++k) properties.push_back({.name = "f_rest_" + std::to_string(k)});
    for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"})
      properties.push_back({.name = name});
    table.set_properties(std::move(properties));
    table.rows = rows_.rows;
    table.owned.resize(std::size_t(table.rows) * table.row_bytes);
    std::vector<float> row;
    for (std::int64_t i = 0; i < table.rows; ++i) {
      row.clear();
      decode_row(i, row);
      std::memcpy(table.owned.data() + std::size_t(i) * table.row_bytes, row.data(), table.row_bytes);
    }
    return table;
  }

 private:
  [[noreturn]] void bad(const std::string& message) const { throw Error(ErrorCode::kBadInput, name_ + ": " + message); }

  Range range(const std::string& prefix, const std::array<const char*, 3>& axes) const {
    Range r;
    for (std::size_t a = 0; a < 3; ++a) {
      r.low[a] = chunks_.column("min_" + prefix + axes[a]);
      r.high[a] = chunks_.column("max_" + prefix + axes[a]);
      if (!r.low[a] || !r.high[a]) bad("chunk property 'min_" + prefix + axes[a] + "' or its maximum is missing");
    }
    return r;
  }

  PlyColumn packed(const std::string& column) const {
    const PlyColumn found = rows_.column(column);
    if (!found || (found.type != PlyType::kUint32 && found.type != PlyType::kInt32))
      bad("vertex property '" + column + "' of type uint is missing");
    return found;
  }

  std::uint32_t word(std::size_t p, std::int64_t i) const {
    std::uint32_t v;
    std::memcpy(&v, packed_[p].first + std::size_t(i) * packed_[p].stride, sizeof v);
    return v;
  }

  // 11, 10 and 11 bits; the first axis has the highest bits.
  static void push_range(const Range& range, std::int64_t chunk, std::uint32_t v, std::vector<float>& row) {
    row.push_back(float(range.at(chunk, 0, unorm(v, 21, 11))));
    row.push_back(float(range.at(chunk, 1, unorm(v, 11, 10))));
    row.push_back(float(range.at(chunk, 2, unorm(v, 0, 11))));
  }

  // The two highest bits are the index of the largest of (w, x, y, z); the other three follow in order, in ±1/√2.
  static void push_rotation(std::uint32_t v, std::vector<float>& row) {
    const double a[3] = {(unorm(v, 20, 10) - 0.5) * std::sqrt(2.0), (unorm(v, 10, 10) - 0.5) * std::sqrt(2.0),
                         (unorm(v, 0, 10) - 0.5) * std::sqrt(2.0)};
    const double largest = std::sqrt(std::max(0.0, 1 - (a[0] * a[0] + a[1] * a[1] + a[2] * a[2])));
    for (std::uint32_t k = 0, next = 0; k < 4; ++k) row.push_back(float(k == (v >> 30) ? largest : a[next++]));
  }

  void decode_row(std::int64_t i, std::vector<float>& row) const {
    const std::int64_t chunk = i / kChunkRows;
    push_range(position_, chunk, word(0, i), row);
    const std::uint32_t packed_colour = word(3, i);
    for (std::size_t c = 0; c < 3; ++c) {
      const double t = unorm(packed_colour, 24 - 8 * int(c), 8);
      row.push_back(float(dc_of_colour(has_colour_range_ ? colour_.at(chunk, c, t) : t)));
    }
    for (const PlyColumn& column : rest_) {
      const double v = column.value(i);  // the ends are exact, other values decode to the centre of a step
      row.push_back(float(((v <= 0 ? 0 : v >= 255 ? 1 : (v + 0.5) / 256) - 0.5) * 8));
    }
    const double alpha = unorm(packed_colour, 0, 8);
    row.push_back(float(std::log(alpha) - std::log1p(-alpha)));  // 0 and 1 give -Inf and +Inf, which are valid
    push_range(scale_, chunk, word(2, i), row);
    push_rotation(word(1, i), row);
  }

  std::string name_;
  PlyTable chunks_, rows_, sh_;
  Range position_, scale_, colour_;
  bool has_colour_range_ = false;
  std::array<PlyColumn, 4> packed_;
  std::vector<PlyColumn> rest_;
};

}  // namespace

bool is_compressed(const PlyFile& file) {
  const PlyElement* vertex = file.find("vertex");
  if (vertex == nullptr || file.find("chunk") == nullptr) return false;
  for (const PlyProperty& p : vertex->properties)
    if (p.name == "packed_position") return true;
  return false;
}

PlyTable decode_compressed(const PlyFile& file) { return Decoder(file).decode(); }

}  // namespace ngs::io
