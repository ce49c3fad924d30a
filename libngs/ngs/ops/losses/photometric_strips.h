#pragma once
// CPU loops over ops/losses/photometric_kernels.h. The image is cut into strips of columns. The last 11 rows of a strip
// stay in the L1 cache while both passes of the window move down the image. Internal to ops.
#include <algorithm>
#include <vector>

#include "ngs/core/prefetch.h"
#include "ngs/math/lanes.h"
#include "ngs/ops/losses/photometric_kernels.h"

namespace ngs::ssim {

inline constexpr int kStrip = 128;  // values per row of a strip; affects only speed and the order of the loss's sums
inline constexpr int kBand = 128;   // rows of a strip per work item
inline constexpr int kRing = 2 * kRadius + 1;

template <class T>
struct StripLane {
  using Type = T;
};
template <>
struct StripLane<float> {
  using Type = PackF;
};

/// A sum over lanes in a wider scalar.
template <class L, class Acc>
struct WideSum {
  Acc sum = Acc(0);
  void add(L x) { sum += Acc(x); }
  Acc total() const { return sum; }
};
template <class L>
requires(LaneTraits<L>::kLanes == 8) struct WideSum<L, double> {
  using Four = decltype(low_half(L()));
  Four low = 0.0, high = 0.0;
  void add(L x) {
    low = low + low_half(x);
    high = high + high_half(x);
  }
  double total() const {
    const Four four = low + high;
    return (four.lane(0) + four.lane(1)) + (four.lane(2) + four.lane(3));
  }
};

/// One work item: values [begin, begin + count) of rows [y0, y1).
struct StripBand {
  std::int64_t begin;
  int count, y0, y1;
};

struct StripPlan {
  Layout layout;
  std::int64_t strips() const { return (layout.width() + kStrip - 1) / kStrip; }
  std::int64_t size() const { return strips() * ((layout.h + kBand - 1) / kBand); }
  StripBand band(std::int64_t task) const {
    const std::int64_t begin = task % strips() * kStrip;
    const int y0 = int(task / strips()) * kBand;
    return {begin, int(std::min<std::int64_t>(kStrip, layout.width() - begin)), y0, std::min(layout.h, y0 + kBand)};
  }
};

/// The next row of a strip is a whole image row away, which the hardware prefetcher does not predict. Rows are
/// prefetched this many rows ahead.
inline constexpr int kRowsAhead = 2;

/// One row of several planes as input of the blur: value i of the strip is first[i], i >= -pad; planes are `plane`
/// values apart.
template <class T>
struct PlaneRows {
  const T* first;
  std::int64_t plane;
};

/// Blurs `count` values of a row of each plane along the row, into the planes' rows of kStrip values at `to`.
/// Neighbouring pixels are `step` values apart.
template <class T, int kPlanes>
void blur_rows(const Window<T>& window, const PlaneRows<T>& from, std::int64_t step, int count, T* to) {
  using L = typename StripLane<T>::Type;
  for (int p = 0; p < kPlanes; ++p)
    for (int i = 0; i < count; i += LaneTraits<L>::kLanes) {
      const T* middle = from.first + p * from.plane + i;
      store_lanes(to + p * kStrip + i, blurred<L>(window, [&](int k) {
                    L value;
                    load_lanes(middle + k * step, value);
                    return value;
                  }));
    }
}

/// Calls use(y, column) for every row of the band, where column(plane, i) is the pack of values from i of the plane
/// blurred both ways. load(y) gives the PlaneRows of row y of the image.
template <class T, int kPlanes, class Load, class Use>
void blur_band(const Layout& layout, const Window<T>& window, const StripBand& band, const Load& load, const Use& use) {
  using L = typename StripLane<T>::Type;
  alignas(64) T ring[kRing][kPlanes][kStrip];
  const auto slot = [&](int y) { return &ring[(y + kRing) % kRing][0][0]; };
  for (int y = band.y0 - kRadius; y < band.y1 + kRadius; ++y) {
    T* to = slot(y);
    if (y < 0 || y >= layout.h)
      std::fill_n(to, kPlanes * kStrip, T(0));
    else
      blur_rows<T, kPlanes>(window, load(y), layout.c, band.count, to);
    const int out = y - kRadius;
    if (out < band.y0) continue;
    const T* row[kRing];
    for (int k = -kRadius; k <= kRadius; ++k) row[k + kRadius] = slot(out + k);
    use(out, [&](int p, int i) {
      return blurred<L>(window, [&](int k) {
        L value;
        load_lanes(row[k + kRadius] + p * kStrip + i, value);
        return value;
      });
    });
  }
}

/// Copies values [begin, end) of a row of `width`; zero outside the row.
template <class T>
void copy_row(const T* row, std::int64_t width, std::int64_t begin, std::int64_t end, T* out) {
  const std::int64_t first = std::max<std::int64_t>(begin, 0), last = std::min(end, width);
  std::fill(out, out + (first - begin), T(0));
  std::copy(row + first, row + last, out + (first - begin));
  std::fill(out + (last - begin), out + (end - begin), T(0));
}

/// x and y of one row of a strip.
template <class T>
struct StripRow {
  alignas(64) T x[kStrip], y[kStrip];
  void load(const Crop<const T>& a, const Crop<const T>& b, std::int64_t width, int row, const StripBand& band) {
    copy_row(a.row(row), width, band.begin, band.begin + kStrip, x);
    copy_row(b.row(row), width, band.begin, band.begin + kStrip, y);
  }
};

/// The weights of the pixels of a strip, value by value; zero outside.
template <class T>
class StripWeights {
 public:
  StripWeights(const PixelWeights& weights, const Layout& layout, const StripBand& band)
      : weights_(weights), layout_(layout), band_(band) {
    fill(weights.y0);
  }
  const T* row(int y) {
    if (y < weights_.y0 || y >= weights_.y1) return zero_;
    if (weights_.weight.first) fill(y);
    return value_;
  }

