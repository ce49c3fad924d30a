#include "ngs/passes/joint/field_mask_loss.h"

#include <algorithm>

namespace ngs {

double field_mask_loss(const Exec& exec, const FieldMasks& in, const FieldMaskWeight& weight,
                       std::vector<float>& grad) {
  const PixelGrid& g = in.rays.rays.grid;
  const int w = in.masks.width_px, h = in.masks.height_px;
  ImageF rendered(g.cols, g.rows, in.field.shape().objects);
  rendered.data = in.field.mask();
  ViewMasks at_nodes{g.cols, g.rows, {}, in.rays.on_surface, true};
  at_nodes.target.resize(in.masks.target.size());
  for (int r = 0; r < g.rows; ++r)
    for (int c = 0; c < g.cols; ++c) {
      const int x = std::clamp(int(g.x(c)), 0, w - 1), y = std::clamp(int(g.y(r)), 0, h - 1);
      const std::size_t p = std::size_t(y) * std::size_t(w) + std::size_t(x);
      for (std::size_t k = 0; k < at_nodes.target.size(); ++k) at_nodes.target[k].push_back(in.masks.target[k][p]);
      if (!in.masks.known.empty() && !in.masks.known[p]) at_nodes.known[std::size_t(r * g.cols + c)] = 0;
    }
  ImageF gradient;
  const MaskLoss loss = loss_mask(exec, {weight.form, 1.0}, {&rendered, &at_nodes}, weight.weight, &gradient);
  grad = std::move(gradient.data);
  return loss.total;
}

}  // namespace ngs
