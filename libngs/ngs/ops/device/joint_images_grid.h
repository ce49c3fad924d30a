#pragma once
// Images of a training view on a device, and the terms of the loss that look at images: photometric, L_mask, L_align.
//                                                                                     Eqs. (16), (19); C16
#include <algorithm>

#include "ngs/ops/device/device_joint.h"
#include "ngs/ops/device/joint_rays_grid.h"
#include "ngs/ops/losses/loss_align_kernels.h"
#include "ngs/ops/losses/loss_mask_kernels.h"
#include "ngs/ops/device/mask_pixel_schedule.h"
#include "ngs/ops/device/photometric_schedule.h"

namespace ngs {

/// Sums of a step that its losses are computed from.
enum JointSum {
  kSumL1, kSumSsim, kSumAlignColour, kSumAlignAlpha, kSumAlignVariance, kSumActive, kSumMask, kSumCont, kSumSmooth,
  kSumSmoothPoints, kJointSums
};

/// What stays of a view. 12 bytes a pixel for the photo, 4 per object for masks, 1 where pixels are unknown.
template <class Grid>
struct ViewOnGrid {
  using Floats = DeviceBuffer<Grid, float>;
  int width_px = 0, height_px = 0;
  Floats photo, target;
  DeviceBuffer<Grid, const float*> plane;
  DeviceBuffer<Grid, std::uint8_t> known_mask;
  std::int64_t known = 0;  // pixels; 0: no evidence
  PixelRegion region;
  typename Grid::Recording later;  // the step of a visit with queries of the model as it is

  ViewOnGrid(Grid& grid, const Camera& camera, const JointImages& images)
      : width_px(camera.width_px), height_px(camera.height_px), region(images.region) {
    if (images.photo != nullptr) photo = {grid, images.photo->data};
    const ViewMasks& masks = *images.masks;
    if (!masks.available) return;
    known = masks.known.empty() ? pixels() : pixels() - std::count(masks.known.begin(), masks.known.end(), std::uint8_t(0));
    known_mask = {grid, masks.known};
    target = {grid, std::int64_t(masks.target.size()) * pixels()};
    std::vector<const float*> planes;
    for (std::size_t k = 0; k < masks.target.size(); ++k) {
      planes.push_back(target.data() + std::int64_t(k) * pixels());
      grid.upload(target.data() + std::int64_t(k) * pixels(), masks.target[k].data(), std::size_t(pixels()) * sizeof(float));
    }
    plane = {grid, planes};
  }
  std::int64_t pixels() const { return std::int64_t(width_px) * height_px; }
  static std::int64_t bytes(const JointImages& images) {
    std::size_t n = images.masks->known.size();
    if (images.photo != nullptr) n += images.photo->data.size() * sizeof(float);
    for (const auto& plane : images.masks->target) n += plane.size() * sizeof(float);
    return std::int64_t(n);
  }
};

/// What a step renders of a view, and the gradients with respect to it. Images that a step does not need are empty.
template <class Grid>
struct RenderedOnGrid {
  DeviceBuffer<Grid, float> colour, label, depth, alpha;  // [H, W, 3], [H, W, K], [H, W], [H, W]

  RenderedOnGrid(Grid& grid, std::int64_t pixels, bool with_colour, int labels, bool with_depth, bool with_alpha)
      : colour(grid, with_colour ? pixels * 3 : 0), label(grid, pixels * labels), depth(grid, with_depth ? pixels : 0),
        alpha(grid, with_alpha ? pixels : 0) {}

  /// In the order of the channels, alpha last.
  template <class T>
  std::vector<Plane<T>> planes(const ChannelPlan<float>& plan) const {
    std::vector<Plane<T>> out;
    const auto add = [&](const DeviceBuffer<Grid, float>& image, int channels) {
      for (int c = 0; c < channels; ++c) out.push_back({image.data() ? image.data() + c : nullptr, channels});
    };
    if (plan.colour) add(colour, 3);
    if (plan.labels() > 0) add(label, plan.labels());
    if (plan.depth) add(depth, 1);
    add(alpha, 1);
    return out;
  }
};

/// Host factors of the photometric term; see PhotometricPass.
struct PhotometricFactors {
  double norm, share;

