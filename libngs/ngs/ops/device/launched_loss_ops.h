#pragma once
// DeviceLossOps on a Grid: copies in, the kernels, copies out.
#include <algorithm>

#include "ngs/ops/device/adam_schedule.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/device/mask_pixel_schedule.h"
#include "ngs/ops/device/photometric_schedule.h"

namespace ngs {

template <class Grid>
class LaunchedLossOps final : public DeviceLossOps {
  using Floats = DeviceBuffer<Grid, float>;

 public:
  explicit LaunchedLossOps(Grid& grid) : grid_(grid) {}

  void align_forward(const AlignForward<float>& host) const override {
    const std::int64_t nodes = host.in.grid.nodes();
    const AlignArrays in(grid_, host.in);
    const NodeArrays node(grid_, nodes);
    const Floats term(grid_, nodes * 3);
    grid_.each(nodes, AlignForward<float>{in.view, node.view(), term.data()});
    node.colour.to(host.node.colour_residual), node.alpha.to(host.node.alpha_residual);
    node.mean.to(host.node.patch_mean), node.share.to(host.node.patch_share), term.to(host.term);
  }

  void align_backward(const AlignBackwardField<float>& field, const AlignBackwardImage<float>& image,
                      std::int64_t rect_pixels) const override {
    const std::int64_t nodes = image.in.grid.nodes(), pixels = pixels_of(image.in.colour);
    const AlignArrays in(grid_, image.in);
    const NodeArrays node(grid_, nodes, image.node);
    const Floats field_colour(grid_, nodes * 3), field_alpha(grid_, nodes);
    grid_.each(nodes, AlignBackwardField<float>{node.view(), field.weight_alpha, field.scale, field_colour.data(),
                                                field_alpha.data()});
    field_colour.to(field.grad_colour), field_alpha.to(field.grad_alpha);
    const Floats colour(grid_, image.grad_colour_accumulate, pixels * 3), alpha(grid_, image.grad_alpha_accumulate, pixels);
    grid_.each(rect_pixels, AlignBackwardImage<float>{in.view, node.view(), image.scale, image.x0, image.y0,
                                                      image.rect_width, colour.data(), alpha.data()});
    colour.to(image.grad_colour_accumulate), alpha.to(image.grad_alpha_accumulate);
  }

  void density_weight(const DensityWeight& host, std::int64_t pixels) const override {
    const Floats depth(grid_, host.optical_depth, host.grid.nodes()), weight(grid_, pixels);
    DensityWeight kernel = host;
    kernel.optical_depth = depth.data(), kernel.weight = weight.data();
    grid_.each(pixels, kernel);
    weight.to(host.weight);
  }

  double mask(const MaskLossRow<float, double>& host, int height) const override {
    const std::int64_t pixels = std::int64_t(host.width) * height, values = pixels * host.objects;
    const Floats rendered(grid_, host.rendered, values), target(grid_, values),
        weight(grid_, host.pixel_weight, host.pixel_weight ? pixels : 0), grad(grid_, host.grad_rendered ? values : 0);
    const DeviceBuffer<Grid, std::uint8_t> known(grid_, host.known, host.known ? pixels : 0);
    std::vector<const float*> planes;
    for (int k = 0; k < host.objects; ++k) {
      planes.push_back(target.data() + k * pixels);
      grid_.upload(target.data() + k * pixels, host.target[k], std::size_t(pixels) * sizeof(float));
    }
    const DeviceBuffer<Grid, const float*> plane(grid_, planes.data(), host.objects);
    const DeviceBuffer<Grid, double> term(grid_, pixels);
    MaskLossRow<float, double> row = host;
    row.rendered = rendered.data(), row.target = plane.data(), row.known = known.data();
    row.pixel_weight = weight.data(), row.grad_rendered = grad.data();
    grid_.each(pixels, MaskLossPixel{row, term.data()});
    grad.to(host.grad_rendered);
    return ordered_sums(grid_, term.data(), pixels, 1)[0];
  }

  void continuity(const ContinuityForward<float>& forward, const ContinuityBackward<float>* backward) const override {
    const ContinuityGraph<float>& g = forward.graph;
    const std::int64_t n = g.colour.n, edges = g.index.n * g.index.c;
    const DeviceBuffer<Grid, std::uint32_t> index(grid_, g.index.data, edges);
    const DeviceBuffer<Grid, std::int64_t> row_begin(grid_, g.row_begin, n + 1), edge(grid_, g.edge, edges);
    const Floats weight(grid_, g.weight, g.weight ? edges : 0), colour(grid_, g.colour.data, n * 3), term(grid_, n);
    const ContinuityGraph<float> graph{{index.data(), g.index.n, g.index.c}, row_begin.data(), edge.data(), weight.data(),
                                       {colour.data(), n}};
    grid_.each(n, ContinuityForward<float>{graph, term.data()});
    term.to(forward.term);
    if (backward == nullptr) return;
    const Floats grad(grid_, n * 3);
    grid_.each(n, ContinuityBackward<float>{graph, backward->scale, {grad.data(), n}});
    grad.to(backward->grad_colour.data);
  }

