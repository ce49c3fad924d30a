#pragma once
// The photometric loss on a device: the kernels of ops/losses/photometric_kernels.h value by value, in the same order
// of sums.
#include "ngs/ops/device/sum_kernel.h"
#include "ngs/ops/losses/photometric_kernels.h"

namespace ngs::ssim {

struct ProductValues {
  static constexpr const char* kName = "ssim_products";
  Layout layout;
  Crop<const float> x, y;
  float* planes;  // [kMoments, plane]
  NGS_HD void operator()(std::int64_t i) const {
    const int row = int(i / layout.width());
    const std::int64_t at = i % layout.width();
    float out[kMoments];
    products(x.row(row)[at], y.row(row)[at], out);
    for (int m = 0; m < kMoments; ++m) planes[m * layout.plane() + layout.row(row) + at] = out[m];
  }
};

/// Value i of the planes, plane by plane and row by row.
struct BlurRowValues {
  static constexpr const char* kName = "ssim_blur_rows";
  Layout layout;
  Window<float> window;
  const float* in;
  float* out;
  NGS_HD void operator()(std::int64_t i) const {
    const std::int64_t line = i / layout.width();
    const std::int64_t at = line / layout.h * layout.plane() + layout.row(int(line % layout.h)) + i % layout.width();
    out[at] = blurred<float>(window, [&](int k) { return in[at + k * layout.c]; });
  }
};
struct BlurColumnValues {
  static constexpr const char* kName = "ssim_blur_columns";
  Layout layout;
  Window<float> window;
  const float* in;
  float* out;
  NGS_HD void operator()(std::int64_t i) const {
    const std::int64_t line = i / layout.width();
    const int y = int(line % layout.h);
    const std::int64_t at = line / layout.h * layout.plane() + layout.row(y) + i % layout.width();
    out[at] = blurred<float>(
        window, [&](int k) { return y + k < 0 || y + k >= layout.h ? 0.f : in[at + k * layout.stride()]; });
  }
};

/// Pixel i: its two loss terms, and the partials times the factor of S in the loss.
struct PixelLoss {
  static constexpr const char* kName = "ssim_loss";
  Layout layout;
  const float* blur;  // [kMoments, plane]
  float* partials;    // [kPartials, plane] out
  Crop<const float> x, y;
  PixelWeights weights;
  float ssim_factor;
  double* term;  // [h·w, 2] out: Σ_channels w |x - y|, Σ_channels w S

  NGS_HD void operator()(std::int64_t i) const {
    const int row = int(i / layout.w), px = int(i % layout.w);
    const float w = weights.at(px, row), factor = w * ssim_factor;
    double l1 = 0, similar = 0;
    for (int c = 0; c < layout.c; ++c) {
      const std::int64_t value = std::int64_t(px) * layout.c + c, at = layout.row(row) + value;
      float moment[kMoments], partial[kPartials];
      for (int m = 0; m < kMoments; ++m) moment[m] = blur[m * layout.plane() + at];
      similar += double(w * similarity(moment, partial));
      l1 += double(w * distance(x.row(row)[value], y.row(row)[value]));
      for (int d = 0; d < kPartials; ++d) partials[d * layout.plane() + at] = partial[d] * factor;
    }
    term[i * 2] = l1, term[i * 2 + 1] = similar;
  }
};

/// Value i of the crop.
struct ValueGradient {
  static constexpr const char* kName = "ssim_gradient";
  Layout layout;
  const float* blur;  // [kPartials, plane]
  Crop<const float> x, y;
  PixelWeights weights;
  float l1_factor;
  Crop<float> gradient;
  NGS_HD void operator()(std::int64_t i) const {
    const int row = int(i / layout.width());
    const std::int64_t value = i % layout.width(), at = layout.row(row) + value;
    const float factor = weights.at(int(value / layout.c), row) * l1_factor;
    float partial[kPartials];
    for (int d = 0; d < kPartials; ++d) partial[d] = blur[d * layout.plane() + at];
    gradient.row(row)[value] = gradient_of(partial, x.row(row)[value], y.row(row)[value], factor);
  }
};

/// The device part of PhotometricPass: the gradient, and Σ w |x - y| and Σ w S in `sums`. All pointers
/// are device pointers.
template <class Launcher>
void photometric_on_device(Launcher& launcher, const Comparison<float>& in, double* sums) {
  const Layout& layout = in.layout;
  const std::int64_t values = layout.width() * layout.h, pixels = std::int64_t(layout.w) * layout.h;
  DeviceBuffer<Launcher, float> products(launcher, layout.plane() * kMoments);
  products.zero();  // the padding stays zero
  const DeviceBuffer<Launcher, float> rows(launcher, layout.plane() * kMoments),
      both(launcher, layout.plane() * kMoments);
  const DeviceBuffer<Launcher, double> term(launcher, pixels * 2);
  const Window<float> window;
  const auto blur = [&](int planes) {
    launcher.parallel_for(planes * values, BlurRowValues{layout, window, products.data(), rows.data()});
    launcher.parallel_for(planes * values, BlurColumnValues{layout, window, rows.data(), both.data()});
  };
  launcher.parallel_for(values, ProductValues{layout, in.x, in.y, products.data()});
  blur(kMoments);
  launcher.parallel_for(pixels, PixelLoss{layout, both.data(), products.data(), in.x, in.y, in.weights,
                                          float(in.ssim_factor), term.data()});
  if (in.gradient.first != nullptr) {
    blur(kPartials);
    launcher.parallel_for(values,
                          ValueGradient{layout, both.data(), in.x, in.y, in.weights, float(in.l1_factor), in.gradient});
  }
  sums_on_device(launcher, term.data(), pixels, 2, sums);
}

}  // namespace ngs::ssim
