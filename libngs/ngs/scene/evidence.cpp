#include "ngs/scene/evidence.h"

#include "ngs/core/check.h"

namespace ngs {
namespace {

/// False if object k has neither weight nor pixels: then all pixels are background and r = 1.
bool has_evidence(const double* sum, std::size_t k) { return sum[2 + 2 * k] != 0 || sum[3 + 2 * k] != 0; }

}  // namespace

void Evidence::add(const Evidence& other) {
  NGS_CHECK(gaussians == other.gaussians && objects == other.objects, "evidence of different models");
  for (std::size_t i = 0; i < std::size_t(gaussians); ++i) {
    weight.add(i, other.weight.at(i));
    pixels[i] += other.pixels[i];
    views[i] += other.views[i];
    other.object_weights.for_each_in(i,
                                     [&](std::size_t k, const ObjectSums& of) { object_weights.touch(i, k).add(of); });
  }
}

void Evidence::add(std::size_t gaussian, const double* sum, DeferredInserts& deferred_inserts) {
  add_background(gaussian, sum[0], sum[1]);
  for (std::size_t k = 0; k < std::size_t(objects); ++k)
    if (has_evidence(sum, k)) {
      const ObjectSums of = ObjectSums::of_view(sum[0], sum[1], sum[2 + 2 * k], sum[3 + 2 * k]);
      object_weights.add(gaussian, k, of, deferred_inserts);
    }
}

void Evidence::add(std::size_t gaussian, const double* sum) {
  DeferredInserts deferred_inserts;
  add(gaussian, sum, deferred_inserts);
  object_weights.add(deferred_inserts);
}

void Evidence::add(const ViewSums& view) {
  NGS_CHECK(view.has_pixels && view.objects == objects, "sums of another form");
  for (std::size_t v = 0; v < view.size(); ++v) add(view.row[v], view.at(v));
}

std::vector<float> Evidence::weights() const {
  std::vector<float> all(weight.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = float(weight.value(i));
  return all;
}

double between_views_variance(const ObjectSums& of, std::uint32_t views) {
  if (views < 2) return 0.0;
  __extension__ using Wide = unsigned __int128;  // V Σm² < 2^32 · 2^32 · 2^64 / V: fits for V < 2^32
  const Wide squares = (Wide(of.signal_square_sum.whole) << 64) | of.signal_square_sum.fraction;
  const Wide sum = of.signal_sum;
  const Wide numerator = squares * views - sum * sum;
  return 4.0 * (double(numerator) * 0x1p-64) / (double(views) * double(views));
}

}  // namespace ngs
