#include <algorithm>

#include "ngs/io/formats/axes.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/formats/write_only/usda_text.h"
#include "ngs/math/sh.h"
#include "ngs/math/stable.h"

namespace ngs::io {
namespace {

/// Standard deviations from a centre to the border of the extent: alpha is below 1/255 there at any opacity.
constexpr float kExtentSigmas = 3.4f;

class UsdaEncoder {
 public:
  UsdaEncoder(const SplatSelection& model, UsdaText& text) : model_(model), text_(text) {}

  void encode() {
    text_.add("def ParticleField3DGaussianSplat \"Splat\"\n{\n");
    if (!model_.rows.empty()) add_extent();
    const int degree = model_.cloud.sh_degree;
    add_array("point3f[] positions", 3, 1, [](const SplatRow& row, float* to) { std::ranges::copy(row.position, to); });
    add_array("quatf[] orientations", 4, 1,
              [](const SplatRow& row, float* to) { std::ranges::copy(row.rotation, to); });
    add_array("float3[] scales", 3, 1, [](const SplatRow& row, float* to) {
      std::ranges::transform(row.log_scale, to, [](float x) { return exp_of(x); });
    });
    add_array("float[] opacities", 1, 1, [](const SplatRow& row, float* to) { *to = sigmoid(row.logit_opacity); });
    text_.add("    uniform int radiance:sphericalHarmonicsDegree = " + std::to_string(degree) + "\n");
    const auto rest = std::size_t(sh_rest_count(degree));
    add_array("float3[] radiance:sphericalHarmonicsCoefficients", 3, 1 + rest, [rest](const SplatRow& row, float* to) {
      std::ranges::copy(row.sh_dc, to);
      std::copy_n(row.sh_rest.begin(), 3 * rest, to + 3);
    });
    text_.add("    uniform token projectionModeHint = \"perspective\"\n");
    text_.add("    uniform token sortingModeHint = \"zDepth\"\n}\n");
  }

 private:
  SplatRow turned_row(std::int64_t i) const {
    SplatRow row = load_row(model_, i);
    reverse_axes(row, kRightUpBack);
    return row;
  }

  /// `count` elements of `width` numbers per row; fill(row, [count, width] out).
  template <class Fill>
  void add_array(const char* name, std::size_t width, std::size_t count, const Fill& fill) {
    text_.add("    ");
    text_.add(name);
    text_.add(" = [");
    std::vector<float> values(count * width);
    bool is_first = true;
    for (const std::int64_t i : model_.rows) {
      fill(turned_row(i), values.data());
      for (std::size_t k = 0; k < count; ++k, is_first = false) {
        text_.add(is_first ? "" : ", ");
        text_.add(std::span(values).subspan(k * width, width));
      }
    }
    text_.add("]\n");
  }

  void add_extent() {
    std::array<float, 3> low, high;
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
    for (const std::int64_t i : model_.rows) {
      const SplatRow row = turned_row(i);
      const float reach = kExtentSigmas * exp_of(*std::ranges::max_element(row.log_scale));
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], row.position[a] - reach);
        high[a] = std::max(high[a], row.position[a] + reach);
      }
    }
    text_.add("    float3[] extent = [");
    text_.add(low);
    text_.add(", ");
    text_.add(high);
    text_.add("]\n");
  }

  const SplatSelection& model_;
  UsdaText& text_;
};

}  // namespace

void add_usda_splat(const SplatSelection& model, UsdaText& text) { UsdaEncoder(model, text).encode(); }

std::vector<std::uint8_t> encode_usda(const SplatSelection& model) {
  UsdaText text;
  text.add_header("Splat");
  add_usda_splat(model, text);
  return std::move(text).take();
}

}  // namespace ngs::io
