#pragma once
// The photometric loss on a device: the formulas of ops/losses/photometric_kernels.h in the same order of sums. A block
// is a tile of pixels, blurred in shared memory with the pixels around it.
#include "ngs/ops/device/sum_kernel.h"
#include "ngs/ops/losses/photometric_kernels.h"

namespace ngs::ssim {

/// One channel of a tile and of the pixels that its windows reach.
template <int kPlanes>
struct BlurTile {
  static constexpr int kPx = 16, kThreads = kPx * kPx, kSide = kPx + 2 * kRadius;
  float value[kPlanes][kSide * kSide];  // 0 outside the image
  float row[kPlanes][kSide * kPx];      // blurred along the rows

  /// read(px, row, out) gives the values of a pixel of the image.
  template <class Read>
  NGS_HD void load(int t, const Layout& layout, std::int64_t tile, const Read& read) {
    const int x0 = left(layout, tile) - kRadius, y0 = top(layout, tile) - kRadius;
    for (int i = t; i < kSide * kSide; i += kThreads) {
      const int px = x0 + i % kSide, line = y0 + i / kSide;
      float out[kPlanes] = {};
      if (px >= 0 && px < layout.w && line >= 0 && line < layout.h) read(px, line, out);
      for (int m = 0; m < kPlanes; ++m) value[m][i] = out[m];
    }
  }
  NGS_HD void blur_rows(int t, const Window<float>& window) {
    for (int i = t; i < kSide * kPx; i += kThreads) {
      const int at = i / kPx * kSide + i % kPx + kRadius;
      for (int m = 0; m < kPlanes; ++m) row[m][i] = blurred<float>(window, [&](int k) { return value[m][at + k]; });
    }
  }
  /// The blurred values of the thread's pixel.
  NGS_HD void blur_columns(int t, const Window<float>& window, float* out) const {
    for (int m = 0; m < kPlanes; ++m)
      out[m] = blurred<float>(window, [&](int k) { return row[m][t + (kRadius + k) * kPx]; });
  }

  NGS_HD static int tiles_x(const Layout& layout) { return ceil_div(layout.w, kPx); }
  NGS_HD static std::int64_t tiles(const Layout& layout) {
    return std::int64_t(tiles_x(layout)) * ceil_div(layout.h, kPx);
  }
  NGS_HD static int left(const Layout& layout, std::int64_t tile) { return int(tile % tiles_x(layout)) * kPx; }
  NGS_HD static int top(const Layout& layout, std::int64_t tile) { return int(tile / tiles_x(layout)) * kPx; }
};

/// The two loss terms of each pixel, and the partials times the factor of S in the loss.
struct LossTile {
  static constexpr const char* kName = "ssim_loss_tile";
  using Shared = BlurTile<kMoments>;
  static constexpr int kThreads = Shared::kThreads;
  Layout layout;
  Window<float> window;
  Crop<const float> x, y;
  PixelWeights weights;
  float ssim_factor;
  float* partials;  // [kPartials, h, w·c] out
  double* term;     // [h·w, 2] out: Σ_channels w |x - y|, Σ_channels w S
  struct Thread {
    double l1, similar;
  };

  template <class Block>
  NGS_HD void operator()(Block& block) const {
    block.phase([&](int, Shared&, Thread& own) { own.l1 = own.similar = 0; });
    for (int c = 0; c < layout.c; ++c) {
      block.phase([&](int t, Shared& shared, Thread&) {
        shared.load(t, layout, block.index, [&](int px, int line, float* out) {
          const int at = px * layout.c + c;
          products(x.row(line)[at], y.row(line)[at], out);
        });
      });
      block.phase([&](int t, Shared& shared, Thread&) { shared.blur_rows(t, window); });
      block.phase([&](int t, Shared& shared, Thread& own) { add_channel(t, block.index, c, shared, own); });
    }
    block.phase([&](int t, Shared&, Thread& own) {
      const int px = Shared::left(layout, block.index) + t % Shared::kPx,
                line = Shared::top(layout, block.index) + t / Shared::kPx;
      if (px >= layout.w || line >= layout.h) return;
      double* const to = term + (std::int64_t(line) * layout.w + px) * 2;
      to[0] = own.l1;
      to[1] = own.similar;
    });
  }

