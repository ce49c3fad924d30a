#include "ngs/ops/losses/loss_mask.h"

#include <algorithm>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/losses/loss_mask_kernels.h"

namespace ngs {

ImageF density_weights(const Exec& exec, int width_px, int height_px, const FieldDensity& field) {
  const PixelBox& box = field.box;
  NGS_CHECK(std::int64_t(field.optical_depth.size()) == field.grid.nodes(), "one optical depth per node");
  ImageF weight(width_px, height_px, 1);
  const DensityWeight kernel{
      field.grid, box.min_x, box.min_y, box.max_x, box.max_y, width_px, field.optical_depth.data(), weight.data.data()};
  if (exec.device_ops)
    exec.device_ops->loss.density_weight(kernel, weight.pixels());
  else
    for_each_index(exec, weight.pixels(), kernel);
  return weight;
}

MaskLoss loss_mask(const Exec& exec, const MaskLossOptions& options, const MaskLossInputs& in, double weight,
                   ImageF* gradient) {
  const ImageF& rendered = *in.rendered;
  const ViewMasks& masks = *in.masks;
  if (gradient) *gradient = ImageF(rendered.width_px, rendered.height_px, rendered.channels);
  MaskLoss loss;
  if (!masks.available) return loss;
  NGS_CHECK(masks.width_px == rendered.width_px && masks.height_px == rendered.height_px,
            "masks have the render's size");
  NGS_CHECK(int(masks.target.size()) == rendered.channels, "one target per label channel");
  NGS_CHECK(in.pixel_weight == nullptr || in.pixel_weight->pixels() == rendered.pixels(), "one weight per pixel");
  loss.known = masks.known.empty()
                   ? rendered.pixels()
                   : rendered.pixels() - std::count(masks.known.begin(), masks.known.end(), std::uint8_t(0));
  if (loss.known == 0) return loss;

  std::vector<const float*> target;
  for (const std::vector<float>& plane : masks.target) target.push_back(plane.data());
  std::vector<double> row_sum(std::size_t(rendered.height_px));
  const double scale = in.view_weight / double(loss.known);
  const MaskLossRow<float, double> kernel{rendered.width_px,
                                          rendered.channels,
                                          rendered.data.data(),
                                          target.data(),
                                          masks.known.empty() ? nullptr : masks.known.data(),
                                          in.pixel_weight ? in.pixel_weight->data.data() : nullptr,
                                          options.form == MaskLossForm::kLinear,
                                          float(options.lambda),
                                          float(weight * scale),
                                          row_sum.data(),
                                          gradient ? gradient->data.data() : nullptr};
  if (exec.device_ops) {
    loss.total = exec.device_ops->loss.mask(kernel, rendered.height_px);
  } else {
    for_each_index(exec, rendered.height_px, kernel);
    for (const double sum : row_sum) loss.total += sum;
  }
  loss.total *= scale;
  return loss;
}

}  // namespace ngs
