#pragma once
// ngs-joint --method flash: labels by majority of the rendering weights, in closed form.   paper.md §6.1
//
// A1 is a Gaussian's rendering weight inside the object's masks, A0 the weight outside. The label is 1 if the object's
// share exceeds the background's share plus gamma. Shares are normalised by their sum (l1, as in the FlashSplat
// paper) or by their Euclidean length (l2, as in its code). For one object both are thresholds on
// f = A1 / (A0 + A1), see flash_threshold(). With several objects only the heaviest gets the Gaussian. Gaussians
// without evidence stay undecided (views = 0) for any gamma.
#include "ngs/options/field.h"
#include "ngs/problem/problem.h"

namespace ngs {

enum class FlashNorm : std::uint8_t { kL1, kL2 };
inline constexpr NamedValue<FlashNorm> kFlashNormNames[] = {{FlashNorm::kL1, "l1"}, {FlashNorm::kL2, "l2"}};

struct FlashOptions {
  double gamma = 0;
  FlashNorm norm = FlashNorm::kL1;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.gamma,
          Field<double>{"flash_gamma", "", "Bias towards the background; < 0 favours the object", -1.0, 1.0});
    visit(self.norm,
          Choice<FlashNorm>{"flash_norm", "Normalisation of the shares that gamma is added to", kFlashNormNames});
  }
};

/// The share f above which a Gaussian belongs to the object (paper.md §5.4).
double flash_threshold(const FlashOptions& options);

Solution run_flash(const Exec& exec, Monitor& monitor, const FlashOptions& options, const Problem& input);

}  // namespace ngs
