// Definitions shared by the reader and the writer of .sog.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

#include "ngs/core/error.h"
#include "ngs/core/version.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/formats/compression/codebook.h"
#include "ngs/io/formats/compression/webp_image.h"
#include "ngs/io/formats/compression/zip_archive.h"
#include "ngs/io/formats/quantise.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/formats/splat_table.h"
#include "ngs/math/stable.h"

namespace ngs::io {
namespace {

constexpr std::size_t kPaletteColumns = 64, kMaxPalette = 65536;
constexpr double kMaxWord = 65535, kMaxByte = 255;
constexpr int kFirstMode = 252;  // of quaternions

/// Components of (w, x, y, z) other than the largest, in file order.
constexpr std::array<std::array<std::size_t, 3>, 4> kOthers = {{{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};

/// Positions are stored as sign(p) ln(1 + |p|): the step grows with |p|.
double compressed(double p) {
  // ln(1 + x) by Kahan's correction of the logarithm: unlike log1p of a double it hardly differs between C libraries.
  const double x = std::abs(p), sum = 1 + x;
  return std::copysign(sum > 1 ? std::log(sum) * (x / (sum - 1)) : x, p);
}
double expanded(double c) { return std::copysign(std::expm1(std::abs(c)), c); }

/// Decodes a stored number `v` in 0..`most` to the range `low`..`high`.
double between(double low, double high, double v, double most) { return low + (high - low) * (v / most); }

using nlohmann::json;

/// meta.json with checked access.
class Meta {
 public:
  Meta(std::string name, json value) : name_(std::move(name)), value_(std::move(value)) {
    if (!value_.is_object()) bad("not a JSON object, expected the meta.json of a .sog");
  }

  [[noreturn]] void bad(const std::string& message) const {
    throw Error(ErrorCode::kBadInput, name_ + ": " + message, "copy or export it again");
  }

  const json& root() const { return value_; }
  bool has(const char* part) const { return value_.contains(part); }

  const json& at(const char* part, const char* key) const {
    if (!value_.contains(part) || !value_[part].is_object() || !value_[part].contains(key))
      bad("'" + std::string(part) + "." + key + "' is missing, expected a complete description");
    return value_[part][key];
  }

  std::vector<double> numbers(const char* part, const char* key, std::size_t count) const {
    const json& list = at(part, key);
    std::vector<double> numbers;
    if (list.is_number() && count == 1) return {list.get<double>()};
    if (list.is_array())
      for (const json& v : list)
        if (v.is_number()) numbers.push_back(v.get<double>());
    if (numbers.size() != count || list.size() != count)
      bad("'" + std::string(part) + "." + key + "' holds " + std::to_string(numbers.size()) + " numbers, expected " +
          std::to_string(count));
    return numbers;
  }

  std::string file(const char* part, std::size_t which) const {
    const json& files = at(part, "files");
    if (!files.is_array() || files.size() <= which || !files[which].is_string())
      bad("'" + std::string(part) + ".files' has no name at " + std::to_string(which) + ", expected one per picture");
    return files[which].get<std::string>();
  }

  std::uint64_t whole_number(const json& value, const std::string& what, std::uint64_t most) const {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() > most)
      bad(what + " " + value.dump().substr(0, 40) + ", expected a whole number up to " + std::to_string(most));
    return value.get<std::uint64_t>();
  }

 private:
  std::string name_;
  json value_;
};

/// Decodes a byte of a file: by a codebook, or linearly between two ends.
using Values = std::array<double, 256>;

Values spread_between(double low, double high) {
  Values values;
  for (std::size_t v = 0; v < values.size(); ++v) values[v] = between(low, high, double(v), kMaxByte);
  return values;
}

class SogReader {
 public:
  SogReader(const std::string& name, Bytes bytes)
      : name_(name), bytes_(bytes), zip_(name, bytes), meta_(name + ": meta.json", read_meta()) {
    version_ = meta_.has("version") ? meta_.whole_number(meta_.root()["version"], "version", 1000) : 1;
    if (version_ != 1 && version_ != 2) meta_.bad("version " + std::to_string(version_) + " of .sog, expected 1 or 2");
    constexpr std::uint64_t kMaxCount = std::uint64_t(kMaxWebpSide_px) * kMaxWebpSide_px;
    if (version_ == 2 && !meta_.has("count")) meta_.bad("'count' is missing, expected the number of Gaussians");
    const json& shape = version_ == 1 ? meta_.at("means", "shape") : meta_.root()["count"];
    if (version_ == 1 && (!shape.is_array() || shape.empty()))
      meta_.bad("'means.shape' is not a list, expected [N, 3]");
    count_ = meta_.whole_number(version_ == 1 ? shape[0] : shape, "count", kMaxCount);
    constexpr std::uint64_t kTextures = 5;
    check_expansion(name, count_ * kTextures * 4, bytes.size());
  }

  DecodedSplat decode() {
    read_textures();
    DecodedSplat decoded;
    decoded.rows = splat_table(std::int64_t(count_), degree_);
    for (std::size_t i = 0; i < count_; ++i) store_row(decoded.rows, std::int64_t(i), row(i));
    const json& root = meta_.root();
    decoded.antialiased =
        (meta_.has("antialias") && root["antialias"] == true) || (meta_.has("model") && root["model"] == "antialiased");
    decoded.notes.push_back(".sog: attributes are quantised");
    return decoded;
  }

 private:
  json read_meta() const {
    constexpr std::size_t kMaxMetaBytes = std::size_t(1) << 20;
    const std::vector<std::uint8_t> text = zip_.read("meta.json", kMaxMetaBytes);
    return parse_json({reinterpret_cast<const char*>(text.data()), text.size()}, name_ + ": meta.json");
  }

  RgbaImage picture(const char* part, std::size_t which, std::size_t max_texels) const {
    const std::string file = meta_.file(part, which);
    return decode_webp(name_ + ": " + file, zip_.read(file, bytes_.size()), max_texels);
  }

  /// An image with at least one texel per Gaussian, and not many more.
  RgbaImage texture(const char* part, std::size_t which) const {
    RgbaImage table = picture(part, which, 2 * count_ + kMaxPalette);
    if (table.texels() < count_)
      meta_.bad("'" + meta_.file(part, which) + "' has " + std::to_string(table.texels()) +
                " pixels, expected at least " + std::to_string(count_));
    return table;
  }

  Values codebook(const char* part) const {
    Values values;
    const std::vector<double> listed = meta_.numbers(part, "codebook", values.size());
    std::copy(listed.begin(), listed.end(), values.begin());
    return values;
  }

  void read_textures() {
    means_low_ = texture("means", 0);
    means_high_ = texture("means", 1);
    mins_ = meta_.numbers("means", "mins", 3);
    maxs_ = meta_.numbers("means", "maxs", 3);
    quats_ = texture("quats", 0);
    scales_ = texture("scales", 0);
    sh0_ = texture("sh0", 0);
    if (version_ == 2) {
      scale_values_.fill(codebook("scales"));
      colour_values_.fill(codebook("sh0"));
    } else {
      const auto low = meta_.numbers("scales", "mins", 3), high = meta_.numbers("scales", "maxs", 3);
      const auto low0 = meta_.numbers("sh0", "mins", 4), high0 = meta_.numbers("sh0", "maxs", 4);
      for (std::size_t a = 0; a < 3; ++a) {
        scale_values_[a] = spread_between(low[a], high[a]);
        colour_values_[a] = spread_between(low0[a], high0[a]);
      }
      logit_values_ = spread_between(low0[3], high0[3]);
    }
    if (meta_.has("shN") && !meta_.root()["shN"].is_null()) read_palette();
  }

  void read_palette() {
    centroids_ = picture("shN", 0, kMaxPalette * sh_rest_count(3));
    labels_ = texture("shN", 1);
    for (int degree = 1; degree <= 3; ++degree)
      if (std::size_t(centroids_.width) == kPaletteColumns * std::size_t(sh_rest_count(degree))) degree_ = degree;
    if (degree_ == 0)
      meta_.bad("'" + meta_.file("shN", 0) + "' is " + std::to_string(centroids_.width) +
                " pixels wide, expected 192, 512 or 960 (SH degree 1 to 3)");
    if (version_ == 2 && meta_.whole_number(meta_.at("shN", "bands"), "shN.bands", 3) != std::uint64_t(degree_))
      meta_.bad("'shN.bands' contradicts the width of '" + meta_.file("shN", 0) + "', expected " +
                std::to_string(degree_));
    rest_values_ = version_ == 2
                       ? codebook("shN")
                       : spread_between(meta_.numbers("shN", "mins", 1)[0], meta_.numbers("shN", "maxs", 1)[0]);
  }

  SplatRow row(std::size_t i) const {
    SplatRow row;
    for (std::size_t a = 0; a < 3; ++a) {
      const double word = double(means_low_.texel(i)[a]) + 256.0 * means_high_.texel(i)[a];
      row.position[a] = float(expanded(between(mins_[a], maxs_[a], word, kMaxWord)));
      row.log_scale[a] = float(scale_values_[a][scales_.texel(i)[a]]);
      row.sh_dc[a] = float(colour_values_[a][sh0_.texel(i)[a]]);
    }
    row.rotation = rotation(i);
    const std::uint8_t opacity = sh0_.texel(i)[3];
    row.logit_opacity = logit_values_ ? float((*logit_values_)[opacity]) : logit_of_alpha_byte(opacity);
    if (degree_ > 0) read_sh(i, row);
    return row;
  }

  std::array<float, 4> rotation(std::size_t i) const {
    const std::uint8_t* texel = quats_.texel(i);
    if (texel[3] < kFirstMode)
      meta_.bad("'" + meta_.file("quats", 0) + "' has " + std::to_string(texel[3]) + " as the mode of Gaussian " +
                std::to_string(i) + ", expected 252 to 255");
    const std::size_t largest = std::size_t(texel[3] - kFirstMode);
    double v[3];
    for (std::size_t k = 0; k < 3; ++k) v[k] = between(-1, 1, texel[k], kMaxByte) * std::sqrt(0.5);
    std::array<float, 4> q{};
    for (std::size_t k = 0; k < 3; ++k) q[kOthers[largest][k]] = float(v[k]);
    q[largest] = float(left_out_component(v[0], v[1], v[2]));
    return q;
  }

  void read_sh(std::size_t i, SplatRow& row) const {
    const std::size_t label = labels_.texel(i)[0] + 256u * labels_.texel(i)[1];
    const std::size_t coefficients = std::size_t(sh_rest_count(degree_));
    if (label / kPaletteColumns >= std::size_t(centroids_.height))
      meta_.bad("label " + std::to_string(label) + " of Gaussian " + std::to_string(i) + ", expected less than " +
                std::to_string(kPaletteColumns * std::size_t(centroids_.height)));
    const std::size_t first =
        label / kPaletteColumns * std::size_t(centroids_.width) + label % kPaletteColumns * coefficients;
    for (std::size_t k = 0; k < coefficients; ++k)
      for (std::size_t c = 0; c < 3; ++c) row.sh_rest[k * 3 + c] = float(rest_values_[centroids_.texel(first + k)[c]]);
  }

  const std::string& name_;
  Bytes bytes_;
  ZipReader zip_;
  Meta meta_;
  std::uint64_t version_ = 0, count_ = 0;
  int degree_ = 0;
  RgbaImage means_low_, means_high_, quats_, scales_, sh0_, centroids_, labels_;
  std::vector<double> mins_, maxs_;
  std::array<Values, 3> scale_values_{}, colour_values_{};
  Values rest_values_{};
  std::optional<Values> logit_values_;  // version 1
};

using nlohmann::ordered_json;

class SogWriter {
 public:
  explicit SogWriter(const SplatSelection& model) : model_(model), count_(model.rows.size()) {
    // A nearly square image of 4 x 4 texel blocks.
    width_ = std::max(4, int(std::ceil(std::sqrt(double(count_)) / 4)) * 4);
    height_ = std::max(4, int(std::ceil(double(count_) / double(width_) / 4)) * 4);
    if (width_ > kMaxWebpSide_px || height_ > kMaxWebpSide_px)
      throw Error(ErrorCode::kUsage, std::to_string(count_) + " Gaussians, a .sog holds up to 268 million",
                  "write the model as PLY");
    meta_ = {{"version", 2}, {"asset", {{"generator", std::string("ngs ") + kVersion}}}, {"count", count_}};
    if (model.cloud.antialiased) {
      meta_["antialias"] = true;
      meta_["model"] = "antialiased";
    }
  }

  std::vector<std::uint8_t> encode() {
    add_means();
    add_scales();
    add_quats();
    add_colours();
    if (model_.cloud.sh_degree > 0 && count_ > 0) add_sh();
    const std::string text = meta_.dump();
    entries_.insert(entries_.begin(), {"meta.json", {text.begin(), text.end()}});
    return zip(entries_);
  }

 private:
  SplatRow row(std::size_t i) const { return load_row(model_, model_.rows[i]); }

  RgbaImage texture() const {
    RgbaImage table{width_, height_, std::vector<std::uint8_t>(std::size_t(width_) * std::size_t(height_) * 4)};
    for (std::size_t i = 0; i < table.texels(); ++i) table.texel(i)[3] = 255;
    return table;
  }

  void add_picture(const std::string& name, const RgbaImage& table) { entries_.push_back({name, encode_webp(table)}); }

  void add_means() {
    std::array<double, 3> low, high;
    low.fill(INFINITY);
    high.fill(-INFINITY);
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t a = 0; a < 3; ++a) {
        const double c = compressed(row(i).position[a]);
        low[a] = std::min(low[a], c);
        high[a] = std::max(high[a], c);
      }
    if (count_ == 0) {
      low.fill(0);
      high.fill(0);
    }
    RgbaImage lower = texture(), upper = texture();
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t a = 0; a < 3; ++a) {
        const double span = high[a] - low[a], c = compressed(row(i).position[a]);
        const auto word = std::uint32_t(std::lround(span > 0 ? clamp3((c - low[a]) / span, 0.0, 1.0) * kMaxWord : 0));
        lower.texel(i)[a] = std::uint8_t(word & 255);
        upper.texel(i)[a] = std::uint8_t(word >> 8);
      }
    meta_["means"] = {{"mins", low}, {"maxs", high}, {"files", {"means_l.webp", "means_u.webp"}}};
    add_picture("means_l.webp", lower);
    add_picture("means_u.webp", upper);
  }

