#pragma once
// Anderson acceleration of a fixed-point iteration x <- x + f(x).
//
// The next point combines the last few so that the combined step is as short as possible:
//   γ = argmin |f - ΔF γ|_W,   x' = x + f - (ΔX + ΔF) γ
// with the differences of the last points as columns. Sequential sums in double: one result for any thread count.
#include <cstddef>
#include <vector>

namespace ngs {

class Anderson {
 public:
  explicit Anderson(std::size_t depth) : depth_(depth) {}

  /// The point after `x`, whose step is f. `weight` >= 0 per component: how much of the step's length it is.
  std::vector<double> next(const std::vector<double>& x, const std::vector<double>& f,
                           const std::vector<double>& weight);
  /// Forgets the points so far.
  void reset();

 private:
  std::size_t depth_;
  std::vector<double> last_x_, last_f_;
  std::vector<std::vector<double>> dx_, df_;  // oldest first
};

}  // namespace ngs