  PhotometricFactors(const PixelRegion& r, std::int64_t pixels) {
    const double all = double(pixels), inside = r.empty() ? all : double(r.x1 - r.x0) * (r.y1 - r.y0);
    norm = 1.0 / (inside * 3), share = r.empty() ? 1 : inside / all;
  }
};

template <class Grid>
void photometric_term(Grid& grid, const ViewOnGrid<Grid>& view, double weight, const RenderedOnGrid<Grid>& rendered,
                      RenderedOnGrid<Grid>& grad, double* sums) {
  const int w = view.width_px, h = view.height_px;
  const PixelRegion inner = view.region.empty() ? PixelRegion{0, 0, w, h} : view.region;
  if (!view.region.empty()) grad.colour.zero();
  const int x0 = std::max(0, inner.x0 - ssim::kRadius), y0 = std::max(0, inner.y0 - ssim::kRadius);
  const ssim::Layout layout{std::min(w, inner.x1 + ssim::kRadius) - x0, std::min(h, inner.y1 + ssim::kRadius) - y0, 3};
  const std::int64_t first = (std::int64_t(y0) * w + x0) * 3, stride = std::int64_t(w) * 3;
  const PhotometricFactors factors(view.region, view.pixels());
  const double scale = factors.share * weight * factors.norm, dssim = PhotometricOptions{}.dssim_weight;
  const ssim::PixelWeights weights{{}, inner.x0 - x0, inner.x1 - x0, inner.y0 - y0, inner.y1 - y0};
  ssim::photometric_on_grid(grid,
                            {layout, {rendered.colour.data() + first, stride}, {view.photo.data() + first, stride}, weights,
                             -scale * dssim, scale * (1 - dssim), {grad.colour.data() + first, stride}},
                            sums + kSumL1);
}

template <class Grid>
void mask_term(Grid& grid, const ViewOnGrid<Grid>& view, const JointTerms& terms, int objects,
               const RenderedOnGrid<Grid>& rendered, const float* pixel_weight, RenderedOnGrid<Grid>& grad, double* sums) {
  const DeviceBuffer<Grid, double> term(grid, view.pixels());
  const MaskLossRow<float, double> row{view.width_px, objects, rendered.label.data(), view.plane.data(),
                                       view.known_mask.data(), pixel_weight, terms.mask_form == MaskLossForm::kLinear,
                                       float(MaskLossOptions{}.lambda), float(terms.lambda_mask / double(view.known)),
                                       nullptr, grad.label.data()};
  grid.each(view.pixels(), MaskLossPixel{row, term.data()});
  sums_on_grid(grid, static_cast<const double*>(term.data()), view.pixels(), 1, sums + kSumMask);
}

/// sigmoid(D); 1 where the view does not see the boundary.
struct DensityWeightOfView {
  static constexpr const char* kName = "density_weight";
  DensityWeight kernel;
  const ViewGrid* view;
  NGS_HD void operator()(std::int64_t i) const {
    if (view->grid.nodes() == 0) {
      kernel.weight[i] = 1;
      return;
    }
    DensityWeight here = kernel;
    const PixelBox box = box_of(view->grid);
    here.grid = view->grid, here.min_x = box.min_x, here.min_y = box.min_y, here.max_x = box.max_x, here.max_y = box.max_y;
    here(i);
  }
};

/// Sets the grid of L_align's kernels.
struct GridOfView {
  const ViewGrid* view;
  NGS_HD void operator()(AlignForward<float>& kernel) const { kernel.in.grid = view->grid; }
};
/// Sets grid and scale: 1 / active nodes.
struct ScaleOfView {
  const ViewGrid* view;
  const double* active;
  NGS_HD float scale() const { return *active > 0 ? float(1.0 / *active) : 0.f; }
  NGS_HD void operator()(AlignBackwardField<float>& kernel) const { kernel.scale = scale(); }
  NGS_HD void operator()(AlignBackwardImage<float>& kernel) const { kernel.in.grid = view->grid, kernel.scale = scale(); }
};

/// Overwrites ∂L_align/∂field; adds to the gradients of the images.
template <class Grid>
void align_term(Grid& grid, const ViewOnGrid<Grid>& view, const JointTerms& terms, const RaysOnGrid<Grid>& rays,
                const RenderedOnGrid<Grid>& rendered, const RayValues<const float>& field, RenderedOnGrid<Grid>& grad,
                const RayValues<float>& grad_field, double* sums) {
  using Floats = DeviceBuffer<Grid, float>;
  const std::int64_t n = rays.rays;
  const int w = view.width_px, h = view.height_px;
  const Floats residual(grid, n * 3), alpha_residual(grid, n), mean(grid, n * 3), share(grid, n), term(grid, n * 3);
  const AlignNodes<float> node{residual.data(), alpha_residual.data(), mean.data(), share.data()};
  const PixelView<float> photo{terms.excess_variance ? view.photo.data() : nullptr, w, h};
  const AlignView<float> in{{}, {rendered.colour.data(), w, h}, {rendered.alpha.data(), w, h}, photo, field.colour,
                            field.alpha, rays.on_surface.data(), float(terms.align_options.weight_alpha),
                            float(terms.align_options.weight_variance)};
  grid.each(n, Completed<AlignForward<float>, GridOfView>{{in, node, term.data()}, {rays.view.data()}});
  sums_on_grid(grid, static_cast<const float*>(term.data()), n, 3, sums + kSumAlignColour);
  sums_on_grid(grid, static_cast<const std::uint8_t*>(rays.on_surface.data()), n, 1, sums + kSumActive);
  const ScaleOfView scale{rays.view.data(), sums + kSumActive};
  grid.each(n, Completed<AlignBackwardField<float>, ScaleOfView>{
                   {node, in.weight_alpha, 0, grad_field.colour, grad_field.alpha}, scale});
  grid.each(view.pixels(), Completed<AlignBackwardImage<float>, ScaleOfView>{
                               {in, node, 0, 0, 0, w, grad.colour.data(), grad.alpha.data()}, scale});
}

}  // namespace ngs