  /// Fits the codebook of an attribute with three values, and appends each value's index to `table`.
  Codebook add_by_codebook(std::array<float, 3> SplatRow::*attribute, RgbaImage& table) const {
    std::vector<float> values;
    for (std::size_t i = 0; i < count_; ++i) {
      const std::array<float, 3> three = row(i).*attribute;
      values.insert(values.end(), three.begin(), three.end());
    }
    const Codebook codebook = fit_codebook(values);
    for (std::size_t i = 0; i < values.size(); ++i) table.texel(i / 3)[i % 3] = nearest_in(codebook, values[i]);
    return codebook;
  }

  void add_scales() {
    RgbaImage table = texture();
    meta_["scales"] = {{"codebook", add_by_codebook(&SplatRow::log_scale, table)}, {"files", {"scales.webp"}}};
    add_picture("scales.webp", table);
  }

  void add_quats() {
    RgbaImage table = texture();
    for (std::size_t i = 0; i < count_; ++i) {
      const std::array<float, 4> q = row(i).rotation;
      const std::size_t largest = largest_component(q);
      const double scale = (q[largest] < 0 ? -1 : 1) * std::sqrt(2.0);
      for (std::size_t k = 0; k < 3; ++k)
        table.texel(i)[k] = to_byte((q[kOthers[largest][k]] * scale * 0.5 + 0.5) * kMaxByte);
      table.texel(i)[3] = std::uint8_t(kFirstMode + int(largest));
    }
    meta_["quats"] = {{"files", {"quats.webp"}}};
    add_picture("quats.webp", table);
  }