  void smoothness(const SmoothnessForwardBackward<float>& host) const override {
    const std::int64_t n = host.colour.n;
    const Floats colour(grid_, host.colour.data, n * 3), moved(grid_, host.moved_colour.data, n * 3), term(grid_, n),
        grad(grid_, n * 3), grad_moved(grid_, n * 3);
    grid_.each(n, SmoothnessForwardBackward<float>{{colour.data(), n}, {moved.data(), n}, host.scale, term.data(),
                                                   {grad.data(), n}, {grad_moved.data(), n}});
    term.to(host.term), grad.to(host.grad_colour.data), grad_moved.to(host.grad_moved.data);
  }

  PhotometricSums photometric(const ssim::Layout& layout, ssim::Crop<const float> x, ssim::Crop<const float> y,
                              const ssim::PixelWeights& weights, double ssim_factor, double l1_factor,
                              ssim::Crop<float> gradient) const override {
    const Crops<const float> on_x(grid_, x, layout.width(), layout.h), on_y(grid_, y, layout.width(), layout.h),
        on_weight(grid_, weights.weight, layout.w, layout.h);
    const Crops<float> on_gradient(grid_, gradient, layout.width(), layout.h);
    ssim::PixelWeights on_grid = weights;
    on_grid.weight = on_weight.crop;
    const DeviceBuffer<Grid, double> on_sums(grid_, 2);
    ssim::photometric_on_grid(grid_, {layout, on_x.crop, on_y.crop, on_grid, ssim_factor, l1_factor, on_gradient.crop},
                              on_sums.data());
    std::vector<double> sums;
    on_sums.to(sums);
    if (gradient.first != nullptr) {
      std::vector<float> values;
      on_gradient.memory.to(values);
      for (int row = 0; row < layout.h; ++row)
        std::copy_n(values.data() + row * layout.width(), layout.width(), gradient.row(row));
    }
    return {sums[0], sums[1]};
  }

  std::int64_t adam(const AdamKernel<float>& host, std::int64_t sparse_columns, float limit) const override {
    const Floats grad(grid_, host.grad, host.n);
    const std::int64_t bad = first_unusable_on_grid(grid_, grad.data(), host.n, limit);
    if (bad >= 0) return bad;
    const Floats value(grid_, host.value, host.n), m(grid_, host.m, host.n), v(grid_, host.v, host.n);
    AdamKernel<float> kernel = host;
    kernel.value = value.data(), kernel.grad = grad.data(), kernel.m = m.data(), kernel.v = v.data();
    adam_on_grid(grid_, kernel, sparse_columns);
    value.to(host.value), m.to(host.m), v.to(host.v);
    return -1;
  }

 private:
  static std::int64_t pixels_of(const PixelView<float>& view) { return std::int64_t(view.width) * view.height; }

  struct AlignArrays {
    Floats colour, alpha, photo, field_colour, field_alpha;
    DeviceBuffer<Grid, std::uint8_t> active;
    AlignView<float> view;
    AlignArrays(Grid& grid, const AlignView<float>& h)
        : colour(grid, h.colour.data, pixels_of(h.colour) * 3), alpha(grid, h.alpha.data, pixels_of(h.alpha)),
          photo(grid, h.photo.data, h.photo.data ? pixels_of(h.photo) * 3 : 0),
          field_colour(grid, h.field_colour, h.grid.nodes() * 3), field_alpha(grid, h.field_alpha, h.grid.nodes()),
          active(grid, h.active, h.active ? h.grid.nodes() : 0), view(h) {
      view.colour.data = colour.data(), view.alpha.data = alpha.data(), view.photo.data = photo.data();
      view.field_colour = field_colour.data(), view.field_alpha = field_alpha.data(), view.active = active.data();
    }
  };
  struct NodeArrays {
    Floats colour, alpha, mean, share;
    NodeArrays(Grid& grid, std::int64_t n) : colour(grid, n * 3), alpha(grid, n), mean(grid, n * 3), share(grid, n) {}
    NodeArrays(Grid& grid, std::int64_t n, const AlignNodes<float>& h)
        : colour(grid, h.colour_residual, n * 3), alpha(grid, h.alpha_residual, n), mean(grid, h.patch_mean, n * 3),
          share(grid, h.patch_share, n) {}
    AlignNodes<float> view() const { return {colour.data(), alpha.data(), mean.data(), share.data()}; }
  };
  /// A crop of a host image as a dense one; null stays null.
  template <class T>
  struct Crops {
    Floats memory;
    ssim::Crop<T> crop;
    Crops(Grid& grid, const ssim::Crop<T>& host, std::int64_t width, int height) {
      if (host.first == nullptr) return;
      memory = Floats(grid, width * height);
      crop = {memory.data(), width};
      if constexpr (std::is_const_v<T>)
        for (int row = 0; row < height; ++row)
          grid.upload(memory.data() + row * width, host.row(row), std::size_t(width) * sizeof(float));
    }
  };

  Grid& grid_;
};

}  // namespace ngs
