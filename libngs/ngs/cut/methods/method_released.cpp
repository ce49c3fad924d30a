#include "ngs/cut/methods/method_released.h"

#include <algorithm>
#include <cmath>

#include "ngs/cut/methods/cob_trainer.h"
#include "ngs/cut/methods/released_field.h"
#include "ngs/math/sh.h"

namespace ngs {
namespace {

// Published weights of the colour differences to neighbours, the change under jitter, and the mean density.
constexpr double kContinuity = 0.1, kSmooth = 0.05, kDensity = 1e-3;
constexpr double kRate = 1e-3;  // Adam rate of the network and the hash tables

}  // namespace

std::vector<std::size_t> most_undecided(const GaussianCloud& cloud, const std::vector<float>& logit, int count) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < cloud.usable.size(); ++i)
    if (cloud.usable[i]) order.push_back(i);
  const std::size_t objects = cloud.usable.empty() ? 0 : logit.size() / cloud.usable.size();
  const auto least_logit = [&](std::size_t i) {  // the smallest |logit|: 4 m (1 - m) decreases with |logit|
    float least = INFINITY;
    for (std::size_t k = i * objects; k < (i + 1) * objects; ++k) least = std::min(least, std::abs(logit[k]));
    return least;
  };
  const std::size_t taken = std::min(order.size(), std::size_t(count));
  std::partial_sort(order.begin(), order.begin() + std::ptrdiff_t(taken), order.end(),
                    [&](std::size_t a, std::size_t b) {
                      const float la = least_logit(a), lb = least_logit(b);
                      return la != lb ? la < lb : a < b;
                    });
  order.resize(taken);
  std::sort(order.begin(), order.end());
  return order;
}

Solution run_released(const Exec& exec, Monitor& monitor, const ReleasedOptions& options, const Problem& input) {
  CobOptions cob = options.cob;
  cob.divisor = CobDivisor::kAll;
  const ReleasedWeights weights{options.align, kContinuity, kSmooth, kDensity};
  ReleasedField field(input.seed);
  ReleasedLosses last;
  std::uint64_t draw = 0;
  const ColourTerm regulariser = [&](const Exec& e, const GaussianCloud& cloud, const std::vector<float>& logit,
                                     std::vector<float>& grad_sh_dc) {
    const std::vector<std::size_t> rows = most_undecided(cloud, logit, options.count);
    std::vector<float> position;
    std::vector<double> base, grad_base;
    for (const std::size_t i : rows)
      for (std::size_t c = 0; c < 3; ++c) {
        position.push_back(cloud.position[i * 3 + c]);
        base.push_back(std::clamp(colour_of_dc(double(cloud.sh_dc[i * 3 + c])), 0.0, 1.0));
      }
    last = field.evaluate(e, weights, {position, base}, draw++, grad_base);
    for (std::size_t k = 0; k < base.size(); ++k)
      if (base[k] > 0 && base[k] < 1) grad_sh_dc[rows[k / 3] * 3 + k % 3] += float(kShC0 * grad_base[k]);
    field.step(e, kRate);
  };
  Solution result = run_cob_schedule(exec, monitor, cob, input, regulariser);
  result.figures["align"] = last.align, result.figures["continuity"] = last.continuity;
  result.figures["smooth"] = last.smooth, result.figures["density"] = last.density;
  return result;
}

}  // namespace ngs
