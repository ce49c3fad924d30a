#include "ngs/edit/fill/fill_refit.h"

#include <algorithm>

#include "ngs/core/check.h"
#include "ngs/edit/fill/hole_seeds.h"
#include "ngs/make/fit/photo_refit.h"
#include "ngs/ops/image/metrics.h"

namespace ngs {
namespace {

constexpr int kSteps = 600, kMinEpochs = 4, kMaxEpochs = 40;

ImageF weight_of(const PixelMask& hole, const Camera& camera) {
  ImageF weight(camera.width_px, camera.height_px, 1);
  NGS_CHECK(hole.size() == weight.data.size(), "a hole has the size of its camera");
  std::ranges::transform(hole, weight.data.begin(), [](std::uint8_t set) { return set ? 1.f : 0.f; });
  return weight;
}

double hole_psnr_db(const Exec& exec, const InpaintedViews& in, const GaussianCloud& cloud) {
  const SplatOptions splat = prepared_for(exec, in.splat, cloud);
  double sum = 0;
  for (const std::size_t v : in.views) {
    const Camera& camera = in.scene.views[v].camera;
    RenderRequest request;
    request.background = in.background;
    const ImageF weight = weight_of(in.hole(v), camera);
    const ImageF colour = std::move(render(exec, cloud, camera, splat, request).colour);
    sum += std::min(psnr_db(exec, colour, in.picture(v), &weight), kEqualPsnrDb);
  }
  return in.views.empty() ? 0 : sum / double(in.views.size());
}

std::int64_t add_seeds(const Exec& exec, const InpaintedViews& in, GaussianCloud& cloud) {
  std::int64_t seeds = 0;
  for (const std::size_t v : in.views) {
    const Camera& camera = in.scene.views[v].camera;
    RenderRequest request;
    request.colour = false;
    request.depth = true;
    const RenderedView around = render(exec, cloud, camera, in.splat, request);
    seeds += add_hole_seeds({relative_to(camera, cloud.origin), around, in.hole(v), in.picture(v)}, cloud);
  }
  return seeds;
}

}  // namespace

HoleRefit refit_hole(const Exec& exec, Monitor& monitor, const InpaintedViews& input, std::size_t kept,
                     GaussianCloud& cloud) {
  NGS_CHECK(kept <= std::size_t(cloud.size()), "the rows of the background come first");
  HoleRefit out;
  if (input.views.empty()) return out;
  const auto timed = monitor.scope("refit");
  out.seeds = add_seeds(exec, input, cloud);
  out.psnr_before_db = hole_psnr_db(exec, input, cloud);
  std::vector<std::uint8_t> filled(std::size_t(cloud.size()));
  std::fill(filled.begin() + std::ptrdiff_t(kept), filled.end(), std::uint8_t(1));
  const GaussianCloud before = cloud;
  const Problem problem{.cloud = before,
                        .scene = input.scene,
                        .views = input.views,
                        .load_photo = input.picture,
                        .splat = input.splat,
                        .background = input.background,
                        .seed = input.seed};
  RefitOptions options;
  options.epochs = std::clamp(kSteps / int(input.views.size()), kMinEpochs, kMaxEpochs);
  const auto weight = [&](std::size_t v) { return weight_of(input.hole(v), input.scene.views[v].camera); };
  refit_to_photos(exec, monitor, options, {problem, input.views, filled, filled, weight}, cloud);
  out.psnr_after_db = hole_psnr_db(exec, input, cloud);
  return out;
}

}  // namespace ngs
