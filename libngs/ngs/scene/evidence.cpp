#include "ngs/scene/evidence.h"

#include <cmath>

#include "ngs/core/check.h"

namespace ngs {
namespace {

std::uint64_t quantised(double unit) { return std::uint64_t(std::llround(unit * 0x1p32)); }

}  // namespace

Evidence::Evidence(std::int64_t n, int k) : gaussians(n), objects(k) {
  const auto rows = std::size_t(n), cells = rows * std::size_t(k);
  weight.resize(rows), object_weight.resize(cells), pixels.resize(rows), object_pixels.resize(cells);
  views.resize(rows), signal_sum.resize(cells), signal_square_sum.resize(cells), contrast_sum.resize(cells);
}

void Evidence::add(const Evidence& other) {
  NGS_CHECK(gaussians == other.gaussians && objects == other.objects, "evidence of different models");
  for (std::size_t i = 0; i < std::size_t(gaussians); ++i) {
    weight.add(i, other.weight);
    pixels[i] += other.pixels[i];
    views[i] += other.views[i];
  }
  for (std::size_t i = 0; i < signal_sum.size(); ++i) {
    object_weight.add(i, other.object_weight);
    signal_square_sum.add(i, other.signal_square_sum);
    object_pixels[i] += other.object_pixels[i];
    signal_sum[i] += other.signal_sum[i];
    contrast_sum[i] += other.contrast_sum[i];
  }
}

void Evidence::add(std::size_t gaussian, const double* sum) {
  const double w = sum[0], count = sum[1];
  weight.add(gaussian, w);
  pixels[gaussian] += std::uint64_t(count);
  views[gaussian] += 1;
  for (std::size_t k = 0; k < std::size_t(objects); ++k) {
    const std::size_t cell = gaussian * std::size_t(objects) + k;
    const double object_w = sum[2 + 2 * k], object_count = sum[3 + 2 * k];
    if (object_w == 0 && object_count == 0) {  // all the pixels say that it is none of its
      contrast_sum[cell] += quantised(1);
      continue;
    }
    object_weight.add(cell, object_w);
    object_pixels[cell] += std::uint64_t(object_count);
    add_signal(cell, object_w / w);
    contrast_sum[cell] += quantised(std::abs(2 * object_count - count) / count);
  }
}

void Evidence::add_signal(std::size_t cell, double m) {
  const std::uint64_t units = quantised(m);
  __extension__ using Wide = unsigned __int128;
  const Wide square = Wide(units) * units;
  signal_sum[cell] += units;
  signal_square_sum.add_fixed(cell, std::uint64_t(square >> 64), std::uint64_t(square));
}

double between_views_variance(const Evidence& evidence, std::size_t row, std::uint32_t views) {
  if (views < 2) return 0.0;
  __extension__ using Wide = unsigned __int128;  // V Σm² < 2^32 · 2^32 · 2^64 / V: fits for V < 2^32
  const Wide squares = (Wide(evidence.signal_square_sum.whole[row]) << 64) | evidence.signal_square_sum.fraction[row];
  const Wide sum = evidence.signal_sum[row];
  const Wide numerator = squares * views - sum * sum;
  return 4.0 * (double(numerator) * 0x1p-64) / (double(views) * double(views));
}

}  // namespace ngs
