#pragma once
// Refits the Gaussians of a filled hole to pictures in which another program has inpainted it.
#include <functional>

#include "ngs/core/monitor.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/scene.h"
#include "ngs/scene/view_prompt.h"

namespace ngs {

struct InpaintedViews {
  const Scene& scene;                                      // its cameras
  const std::vector<std::size_t>& views;                   // those with a hole
  std::function<ImageF(std::size_t view)> picture;         // [H, W, 3] at the camera's size
  std::function<const PixelMask&(std::size_t view)> hole;  // [H·W] 1: inpainted; only these pixels count
  SplatOptions splat;
  Vec3<float> background{0, 0, 0};
  std::uint64_t seed = 0;
};

struct HoleRefit {
  std::int64_t seeds = 0;                        // Gaussians added where no surface of the fill covers the hole
  double psnr_before_db = 0, psnr_after_db = 0;  // in the holes; mean over the views
};

/// `cloud`: the background, whose rows from `kept` on fill the hole. Adds seeds (hole_seeds.h) where the hole is less
/// than half covered, view by view, then trains the rows from `kept` on by the photometric loss in the holes. Rows
/// below `kept` keep their bits. Without views nothing changes.
HoleRefit refit_hole(const Exec& exec, Monitor& monitor, const InpaintedViews& input, std::size_t kept,
                     GaussianCloud& cloud);

}  // namespace ngs
