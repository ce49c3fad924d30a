#pragma once
// Anderson acceleration of a fixed-point iteration x <- x + f(x).
//
// The next point is the combination of the last few points with the shortest combined step:
//   γ = argmin |f - ΔF γ|_W,   x' = x + f - (ΔX + ΔF) γ
// with the differences of the last points as columns of ΔX and ΔF. Sequential sums in double: one result for
// any thread count.
#include <cstddef>
#include <vector>

namespace ngs {

class Anderson {
 public:
  explicit Anderson(std::size_t depth) : depth_(depth) {}

  /// Returns the point after `x`, whose plain step is f. `weight` >= 0: the weight of each component in the norm W.
  std::vector<double> next(const std::vector<double>& x, const std::vector<double>& f,
                           const std::vector<double>& weight);
  /// Clears the history of points.
  void reset();

 private:
  std::size_t depth_;
  std::vector<double> last_x_, last_f_;
  std::vector<std::vector<double>> dx_, df_;  // oldest first
};

}  // namespace ngs
