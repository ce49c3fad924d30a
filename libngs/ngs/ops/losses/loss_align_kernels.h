#pragma once
// Alignment of the rendered view and the field at the nodes of the boundary grid.   Eq. (16); C15, C17
//
//   L = 1/|B| Σ_i [ ‖C_gs - C_f‖² + w_α (α_gs - α_f)² + w_v · excess(Var(R_i)) ]      over the active nodes
//
// C_gs, α_gs: the rendered images read bilinearly at the node. R_i: the 7x7 pixels around the node's pixel, clipped at
// the image border; Var = mean squared distance to the mean colour, in two passes (E[x²] - E[x]² cancels).
#include "ngs/core/hd.h"
#include "ngs/math/pixel_grid.h"
#include "ngs/math/vec.h"
#include "ngs/scene/views.h"

namespace ngs {

inline constexpr int kPatchRadiusPx = 3;

/// Interleaved pixels of an image.
template <class T>
struct PixelView {
  const T* data = nullptr;  // [H, W, C]
  int width = 0, height = 0;
  NGS_HD const T* at(int x, int y, int channels) const {
    return data + (static_cast<std::int64_t>(y) * width + x) * channels;
  }
};

/// The patch around a node.
struct PatchRect {
  int x0, x1, y0, y1;  // inclusive
  NGS_HD int pixels() const { return (x1 - x0 + 1) * (y1 - y0 + 1); }
  NGS_HD bool contains(int x, int y) const { return x >= x0 && x <= x1 && y >= y0 && y <= y1; }
};
NGS_HD inline PatchRect patch_at(double x_px, double y_px, int width, int height) {
  const int x = clamp3(int(x_px), 0, width - 1), y = clamp3(int(y_px), 0, height - 1);
  return {max2(x - kPatchRadiusPx, 0), min2(x + kPatchRadiusPx, width - 1), max2(y - kPatchRadiusPx, 0),
          min2(y + kPatchRadiusPx, height - 1)};
}

/// Mean colour of a patch and the mean squared distance to it.
template <class T>
NGS_HD T patch_variance(const PixelView<T>& image, const PatchRect& patch, Vec3<T>& mean) {
  const T share = T(1) / T(patch.pixels());
  mean = {T(0), T(0), T(0)};
  for (int y = patch.y0; y <= patch.y1; ++y)
    for (int x = patch.x0; x <= patch.x1; ++x) mean = mean + vec3(image.at(x, y, 3));
  mean = share * mean;
  T variance = T(0);
  for (int y = patch.y0; y <= patch.y1; ++y)
    for (int x = patch.x0; x <= patch.x1; ++x) {
      const Vec3<T> d = vec3(image.at(x, y, 3)) - mean;
      variance += dot(d, d);
    }
  return share * variance;
}

/// Inputs of forward and backward.
template <class T>
struct AlignView {
  PixelGrid grid;
  PixelView<T> colour, alpha;  // rendered, [H, W, 3] and [H, W, 1]
  const T* field_colour;       // [R, 3]
  const T* field_alpha;        // [R]
  const std::uint8_t* active;  // [R]; null: all
  T weight_alpha, weight_variance;

  NGS_HD bool is_active(std::int64_t r) const { return active == nullptr || active[r] != 0; }
};

/// Stored by forward for backward; all zero for inactive nodes.
template <class T>
struct AlignNodes {
  T* colour_residual;  // [R, 3] C_gs - C_f
  T* alpha_residual;   // [R]    α_gs - α_f
  T* patch_mean;       // [R, 3]
  T* patch_share;      // [R]    1 / pixels of the patch where the variance counts, else 0
};

/// Owns node r. term: the three parts of its loss, unweighted.
template <class T>
struct AlignForward {
  static constexpr const char* kName = "align_forward";
  AlignView<T> in;
  AlignNodes<T> node;
  T* term;  // [R, 3] out: colour, alpha, variance

  NGS_HD void operator()(std::int64_t r) const {
    Vec3<T> colour{T(0), T(0), T(0)}, mean = colour;
    T alpha = T(0), variance = T(0), share = T(0);
    if (in.is_active(r)) {
      const double u = in.grid.x(int(r % in.grid.cols)), v = in.grid.y(int(r / in.grid.cols));
      const BilinearAxis x = bilinear_axis(u, in.colour.width), y = bilinear_axis(v, in.colour.height);
      colour = sample_colour(x, y) - vec3(in.field_colour + r * 3);
      alpha = sample_alpha(x, y) - in.field_alpha[r];
      const PatchRect patch = patch_at(u, v, in.colour.width, in.colour.height);
      variance = patch_variance(in.colour, patch, mean);
      if (variance > T(0))
        share = T(1) / T(patch.pixels());
      else
        variance = T(0);
    }
    T* residual = node.colour_residual + r * 3;
    residual[0] = colour.x;
    residual[1] = colour.y;
    residual[2] = colour.z;
    node.alpha_residual[r] = alpha;
    T* m = node.patch_mean + r * 3;
    m[0] = mean.x;
    m[1] = mean.y;
    m[2] = mean.z;
    node.patch_share[r] = share;
    term[r * 3] = dot(colour, colour);
    term[r * 3 + 1] = alpha * alpha;
    term[r * 3 + 2] = variance;
  }

