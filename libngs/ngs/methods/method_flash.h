#pragma once
// ngs-joint --method flash: labels by majority of the rendering weights, in closed form.   PAPER.md §6.1
//
// With A1 the weight inside the object and A0 outside, label 1 where the object's share beats the
// background's share plus gamma; shares are normalised by their sum (l1, as the FlashSplat paper prints it)
// or by their Euclidean length (l2, as its code does). For one object these are thresholds on f = A1 / (A0 +
// A1), see flash_threshold(). Of several
// objects the heaviest keeps a Gaussian. Gaussians without evidence stay in the third state for any gamma.
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
          Field<double>{"flash_gamma", "", "bias towards the background; < 0 favours the object", -1.0, 1.0});
    visit(self.norm,
          Choice<FlashNorm>{"flash_norm", "normalisation of the shares that gamma is added to", kFlashNormNames});
  }
};

/// The share f above which a Gaussian belongs to the object (PAPER.md §5.4).
double flash_threshold(const FlashOptions& options);

Solution run_flash(const Exec& exec, Monitor& monitor, const FlashOptions& options, const Problem& input);

}  // namespace ngs
