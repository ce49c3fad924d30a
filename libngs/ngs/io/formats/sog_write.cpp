#include <algorithm>
#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/core/version.h"
#include "ngs/io/formats/compression/codebook.h"
#include "ngs/io/formats/compression/webp_image.h"
#include "ngs/io/formats/compression/zip_archive.h"
#include "ngs/io/formats/quantise.h"
#include "ngs/io/formats/sog_layout.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/formats/splat_table.h"

namespace ngs::io {
namespace {

using namespace sog;
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
    if (model.cloud.antialiased) meta_["antialias"] = true, meta_["model"] = "antialiased";
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
    low.fill(INFINITY), high.fill(-INFINITY);
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t a = 0; a < 3; ++a) {
        const double c = compressed(row(i).position[a]);
        low[a] = std::min(low[a], c), high[a] = std::max(high[a], c);
      }
    if (count_ == 0) low.fill(0), high.fill(0);
    RgbaImage lower = texture(), upper = texture();
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t a = 0; a < 3; ++a) {
        const double span = high[a] - low[a], c = compressed(row(i).position[a]);
        const auto word = std::uint32_t(std::lround(span > 0 ? clamp3((c - low[a]) / span, 0.0, 1.0) * kMaxWord : 0));
        lower.texel(i)[a] = std::uint8_t(word & 255), upper.texel(i)[a] = std::uint8_t(word >> 8);
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
    const Palette palette = fit_palette(table, columns, kMaxPalette);
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

std::vector<std::uint8_t> encode_sog(const SplatSelection& model) {
  return SogWriter(along_morton_curve(model)).encode();
}

}  // namespace ngs::io