  void add_colours() {
    RgbaImage table = texture();
    meta_["sh0"] = {{"codebook", add_by_codebook(&SplatRow::sh_dc, table)}, {"files", {"sh0.webp"}}};
    for (std::size_t i = 0; i < count_; ++i) table.texel(i)[3] = alpha_byte(row(i).logit_opacity);
    add_picture("sh0.webp", table);
  }

  void add_sh() {
    const std::size_t coefficients = std::size_t(model_.cloud.rest_count()), columns = coefficients * 3;
    std::vector<float> table;
    for (std::size_t i = 0; i < count_; ++i) {
      const SplatRow values = row(i);
      table.insert(table.end(), values.sh_rest.begin(), values.sh_rest.begin() + std::ptrdiff_t(columns));
    }
    const RowPalette palette = fit_palette(table, columns, kMaxPalette);
    const Codebook codebook = fit_codebook(palette.rows);
    const std::size_t size = palette.rows.size() / columns;
    RgbaImage labels = texture(),
              centroids{int(kPaletteColumns * coefficients),
                        int(std::max<std::size_t>(1, (size + kPaletteColumns - 1) / kPaletteColumns)),
                        {}};
    centroids.bytes.assign(centroids.texels() * 4, 255);
    for (std::size_t p = 0; p < palette.rows.size(); ++p)
      centroids.texel(p / 3)[p % 3] = nearest_in(codebook, palette.rows[p]);
    for (std::size_t i = 0; i < count_; ++i) {
      labels.texel(i)[0] = std::uint8_t(palette.label[i] & 255);
      labels.texel(i)[1] = std::uint8_t(palette.label[i] >> 8);
    }
    meta_["shN"] = {{"count", size},
                    {"bands", model_.cloud.sh_degree},
                    {"codebook", codebook},
                    {"files", {"shN_centroids.webp", "shN_labels.webp"}}};
    add_picture("shN_centroids.webp", centroids);
    add_picture("shN_labels.webp", labels);
  }

  SplatSelection model_;
  std::size_t count_;
  int width_ = 0, height_ = 0;
  ordered_json meta_;
  std::vector<ZipEntry> entries_;
};

}  // namespace

DecodedSplat decode_sog(const std::string& name, Bytes bytes) { return SogReader(name, bytes).decode(); }

std::vector<std::uint8_t> encode_sog(const SplatSelection& model) {
  return SogWriter(along_morton_curve(model)).encode();
}

}  // namespace ngs::io
