#pragma once
// Copies between rows of arrays, and the labels of trained cells: what a training step does between its ops. Each
// kernel gives its arrays to each_array(f).
#include <cmath>
#include <cstdint>
#include <variant>

#include "ngs/core/hd.h"
#include "ngs/math/sh.h"
#include "ngs/math/stable.h"
#include "ngs/math/vec.h"

namespace ngs {

/// Row r of `part` becomes row row[r] of `all`, in up to kColumns columns.
struct ScatterRows {
  static constexpr const char* kName = "scatter_rows";
  static constexpr int kColumns = 6;
  const std::int64_t* row;  // [R] unique
  int width[kColumns];      // 0: no such column
  const float* part[kColumns];
  float* all[kColumns];
  template <class F>
  void each_array(const F& f) {
    f(row);
    for (int c = 0; c < kColumns; ++c)
      if (width[c] > 0) {
        f(part[c]);
        f(all[c]);
      }
  }
  NGS_HD void operator()(std::int64_t r) const {
    for (int c = 0; c < kColumns; ++c)
      for (int k = 0; k < width[c]; ++k) all[c][row[r] * width[c] + k] = part[c][r * width[c] + k];
  }
};

/// Row r of `part` is row row[r] of `all`.
struct GatherRows {
  static constexpr const char* kName = "gather_rows";
  const std::uint32_t* row;  // [R]
  int width;
  const float* all;
  float* part;
  template <class F>
  void each_array(const F& f) {
    f(row);
    f(all);
    f(part);
  }
  NGS_HD void operator()(std::int64_t r) const {
    for (int k = 0; k < width; ++k) part[r * width + k] = all[std::int64_t(row[r]) * width + k];
  }
};

/// The colours of the constant SH band of some rows.
struct RowColours {
  static constexpr const char* kName = "row_colours";
  const std::uint32_t* row;  // [R]
  const float* sh_dc;        // [N, 3]
  float* colour;             // [R, 3] out
  template <class F>
  void each_array(const F& f) {
    f(row);
    f(sh_dc);
    f(colour);
  }
  NGS_HD void operator()(std::int64_t r) const {
    for (int c = 0; c < 3; ++c) colour[r * 3 + c] = float(colour_of_dc(double(sh_dc[std::int64_t(row[r]) * 3 + c])));
  }
};

/// Its adjoint, added to rows of the gradient.
struct AddRowColourGradients {
  static constexpr const char* kName = "add_row_colour_gradients";
  const std::int32_t* place;  // [R] unique row of `sh_dc`, -1: none
  const float* grad_colour;   // [R, 3]
  float* sh_dc;               // accumulated
  NGS_HD void operator()(std::int64_t r) const {
    if (place[r] < 0) return;
    for (int c = 0; c < 3; ++c) sh_dc[std::int64_t(place[r]) * 3 + c] += float(kShC0 * double(grad_colour[r * 3 + c]));
  }
};

/// Zeroes the gradients of position, shape and opacity of the chosen rows.
struct ClearShapes {
  static constexpr const char* kName = "clear_shapes";
  const std::uint8_t* chosen;                              // [R]
  float *position, *rotation, *log_scale, *logit_opacity;  // [R, 3], [R, 4], [R, 3], [R]
  template <class F>
  void each_array(const F& f) {
    f(chosen);
    f(position);
    f(rotation);
    f(log_scale);
    f(logit_opacity);
  }
  NGS_HD void operator()(std::int64_t r) const {
    if (!chosen[r]) return;
    for (int k = 0; k < 3; ++k) position[r * 3 + k] = log_scale[r * 3 + k] = 0;
    for (int k = 0; k < 4; ++k) rotation[r * 4 + k] = 0;
    logit_opacity[r] = 0;
  }
};

/// The weight of every pixel by its tile: 1 if the tile is near; of the others, `every` for those in one of `every`
/// cells of `cell` x `cell` tiles, else 0.
struct WeighTiles {
  static constexpr const char* kName = "weigh_tiles";
  int width, tile_px, cell, every, offset;
  const std::uint8_t* near;  // [tiles]
  float* weight;             // [pixels] out
  template <class F>
  void each_array(const F& f) {
    f(near);
    f(weight);
  }
  NGS_HD int across() const { return (width + tile_px - 1) / tile_px; }
  NGS_HD int of_tile(int tx, int ty) const {
    if (near[ty * across() + tx]) return 1;
    return (tx / cell + 2 * (ty / cell) + offset) % every == 0 ? every : 0;
  }
  /// One row of a tile's pixels; there are across() times the height.
  NGS_HD void operator()(std::int64_t r) const {
    const int tx = int(r % across()), y = int(r / across());
    const float of_pixels = float(of_tile(tx, y / tile_px));
    for (int x = tx * tile_px; x < width && x < (tx + 1) * tile_px; ++x)
      weight[std::int64_t(y) * width + x] = of_pixels;
  }
};

/// Where a pixel has no weight, image = target.
struct KeepWeighted {
  static constexpr const char* kName = "keep_weighted";
  int channels;
  const float* weight;  // [pixels]
  const float* target;  // [pixels, channels]; null: 0
  float* image;         // [pixels, channels]
  template <class F>
  void each_array(const F& f) {
    f(weight);
    f(image);
    if (target != nullptr) f(target);
  }
  NGS_HD void operator()(std::int64_t p) const {
    if (weight[p] > 0) return;
    for (std::int64_t i = p * channels; i < (p + 1) * channels; ++i) image[i] = target ? target[i] : 0.f;
  }
};

/// Adds one array to another.
struct AddValues {
  static constexpr const char* kName = "add_values";
  const float* from;
  float* to;
  template <class F>
  void each_array(const F& f) {
    f(from);
    f(to);
  }
  NGS_HD void operator()(std::int64_t i) const { to[i] += from[i]; }
};

/// Sums the projected gradients of the visible Gaussians over views.
struct AddProjectedGradients {
  static constexpr const char* kName = "add_projected_gradients";
  const std::uint8_t* visible;  // [N]
  const float* mean_px;         // [N, 2] px^-1
  float per_ndc_x, per_ndc_y;   // px per unit of normalised device coordinates
  float *sum, *views;           // [N] accumulated
  template <class F>
  void each_array(const F& f) {
    f(visible);
    f(mean_px);
    f(sum);
    f(views);
  }
  NGS_HD void operator()(std::int64_t i) const {
    using std::sqrt;
    if (!visible[i]) return;
    const float gx = per_ndc_x * mean_px[2 * i], gy = per_ndc_y * mean_px[2 * i + 1];
    sum[i] += sqrt(gx * gx + gy * gy);
    views[i] += 1;
  }
};

/// Lowers the opacity of visible Gaussians near a camera.
struct FadeNear {
  static constexpr const char* kName = "fade_near";
  const std::uint8_t* visible;  // [N]
  const float* position;        // [N, 3]
  Vec3<double> centre;          // of the camera
  double reach, loss;           // world, of a Gaussian at the camera
  float* logit_opacity;         // [N]
  template <class F>
  void each_array(const F& f) {
    f(visible);
    f(position);
    f(logit_opacity);
  }
  NGS_HD void operator()(std::int64_t i) const {
    using std::sqrt;
    if (!visible[i]) return;
    const float* p = position + 3 * i;
    const Vec3<double> d = Vec3<double>{double(p[0]), double(p[1]), double(p[2])} - centre;
    logit_opacity[i] -= float(loss * max2(0.0, 1 - sqrt(dot(d, d)) / reach));
  }
};

/// The trained labels: cells (row, object), of row r those from begin[r] to begin[r + 1].
struct LabelCells {
  const std::size_t* begin;     // [R + 1]
  const std::uint32_t* object;  // [cells]
  const float* logit;           // [cells]
  std::size_t objects;          // K
  std::size_t count;            // cells, more than 0

