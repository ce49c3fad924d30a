#pragma once
// The colour behind all Gaussians. It is not in a PLY, and a trainer's images were drawn over it: where a model
// leaves a share T of a pixel open, the photo shows its colour c plus T b. Over another b such pixels do not fit,
// and an optimiser that is given them grows Gaussians to explain b.
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/options/field.h"
#include "ngs/scene/scene.h"
#include "ngs/stages/render/photographed_model.h"

namespace ngs {

/// The option of every tool that draws colours.
inline constexpr Text background_option() {
  return {"background", "COLOUR", "Background: black, white or R,G,B in [0, 1]; default: the scene's"};
}

/// "R,G,B" with three numbers in [0, 1], "black" or "white"; kUsage otherwise.
Vec3<float> parse_background(const std::string& text);

/// "R,G,B", every bit of it.
std::string background_text(Vec3<float> colour);

/// The rule of every tool with --background: what was `given` there is the scene's from now on; nothing given: the
/// scene's own stays. Warns where the scene knows another one.
void choose_background(const std::string& given, Monitor& monitor, Scene& scene);

/// The same view with `background` behind it: its colours, rendered over black, plus what its alpha leaves open of it.
RenderedView over_background(RenderedView view, Vec3<float> background);

/// What one photo says about it. T: the share of a pixel that the model leaves open; r: photo less view over black.
struct BackgroundMeasurement {
  bool open = false;                              // some pixel shows the background
  std::array<double, 3> colour{};                 // that which fits the open pixels best, not clamped
  double open2 = 0, shown = 0;                    // Σ T², and its mean over all pixels
  std::array<double, 3> residual{}, residual2{};  // Σ T r and Σ r²
};

/// `view`: rendered over black at the photo's camera. The photo is opaque.
BackgroundMeasurement measure_background(const RenderedView& view, const ImageF& photo);

/// What the photos together say about it.
struct BackgroundFinding {
  std::optional<Vec3<double>> colour;  // in steps of 1/255; none: black is what to take
  Vec3<double> fitted{0, 0, 0};        // median over the views that show any of it
  Vec3<double> error{0, 0, 0};         // standard error of this median, from the views' spread
  double shown = 0;                    // median over the views: mean T², of the picture
  double gain_db = 0;                  // median over the views: PSNR over `fitted` less that over black
  int views = 0;                       // that show any of it
};
// Black is what is taken for unknown. Another colour must be something that the photos show: a hundredth of the
// picture, told by the views to this much, and explaining them better by as much as another filter must
// (filter_probe.h). What shines through a model that covers the picture is not photographed, only what its trainer has
// put there. It is found as well, but not taken: a model without its floaters is refitted worse over it (PAPER.md 5.1).
inline constexpr double kLeastShown = 0.01, kMostBackgroundError = 0.1, kBackgroundMarginDb = 0.02;

BackgroundFinding find_background(std::span<const BackgroundMeasurement> measurements);

/// The same from renders of the `views`, whose photos are opaque.
BackgroundFinding find_background(const Exec& exec, Monitor& monitor, const PhotographedModel& model,
                                  const std::vector<std::size_t>& views);

/// Mean PSNR of the rendered views against their photos, both over the scene's background: which background
/// transparent photos were fitted over.
double psnr_over_background(const Exec& exec, const GaussianCloud& cloud, const Scene& scene,
                            const std::vector<std::size_t>& views,
                            const std::function<ImageF(std::size_t view)>& load_photo);

}  // namespace ngs
