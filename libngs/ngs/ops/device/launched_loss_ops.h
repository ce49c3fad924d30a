#pragma once
// DeviceLossOps on a Launcher: uploads, runs the kernels, downloads.
#include <algorithm>

#include "ngs/ops/device/adam_kernel.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/device/loss_kernel.h"
#include "ngs/ops/device/photometric_kernel.h"

namespace ngs {

template <class Launcher>
class LaunchedLossOps final : public DeviceLossOps {
  using Floats = DeviceBuffer<Launcher, float>;

 public:
  explicit LaunchedLossOps(Launcher& launcher) : launcher_(launcher) {}

  std::array<double, 3> align_forward(const AlignForward<float>& host) const override {
    const std::int64_t nodes = host.in.grid.nodes();
    const AlignArrays in(launcher_, host.in);
    const NodeArrays node = NodeArrays::results(launcher_, nodes, host.node);
    const Floats term(launcher_, nodes * 3);
    launcher_.parallel_for(nodes, AlignForward<float>{in.view, node.view(), term.data()});
    node.colour.to(host.node.colour_residual);
    node.alpha.to(host.node.alpha_residual);
    node.mean.to(host.node.patch_mean);
    node.share.to(host.node.patch_share);
    const std::vector<double> sums = ordered_sums(launcher_, static_cast<const float*>(term.data()), nodes, 3);
    return {sums[0], sums[1], sums[2]};
  }

  void align_backward(const AlignBackwardField<float>& field, const AlignBackwardImage<float>& image,
                      std::int64_t rect_pixels) const override {
    const std::int64_t nodes = image.in.grid.nodes(), pixels = pixels_of(image.in.colour);
    const AlignArrays in(launcher_, image.in);
    const NodeArrays node(launcher_, nodes, image.node);
    const Floats field_colour = Floats::result(launcher_, field.grad_colour, nodes * 3),
                 field_alpha = Floats::result(launcher_, field.grad_alpha, nodes);
    launcher_.parallel_for(nodes, AlignBackwardField<float>{node.view(), field.weight_alpha, field.scale,
                                                            field_colour.data(), field_alpha.data()});
    field_colour.to(field.grad_colour);
    field_alpha.to(field.grad_alpha);
    const Floats colour(launcher_, image.grad_colour_accumulate, pixels * 3),
        alpha(launcher_, image.grad_alpha_accumulate, pixels);
    launcher_.parallel_for(rect_pixels, AlignBackwardImage<float>{in.view, node.view(), image.scale, image.x0, image.y0,
                                                                  image.rect_width, colour.data(), alpha.data()});
    colour.to(image.grad_colour_accumulate);
    alpha.to(image.grad_alpha_accumulate);
  }

  void density_weight(const DensityWeight& host, std::int64_t pixels) const override {
    const Floats depth(launcher_, host.optical_depth, host.grid.nodes()),
        weight = Floats::result(launcher_, host.weight, pixels);
    DensityWeight kernel = host;
    kernel.optical_depth = depth.data();
    kernel.weight = weight.data();
    launcher_.parallel_for(pixels, kernel);
    weight.to(host.weight);
  }

  double mask(const MaskLossRow<float, double>& host, int height) const override {
    const std::int64_t pixels = std::int64_t(host.width) * height, values = pixels * host.objects;
    const Floats rendered(launcher_, host.rendered, values),
        weight(launcher_, host.pixel_weight, host.pixel_weight ? pixels : 0),
        grad = Floats::result(launcher_, host.grad_rendered, host.grad_rendered ? values : 0);
    const DeviceBuffer<Launcher, std::uint8_t> known(launcher_, host.known, host.known ? pixels : 0);
    std::vector<Floats> target;
    std::vector<const float*> planes;
    for (int k = 0; k < host.objects; ++k)
      planes.push_back(target.emplace_back(launcher_, host.target[k], pixels).data());
    DeviceBuffer<Launcher, const float*> plane;  // of many objects; an upload waits for the stream
    const DeviceBuffer<Launcher, double> term(launcher_, pixels);
    MaskLossPixel kernel{host, {}, term.data()};
    if (host.objects <= MaskLossPixel::kInlinePlanes)
      std::copy(planes.begin(), planes.end(), kernel.target);
    else
      plane = {launcher_, planes.data(), host.objects};
    kernel.row.rendered = rendered.data();
    kernel.row.target = plane.data();
    kernel.row.known = known.data();
    kernel.row.pixel_weight = weight.data();
    kernel.row.grad_rendered = grad.data();
    launcher_.parallel_for(pixels, kernel);
    grad.to(host.grad_rendered);
    return ordered_sums(launcher_, term.data(), pixels, 1)[0];
  }

