#pragma once
// The photometric loss on a device: the kernels of ops/photometric_kernels.h value by value, in the same order of sums.
#include "ngs/ops/photometric_kernels.h"
#include "ngs/ops/sum_grid.h"

namespace ngs::ssim {

struct ProductValues {
  static constexpr const char* kName = "ssim_products";
  Products<float> row;
  NGS_HD void operator()(std::int64_t i) const {
    const std::int64_t y = i / row.layout.width(), at = i % row.layout.width();
    Products<float>::store(row.planes + row.layout.row(int(y)) + at, row.layout.plane(), row.x.row(int(y))[at],
                           row.y.row(int(y))[at]);
  }
};
struct BlurRowValues {
  static constexpr const char* kName = "ssim_blur_rows";
  BlurRow<float> row;
  NGS_HD void operator()(std::int64_t i) const { row.at(i / row.layout.width(), i % row.layout.width()); }
};
struct BlurColumnValues {
  static constexpr const char* kName = "ssim_blur_columns";
  BlurColumn<float> row;
  NGS_HD void operator()(std::int64_t i) const { row.at(i / row.layout.width(), i % row.layout.width()); }
};

/// Pixel i: its sums, and the partials times the factor of S in the loss.
struct PixelLoss {
  static constexpr const char* kName = "ssim_loss";
  Layout layout;
  const float* blurred;  // [kMoments, plane]
  float* partials;       // [kPartials, plane] out
  Crop<const float> x, y;
  PixelWeights weights;
  double ssim_factor;
  double* term;  // [h·w, 2] out: Σ_channels w |x - y|, Σ_channels w S

  NGS_HD void operator()(std::int64_t i) const {
    using std::abs;
    const int row = int(i / layout.w), px = int(i % layout.w);
    const std::int64_t plane = layout.plane();
    const double w = weights.at(px, row);
    const float factor = float(w * ssim_factor);
    double l1 = 0, similar = 0;
    for (int c = 0; c < layout.c; ++c) {
      const std::int64_t value = std::int64_t(px) * layout.c + c, at = layout.row(row) + value;
      const float moment[kMoments] = {blurred[at], blurred[plane + at], blurred[2 * plane + at], blurred[3 * plane + at],
                                      blurred[4 * plane + at]};
      float partial[kPartials];
      similar += w * double(similarity(moment, partial));
      l1 += w * double(abs(x.row(row)[value] - y.row(row)[value]));
      for (int d = 0; d < kPartials; ++d) partials[d * plane + at] = partial[d] * factor;
    }
    term[i * 2] = l1, term[i * 2 + 1] = similar;
  }
};

struct PixelGradient {
  static constexpr const char* kName = "ssim_gradient";
  RowGradient<float> row;
  NGS_HD void operator()(std::int64_t i) const {
    const Layout& layout = row.layout;
    const int y = int(i / layout.w), px = int(i % layout.w);
    const float factor = float(row.weights.at(px, y) * row.l1_factor);
    for (int c = 0; c < layout.c; ++c) {
      const std::int64_t value = std::int64_t(px) * layout.c + c;
      row.gradient.row(y)[value] = RowGradient<float>::value(row.blurred + layout.row(y) + value, layout.plane(),
                                                             row.x.row(y)[value], row.y.row(y)[value], factor);
    }
  }
};

/// What PhotometricPass does between preparing the crop and dividing the sums; crops on the grid. Returns Σ w |x - y| and
/// Σ w S. `gradient.first` null: not wanted.
template <class Grid>
std::vector<double> photometric_on_grid(Grid& grid, const Layout& layout, Crop<const float> x, Crop<const float> y,
                                        const PixelWeights& weights, double ssim_factor, double l1_factor,
                                        Crop<float> gradient) {
  const std::int64_t values = layout.width() * layout.h, pixels = std::int64_t(layout.w) * layout.h;
  GridBuffer<Grid, float> products(grid, layout.plane() * kMoments);
  products.zero();  // the padding stays
  const GridBuffer<Grid, float> rows(grid, layout.plane() * kMoments), blurred(grid, layout.plane() * kMoments);
  const GridBuffer<Grid, double> term(grid, pixels * 2);
  const Window window;
  const auto blur = [&](int planes) {
    grid.each(planes * values, BlurRowValues{{layout, window, products.data(), rows.data()}});
    grid.each(planes * values, BlurColumnValues{{layout, window, rows.data(), blurred.data()}});
  };
  grid.each(values, ProductValues{{layout, x, y, products.data()}});
  blur(kMoments);
  grid.each(pixels, PixelLoss{layout, blurred.data(), products.data(), x, y, weights, ssim_factor, term.data()});
  if (gradient.first != nullptr) {
    blur(kPartials);
    grid.each(pixels, PixelGradient{{layout, blurred.data(), x, y, weights, l1_factor, gradient}});
  }
  return ordered_sums(grid, term.data(), pixels, 2);
}

}  // namespace ngs::ssim
