#include "ngs/ops/losses/loss_align.h"

#include <algorithm>
#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/losses/loss_align_kernels.h"
#include "ngs/ops/optim/resident.h"

namespace ngs {
namespace {

PixelView<float> pixels(const ImageF* image) { return {image->data.data(), image->width_px, image->height_px}; }

AlignView<float> view_of(const AlignOptions& options, const AlignInputs& in) {
  const auto nodes = std::size_t(in.grid.nodes());
  NGS_CHECK(in.colour->channels == 3 && in.alpha->channels == 1 && in.colour->pixels() == in.alpha->pixels(),
            "loss_align: colour [H, W, 3] and alpha [H, W, 1] must have one size");
  NGS_CHECK(in.field_colour->size() == nodes * 3 && in.field_alpha->size() == nodes, "one field value per node");
  NGS_CHECK(in.active == nullptr || in.active->size() == nodes, "one flag per node");
  return {in.grid,
          pixels(in.colour),
          pixels(in.alpha),
          in.field_colour->data(),
          in.field_alpha->data(),
          in.active ? in.active->data() : nullptr,
          float(options.weight_alpha),
          float(options.weight_variance)};
}

AlignNodes<float> nodes_of(AlignContext& c) {
  return {c.colour_residual.data(), c.alpha_residual.data(), c.patch_mean.data(), c.patch_share.data()};
}

/// The pixels that any node may read along one axis.
struct Span {
  int begin, end;
};
Span pixels_read(double first, double last, int size_px) {
  const int begin = std::clamp(int(std::floor(first)) - kPatchRadiusPx, 0, size_px);
  return {begin, std::clamp(int(std::floor(last)) + kPatchRadiusPx + 1, begin, size_px)};
}

}  // namespace

AlignLoss loss_align(const Exec& exec, const AlignOptions& options, const AlignInputs& in, AlignContext& context) {
  AlignLoss loss;
  const auto nodes = std::size_t(in.grid.nodes());
  context.colour_residual.resize(nodes * 3);
  context.alpha_residual.resize(nodes);
  context.patch_mean.resize(nodes * 3);
  context.patch_share.resize(nodes);
  context.nodes = 0;
  if (nodes == 0) return loss;
  std::vector<float> term(exec.device_ops ? 0 : nodes * 3);
  const AlignForward<float> kernel{view_of(options, in), nodes_of(context), term.data()};
  if (exec.device_ops) {
    const auto sums = exec.device_ops->loss.align_forward(kernel);
    loss.colour = sums[0];
    loss.alpha = sums[1];
    loss.variance = sums[2];
  } else {
    for_each_index(exec, std::int64_t(nodes), kernel);
  }
  for (std::size_t r = 0; r < term.size(); r += 3) {
    loss.colour += double(term[r]);
    loss.alpha += double(term[r + 1]);
    loss.variance += double(term[r + 2]);
  }
  for (std::size_t r = 0; r < nodes; ++r) loss.nodes += in.active == nullptr || (*in.active)[r] != 0;
  context.nodes = loss.nodes;
  if (loss.nodes == 0) return loss;
  for (double* part : {&loss.colour, &loss.alpha, &loss.variance}) *part /= double(loss.nodes);
  loss.total = loss.colour + options.weight_alpha * loss.alpha + options.weight_variance * loss.variance;
  return loss;
}

void loss_align_backward(const Exec& exec, const AlignOptions& options, const AlignInputs& in, AlignContext& context,
                         const AlignGradients& out) {
  const std::int64_t nodes = in.grid.nodes();
  out.field.colour.resize(std::size_t(nodes) * 3);
  out.field.alpha.resize(std::size_t(nodes));
  if (context.nodes == 0) return fill_zero(exec, out.field.colour), fill_zero(exec, out.field.alpha);
  NGS_CHECK(out.colour_accumulate.data.size() == in.colour->data.size() &&
                out.alpha_accumulate.data.size() == in.alpha->data.size(),
            "gradients have the shape of the images");
  const float scale = float(out.weight / double(context.nodes));
  const AlignBackwardField<float> to_field{nodes_of(context), float(options.weight_alpha), scale,
                                           out.field.colour.data(), out.field.alpha.data()};
  const PixelGrid& g = in.grid;
  const Span x = pixels_read(g.x(0), g.x(g.cols - 1), in.colour->width_px);
  const Span y = pixels_read(g.y(0), g.y(g.rows - 1), in.colour->height_px);
  const int width = x.end - x.begin;
  const std::int64_t rect_pixels = std::int64_t(width) * (y.end - y.begin);
  const AlignBackwardImage<float> to_image{view_of(options, in),
                                           nodes_of(context),
                                           scale,
                                           x.begin,
                                           y.begin,
                                           width,
                                           out.colour_accumulate.data.data(),
                                           out.alpha_accumulate.data.data()};
  if (exec.device_ops) return exec.device_ops->loss.align_backward(to_field, to_image, rect_pixels);
  for_each_index(exec, nodes, to_field);
  for_each_index(exec, rect_pixels, to_image);
}

}  // namespace ngs