  double continuity(const ContinuityForward<float>& forward, const ContinuityBackward<float>* backward,
                    const AddRowColourGradients* add) const override {
    const ContinuityGraph<float>& g = forward.graph;
    const std::int64_t n = g.colour.n, edges = g.index.n * g.index.c;
    const DeviceBuffer<Launcher, std::uint32_t> index(launcher_, g.index.data, edges);
    const DeviceBuffer<Launcher, std::int64_t> row_begin(launcher_, g.row_begin, n + 1), edge(launcher_, g.edge, edges);
    const Floats weight(launcher_, g.weight, g.weight ? edges : 0), colour(launcher_, g.colour.data, n * 3),
        term(launcher_, n);
    const ContinuityGraph<float> graph{
        {index.data(), g.index.n, g.index.c}, row_begin.data(), edge.data(), weight.data(), {colour.data(), n}};
    if (backward == nullptr) {
      launcher_.parallel_for(n, ContinuityForward<float>{graph, term.data()});
    } else {
      const Floats grad = Floats::result(launcher_, backward->grad_colour.data, n * 3);
      ContinuityRow row{
          {graph, term.data()}, {graph, backward->scale, {grad.data(), n}}, {nullptr, grad.data(), nullptr}};
      if (add != nullptr) {
        row.add.place = resident(add->place);
        row.add.sh_dc = resident(add->sh_dc);
      }
      launcher_.parallel_for(n, row);
      grad.to(backward->grad_colour.data);
    }
    return ordered_sums(launcher_, static_cast<const float*>(term.data()), n, 1)[0];
  }

  double smoothness(const SmoothnessForwardBackward<float>& host) const override {
    const std::int64_t n = host.colour.n;
    const Floats colour(launcher_, host.colour.data, n * 3), moved(launcher_, host.moved_colour.data, n * 3),
        term(launcher_, n), grad = Floats::result(launcher_, host.grad_colour.data, n * 3),
                            grad_moved = Floats::result(launcher_, host.grad_moved.data, n * 3);
    launcher_.parallel_for(
        n,
        SmoothnessForwardBackward<float>{
            {colour.data(), n}, {moved.data(), n}, host.scale, term.data(), {grad.data(), n}, {grad_moved.data(), n}});
    grad.to(host.grad_colour.data);
    grad_moved.to(host.grad_moved.data);
    return ordered_sums(launcher_, static_cast<const float*>(term.data()), n, 1)[0];
  }

  PhotometricSums photometric(const ssim::Comparison<float>& host) const override {
    const ssim::Layout& layout = host.layout;
    const Crops<const float> x(launcher_, host.x, layout.width(), layout.h),
        y(launcher_, host.y, layout.width(), layout.h), weight(launcher_, host.weights.weight, layout.w, layout.h);
    const Crops<float> gradient(launcher_, host.gradient, layout.width(), layout.h);
    ssim::Comparison<float> comparison = host;
    comparison.x = x.crop;
    comparison.y = y.crop;
    comparison.weights.weight = weight.crop;
    comparison.gradient = gradient.crop;
    const DeviceBuffer<Launcher, double> total(launcher_, 2);
    ssim::photometric_on_device(launcher_, comparison, total.data());
    std::vector<double> sums;
    total.to(sums);
    if (gradient.own.size() > 0) {
      std::vector<float> values;
      gradient.own.to(values);
      for (int row = 0; row < layout.h; ++row)
        std::copy_n(values.data() + row * layout.width(), layout.width(), host.gradient.row(row));
    }
    return {sums[0], sums[1]};
  }