 private:
  void fill(int y) {
    for (int i = 0; i < band_.count; ++i) value_[i] = T(weights_.at(int((band_.begin + i) / layout_.c), y));
  }
  const PixelWeights& weights_;
  const Layout& layout_;
  const StripBand& band_;
  alignas(64) T value_[kStrip] = {};
  alignas(64) T zero_[kStrip] = {};
};

/// Clears the padding of one row of a plane if the band is at the end of the row.
template <class T>
void clear_padding(const Layout& layout, const StripBand& band, T* row) {
  if (band.begin == 0) std::fill_n(row - layout.pad(), layout.pad(), T(0));
  const std::int64_t width = layout.width();
  if (band.begin + band.count == width) std::fill_n(row + width, layout.stride() - layout.pad() - width, T(0));
}

/// Σ w |x - y| and Σ w S of a band, and the partials times the factor of S, with zero padding.
template <class T, class Acc>
struct BandLoss {
  Layout layout;
  Window<T> window;
  Crop<const T> x, y;
  PixelWeights weights;
  T ssim_factor;  // ∂L/∂S of a pixel of weight 1
  T* partials;    // [kPartials, plane] out; null: not wanted
  Acc* sums;      // [tasks, 2] out

  void operator()(std::int64_t task) const {
    using L = typename StripLane<T>::Type;
    constexpr int kLanes = LaneTraits<L>::kLanes;
    const StripBand band = StripPlan{layout}.band(task);
    const std::int64_t wide = (kStrip + 2 * layout.pad() + kLanes - 1) / kLanes * kLanes;
    std::vector<T> memory(std::size_t(wide) * (2 + kMoments));
    T *a = memory.data(), *b = a + wide, *planes = b + wide;
    const auto load = [&](int row) {
      if (row + kRowsAhead < layout.h)
        for (const Crop<const T>& image : {x, y}) prefetch_values(image.row(row + kRowsAhead) + band.begin, band.count);
      copy_row(x.row(row), layout.width(), band.begin - layout.pad(), band.begin - layout.pad() + wide, a);
      copy_row(y.row(row), layout.width(), band.begin - layout.pad(), band.begin - layout.pad() + wide, b);
      for (std::int64_t i = 0; i < wide; i += kLanes) {
        L in[2], out[kMoments];
        load_lanes(a + i, in[0]);
        load_lanes(b + i, in[1]);
        products(in[0], in[1], out);
        for (int m = 0; m < kMoments; ++m) store_lanes(planes + m * wide + i, out[m]);
      }
      return PlaneRows<T>{planes + layout.pad(), wide};
    };
    StripRow<T> pixels;
    StripWeights<T> strip_weights(weights, layout, band);
    WideSum<L, Acc> l1, similar;
    blur_band<T, kMoments>(layout, window, band, load, [&](int row, const auto& column) {
      pixels.load(x, y, layout.width(), row, band);
      const T* weight = strip_weights.row(row);
      for (int i = 0; i < band.count; i += kLanes) {
        L moment[kMoments], partial[kPartials], w, at_x, at_y;
        for (int m = 0; m < kMoments; ++m) moment[m] = column(m, i);
        load_lanes(weight + i, w);
        load_lanes(pixels.x + i, at_x);
        load_lanes(pixels.y + i, at_y);
        similar.add(w * similarity(moment, partial));
        l1.add(w * distance(at_x, at_y));
        if (partials == nullptr) continue;
        const L factor = w * L(ssim_factor);
        T* out = partials + layout.row(row) + band.begin + i;
        for (int d = 0; d < kPartials; ++d) store_lanes(out + d * layout.plane(), partial[d] * factor);
      }
      for (int d = 0; partials && d < kPartials; ++d)
        clear_padding(layout, band, partials + d * layout.plane() + layout.row(row));
    });
    sums[2 * task] = l1.total();
    sums[2 * task + 1] = similar.total();
  }
};

/// The gradient of a band from the partials.                                                  adjoint of BandLoss
template <class T>
struct BandGradient {
  Layout layout;
  Window<T> window;
  Crop<const T> x, y;
  PixelWeights weights;
  T l1_factor;
  const T* partials;  // [kPartials, plane]
  Crop<T> gradient;   // out

