#include "ngs/ops/losses/loss_smooth.h"

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/core/rng.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/losses/loss_smooth_kernels.h"

namespace ngs {

SmoothnessPairs smoothness_pairs(const Exec& exec, Rows<const float, 3> points, double step_length,
                                 const SmoothnessDraw& draw) {
  SmoothnessPairs pairs{{}, {}, step_length};
  pairs.from.resize(std::size_t(points.n) * 3);
  pairs.to.resize(pairs.from.size());
  for_each_index(exec, points.n, [&](std::int64_t i) {
    double n[3];
    rng_unit_vector(draw.seed, RngStream::kSmoothJitter, draw.first_index + std::uint64_t(i), n);
    for (std::int64_t a = 0; a < 3; ++a) {
      const double x = double(points.row(i)[a]);
      pairs.from[std::size_t(i * 3 + a)] = float(x);
      pairs.to[std::size_t(i * 3 + a)] = float(x + step_length * n[a]);
    }
  });
  return pairs;
}

double loss_smooth_backward(const Exec& exec, const SmoothnessScale& scale, const SmoothnessInputs& in, double weight,
                            SmoothnessGradients& out) {
  const auto& [colour, moved_colour] = in;
  NGS_CHECK(colour.size() == moved_colour.size(), "one moved colour per colour");
  const std::int64_t n = std::int64_t(colour.size() / 3);
  out.colour.resize(colour.size());
  out.moved_colour.resize(colour.size());
  if (n == 0) return 0;
  NGS_CHECK(scale.pair_length > 0 && scale.unit_length > 0, "lengths must be positive");
  const double ratio = scale.unit_length / scale.pair_length;
  const double factor = 3 * ratio * ratio / double(n);
  std::vector<float> term(exec.device_ops ? 0 : colour.size() / 3);
  const SmoothnessForwardBackward<float> kernel{{colour.data(), n},     {moved_colour.data(), n},
                                                float(weight * factor), term.data(),
                                                {out.colour.data(), n}, {out.moved_colour.data(), n}};
  if (exec.device_ops) return factor * exec.device_ops->loss.smoothness(kernel);
  for_each_index(exec, n, kernel);
  double sum = 0;
  for (const float t : term) sum += double(t);
  return factor * sum;
}

}  // namespace ngs