  UnusableGradient adam(const AdamBlocks& host, float limit) const override {
    AdamBlocks blocks = host;
    std::vector<Floats> of_host;  // value, gradient and moments of every block
    for (std::size_t b = 0; b < host.count; ++b) {
      AdamKernel<float>& block = blocks.block[b];
      for (float** array : {&block.value, &block.m, &block.v})
        *array = of_host.emplace_back(launcher_, *array, block.n).data();
      block.grad = of_host.emplace_back(launcher_, block.grad, block.n).data();
    }
    const std::int64_t bad = adam_on_device(launcher_, blocks, limit);
    if (bad != kNoIndex) {
      const std::size_t b = host.of(bad);
      UnusableGradient first{b, bad - host.begin[b], 0.f};
      launcher_.download(&first.value, blocks.block[b].grad + first.index, sizeof first.value);
      return first;
    }
    for (std::size_t b = 0; b < host.count; ++b) {
      const AdamKernel<float>& block = host.block[b];
      of_host[4 * b].to(block.value);
      of_host[4 * b + 1].to(block.m);
      of_host[4 * b + 2].to(block.v);
    }
    return {0, -1, 0.f};
  }

 private:
  /// The device address of a resident array.
  template <class T>
  T* resident(T* host) const {
    void* const device = launcher_.resident.find(host, sizeof(T));
    NGS_CHECK(device != nullptr, "the array is resident");
    return static_cast<T*>(device);
  }
  static std::int64_t pixels_of(const PixelView<float>& view) { return std::int64_t(view.width) * view.height; }

  struct AlignArrays {
    Floats colour, alpha, field_colour, field_alpha;
    DeviceBuffer<Launcher, std::uint8_t> active;
    AlignView<float> view;
    AlignArrays(Launcher& launcher, const AlignView<float>& h)
        : colour(launcher, h.colour.data, pixels_of(h.colour) * 3),
          alpha(launcher, h.alpha.data, pixels_of(h.alpha)),
          field_colour(launcher, h.field_colour, h.grid.nodes() * 3),
          field_alpha(launcher, h.field_alpha, h.grid.nodes()),
          active(launcher, h.active, h.active ? h.grid.nodes() : 0),
          view(h) {
      view.colour.data = colour.data();
      view.alpha.data = alpha.data();
      view.field_colour = field_colour.data();
      view.field_alpha = field_alpha.data();
      view.active = active.data();
    }
  };
  struct NodeArrays {
    Floats colour, alpha, mean, share;
    NodeArrays() = default;
    static NodeArrays results(Launcher& launcher, std::int64_t n, const AlignNodes<float>& h) {
      NodeArrays out;
      out.colour = Floats::result(launcher, h.colour_residual, n * 3);
      out.alpha = Floats::result(launcher, h.alpha_residual, n);
      out.mean = Floats::result(launcher, h.patch_mean, n * 3);
      out.share = Floats::result(launcher, h.patch_share, n);
      return out;
    }
    NodeArrays(Launcher& launcher, std::int64_t n, const AlignNodes<float>& h)
        : colour(launcher, h.colour_residual, n * 3),
          alpha(launcher, h.alpha_residual, n),
          mean(launcher, h.patch_mean, n * 3),
          share(launcher, h.patch_share, n) {}
    AlignNodes<float> view() const { return {colour.data(), alpha.data(), mean.data(), share.data()}; }
  };
  /// A crop of a resident image, or a dense device copy of a crop of a host image; null stays null.
  template <class T>
  struct Crops {
    Floats own;
    ssim::Crop<T> crop;
    Crops(Launcher& launcher, const ssim::Crop<T>& host, std::int64_t width, int height) {
      if (host.first == nullptr) return;
      const std::int64_t values = (height - 1) * host.stride + width;
      if (void* const resident = launcher.resident.find(host.first, std::size_t(values) * sizeof(float))) {
        crop = {static_cast<float*>(resident), host.stride};
        return;
      }
      own = Floats(launcher, width * height);
      crop = {own.data(), width};
      if constexpr (std::is_const_v<T>)
        for (int row = 0; row < height; ++row)
          launcher.upload(own.data() + row * width, host.row(row), std::size_t(width) * sizeof(float));
    }
  };

  Launcher& launcher_;
};

}  // namespace ngs