 private:
  NGS_HD void add_channel(int t, std::int64_t tile, int c, const Shared& shared, Thread& own) const {
    const int px = Shared::left(layout, tile) + t % Shared::kPx, line = Shared::top(layout, tile) + t / Shared::kPx;
    if (px >= layout.w || line >= layout.h) return;
    const int value = px * layout.c + c;
    const float w = weights.at(px, line), factor = w * ssim_factor;
    float moment[kMoments], partial[kPartials];
    shared.blur_columns(t, window, moment);
    own.similar += double(w * similarity(moment, partial));
    own.l1 += double(w * distance(x.row(line)[value], y.row(line)[value]));
    const std::int64_t plane = layout.width() * layout.h, at = line * layout.width() + value;
    for (int d = 0; d < kPartials; ++d) partials[d * plane + at] = partial[d] * factor;
  }
};

/// The gradient of each pixel.
struct GradientTile {
  static constexpr const char* kName = "ssim_gradient_tile";
  using Shared = BlurTile<kPartials>;
  static constexpr int kThreads = Shared::kThreads;
  Layout layout;
  Window<float> window;
  const float* partials;  // of LossTile
  Crop<const float> x, y;
  PixelWeights weights;
  float l1_factor;
  Crop<float> gradient;
  struct Thread {};

  template <class Block>
  NGS_HD void operator()(Block& block) const {
    const std::int64_t plane = layout.width() * layout.h;
    for (int c = 0; c < layout.c; ++c) {
      block.phase([&](int t, Shared& shared, Thread&) {
        shared.load(t, layout, block.index, [&](int px, int line, float* out) {
          for (int d = 0; d < kPartials; ++d) out[d] = partials[d * plane + line * layout.width() + px * layout.c + c];
        });
      });
      block.phase([&](int t, Shared& shared, Thread&) { shared.blur_rows(t, window); });
      block.phase([&](int t, Shared& shared, Thread&) {
        const int px = Shared::left(layout, block.index) + t % Shared::kPx,
                  line = Shared::top(layout, block.index) + t / Shared::kPx;
        if (px >= layout.w || line >= layout.h) return;
        const int value = px * layout.c + c;
        float partial[kPartials];
        shared.blur_columns(t, window, partial);
        gradient.row(line)[value] =
            gradient_of(partial, x.row(line)[value], y.row(line)[value], weights.at(px, line) * l1_factor);
      });
    }
  }
};

/// The device part of PhotometricPass: the gradient, and Σ w |x - y| and Σ w S in `sums`. All pointers
/// are device pointers.
template <class Launcher>
void photometric_on_device(Launcher& launcher, const Comparison<float>& in, double* sums) {
  const Layout& layout = in.layout;
  const std::int64_t pixels = std::int64_t(layout.w) * layout.h, tiles = BlurTile<1>::tiles(layout);
  const DeviceBuffer<Launcher, float> partials(launcher, pixels * layout.c * kPartials);
  const DeviceBuffer<Launcher, double> term(launcher, pixels * 2);
  const Window<float> window;
  launcher.launch_blocks(
      tiles, LossTile{layout, window, in.x, in.y, in.weights, float(in.ssim_factor), partials.data(), term.data()});
  if (in.gradient.first != nullptr)
    launcher.launch_blocks(
        tiles, GradientTile{layout, window, partials.data(), in.x, in.y, in.weights, float(in.l1_factor), in.gradient});
  sums_on_device(launcher, term.data(), pixels, 2, sums);
}

}  // namespace ngs::ssim