  template <class F>
  void each_array(const F& f) {
    f(begin);
    f(object);
    f(logit);
  }
};

/// From ∂L/∂(label) of the rows to ∂L/∂(log-odds) of their cells.
struct LabelCellGradients {
  static constexpr const char* kName = "label_cell_gradients";
  LabelCells cells;
  const float* grad_label;  // [R, K]
  float* grad;              // [cells] out
  template <class F>
  void each_array(const F& f) {
    cells.each_array(f);
    f(grad_label);
    f(grad);
  }
  NGS_HD void operator()(std::int64_t r) const {
    for (std::size_t c = cells.begin[r]; c < cells.begin[r + 1]; ++c)
      grad[c] = grad_label[std::size_t(r) * cells.objects + cells.object[c]] * sigmoid_slope(cells.logit[c]);
  }
};

/// The labels of the cells.
struct LabelCellValues {
  static constexpr const char* kName = "label_cell_values";
  LabelCells cells;
  const std::int64_t* row;  // [R] row of `label`; null: r
  float* label;             // [N, K]
  template <class F>
  void each_array(const F& f) {
    cells.each_array(f);
    f(label);
    if (row != nullptr) f(row);
  }
  NGS_HD void operator()(std::int64_t r) const {
    const std::size_t to = std::size_t(row ? row[r] : r);
    for (std::size_t c = cells.begin[r]; c < cells.begin[r + 1]; ++c)
      label[to * cells.objects + cells.object[c]] = sigmoid(cells.logit[c]);
  }
};

/// A kernel with an array per argument and a row per call.
using RowKernel = std::variant<ScatterRows, GatherRows, RowColours, ClearShapes, WeighTiles, KeepWeighted, AddValues,
                               AddProjectedGradients, FadeNear, LabelCellGradients, LabelCellValues>;

}  // namespace ngs