  void operator()(std::int64_t task) const {
    using L = typename StripLane<T>::Type;
    constexpr int kLanes = LaneTraits<L>::kLanes;
    const StripBand band = StripPlan{layout}.band(task);
    StripRow<T> pixels;
    StripWeights<T> strip_weights(weights, layout, band);
    alignas(64) T result[kStrip];
    const auto load = [&](int row) {
      const T* first = partials + layout.row(row) + band.begin;
      if (row + kRowsAhead < layout.h) {
        const T* ahead = first + kRowsAhead * layout.stride() - layout.pad();
        for (int d = 0; d < kPartials; ++d) prefetch_values(ahead + d * layout.plane(), band.count + 2 * layout.pad());
      }
      const int of_pixels = row - kRadius + kRowsAhead;
      if (of_pixels >= 0 && of_pixels < layout.h)
        for (const Crop<const T>& image : {x, y}) prefetch_values(image.row(of_pixels) + band.begin, band.count);
      return PlaneRows<T>{first, layout.plane()};
    };
    blur_band<T, kPartials>(layout, window, band, load, [&](int row, const auto& column) {
      pixels.load(x, y, layout.width(), row, band);
      const T* weight = strip_weights.row(row);
      for (int i = 0; i < band.count; i += kLanes) {
        L blur[kPartials], w, at_x, at_y;
        for (int d = 0; d < kPartials; ++d) blur[d] = column(d, i);
        load_lanes(weight + i, w);
        load_lanes(pixels.x + i, at_x);
        load_lanes(pixels.y + i, at_y);
        store_lanes(result + i, gradient_of(blur, at_x, at_y, w * L(l1_factor)));
      }
      std::copy_n(result, band.count, gradient.row(row) + band.begin);
    });
  }
};

}  // namespace ngs::ssim