 private:
  NGS_HD Vec3<T> sample_colour(const BilinearAxis& x, const BilinearAxis& y) const {
    const T x1 = T(x.weight), x0 = T(1) - x1, y1 = T(y.weight), y0 = T(1) - y1;
    return y0 * (x0 * vec3(in.colour.at(x.lower, y.lower, 3)) + x1 * vec3(in.colour.at(x.upper, y.lower, 3))) +
           y1 * (x0 * vec3(in.colour.at(x.lower, y.upper, 3)) + x1 * vec3(in.colour.at(x.upper, y.upper, 3)));
  }
  NGS_HD T sample_alpha(const BilinearAxis& x, const BilinearAxis& y) const {
    const T x1 = T(x.weight), x0 = T(1) - x1, y1 = T(y.weight), y0 = T(1) - y1;
    return y0 * (x0 * *in.alpha.at(x.lower, y.lower, 1) + x1 * *in.alpha.at(x.upper, y.lower, 1)) +
           y1 * (x0 * *in.alpha.at(x.lower, y.upper, 1) + x1 * *in.alpha.at(x.upper, y.upper, 1));
  }
};

/// ∂L/∂(field colour and alpha) of node r; scale = ∂(total)/∂(sum of terms).
template <class T>
struct AlignBackwardField {
  static constexpr const char* kName = "align_backward_field";
  AlignNodes<T> node;
  T weight_alpha, scale;
  T* grad_colour;  // [R, 3] out, overwritten
  T* grad_alpha;   // [R]    out, overwritten

  NGS_HD void operator()(std::int64_t r) const {
    for (int c = 0; c < 3; ++c) grad_colour[r * 3 + c] = T(-2) * scale * node.colour_residual[r * 3 + c];
    grad_alpha[r] = T(-2) * scale * weight_alpha * node.alpha_residual[r];
  }
};

/// ∂L/∂(rendered images) at one pixel of the rectangle [x0, ...) x [y0, ...): the transpose of the bilinear reading and
/// of the patches, gathered over the nodes near the pixel (inactive nodes contribute zero). Owns pixel i
/// of the rectangle.
///   ∂Var/∂C_p = 2 (C_p - mean) / n   (the mean's own derivative cancels)
template <class T>
struct AlignBackwardImage {
  static constexpr const char* kName = "align_backward_image";
  AlignView<T> in;
  AlignNodes<T> node;
  T scale;
  int x0, y0, rect_width;
  T* grad_colour_accumulate;  // [H, W, 3]
  T* grad_alpha_accumulate;   // [H, W]

  NGS_HD void operator()(std::int64_t i) const {
    const int x = x0 + int(i % rect_width), y = y0 + int(i / rect_width);
    const int width = in.colour.width, height = in.colour.height;
    constexpr double kReachPx = kPatchRadiusPx + 1.0;
    const NodeRange cols = nodes_near({in.grid.first_x, in.grid.step_x, in.grid.cols}, width, x, kReachPx);
    const NodeRange rows = nodes_near({in.grid.first_y, in.grid.step_y, in.grid.rows}, height, y, kReachPx);
    const Vec3<T> here = vec3(in.colour.at(x, y, 3));
    Vec3<T> colour{T(0), T(0), T(0)};
    T alpha = T(0);
    for (int row = rows.first; row <= rows.last; ++row)
      for (int col = cols.first; col <= cols.last; ++col) {
        const std::int64_t r = static_cast<std::int64_t>(row) * in.grid.cols + col;
        const double u = in.grid.x(col), v = in.grid.y(row);
        const double reading = bilinear_weight(u, width, x) * bilinear_weight(v, height, y);
        if (reading > 0) {
          colour = colour + T(reading) * vec3(node.colour_residual + r * 3);
          alpha += T(reading) * in.weight_alpha * node.alpha_residual[r];
        }
        if (patch_at(u, v, width, height).contains(x, y))
          colour = colour + (in.weight_variance * node.patch_share[r]) * (here - vec3(node.patch_mean + r * 3));
      }
    const std::int64_t pixel = static_cast<std::int64_t>(y) * width + x;
    T* g = grad_colour_accumulate + pixel * 3;
    const T twice = T(2) * scale;
    g[0] += twice * colour.x;
    g[1] += twice * colour.y;
    g[2] += twice * colour.z;
    grad_alpha_accumulate[pixel] += twice * alpha;
  }
};

}  // namespace ngs
