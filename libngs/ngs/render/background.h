#pragma once
// The colour behind all Gaussians. A PLY does not contain it, but the model was trained over it: a pixel with remaining
// transmittance T has the model's colour c plus T b. With another b such pixels do not match the photo, and an
// optimiser grows Gaussians to reproduce b.
#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/options/field.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/scene.h"

namespace ngs {

struct PhotographedModel {
  const GaussianCloud& cloud;
  const Scene& scene;  // cameras, filter, renderer
  /// [H, W, 3] RGB in [0, 1] at the camera's size; called by several threads at once.
  std::function<ImageF(std::size_t view)> load_photo;
};

/// The option of every tool that renders colours.
inline constexpr Text background_option() {
  return {"background", "COLOUR", "Background: black, white or R,G,B in [0, 1]; default: the scene's"};
}

/// Parses "R,G,B" with three numbers in [0, 1], "black" or "white"; throws kUsage otherwise.
Vec3<float> parse_background(const std::string& text);

/// "R,G,B" with enough digits for an exact round trip.
std::string background_text(Vec3<float> colour);

/// The rule of every tool with --background: a `given` colour replaces the scene's, an empty one leaves it. Warns if
/// the scene has a clearly different one.
void choose_background(const std::string& given, Monitor& monitor, Scene& scene);

/// Composites a view that was rendered over black onto `background`.
RenderedView over_background(RenderedView view, Vec3<float> background);

/// The background measured on one photo. T: transmittance left at a pixel; r: photo minus view over black.
struct BackgroundMeasurement {
  bool open = false;                              // some pixel shows the background
  std::array<double, 3> colour{};                 // the best fit to the open pixels, not clamped
  double open2 = 0, shown = 0;                    // Σ T², mean of T² over all pixels
  std::array<double, 3> residual{}, residual2{};  // Σ T r and Σ r²
};

/// `view`: rendered over black at the photo's camera. The photo is opaque.
BackgroundMeasurement measure_background(const RenderedView& view, const ImageF& photo);

struct BackgroundFinding {
  std::optional<Vec3<double>> colour;  // in steps of 1/255; none: use black
  Vec3<double> fitted{0, 0, 0};        // median over the views that show the background
  Vec3<double> error{0, 0, 0};         // standard error of this median, from the spread over views
  double shown = 0;                    // median over the views of the image's mean T²
  double gain_db = 0;                  // median over the views: PSNR over `fitted` minus PSNR over black
  int views = 0;                       // number of views that show the background
};
// The default is black. Another colour is used only if the photos show it: at least kMinShown of the image, a standard
// error of at most kMaxBackgroundError, and a gain of at least kBackgroundMarginDb, as for another filter
// (filter_probe.h). If the model covers the image, the photos do not show the background, and the measured colour is
// that of the trainer. It is not used: a model without its floaters is refitted worse over that colour (paper.md 5.1).
inline constexpr double kMinShown = 0.01, kMaxBackgroundError = 0.1, kBackgroundMarginDb = 0.02;

BackgroundFinding find_background(std::span<const BackgroundMeasurement> measurements);

/// The same from renders of the `views`. Their photos must be opaque.
BackgroundFinding find_background(const Exec& exec, Monitor& monitor, const PhotographedModel& model,
                                  const std::vector<std::size_t>& views);

/// Mean PSNR of the rendered views against their photos, both over the scene's background. The background with the
/// higher value is the one that transparent photos were fitted over.
double psnr_over_background(const Exec& exec, const GaussianCloud& cloud, const Scene& scene,
                            const std::vector<std::size_t>& views,
                            const std::function<ImageF(std::size_t view)>& load_photo);

}  // namespace ngs
