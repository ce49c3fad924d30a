#pragma once
// A smooth height over a plane through scattered points: a thin-plate spline, the radial basis function that bends
// least. Unlike the normalised weights of Eqs. (8)-(9) it continues the slope of its points into a hole.
#include <vector>

#include "ngs/math/vec.h"

namespace ngs {

/// h(u, v) = c + cu u + cv v + sum_j w_j r_j² ln r_j, with r_j the distance to centre j in units of `scale`. Without a
/// centre, 0 everywhere.
class ThinPlate {
 public:
  ThinPlate() = default;
  /// `smoothing` >= 0: 0 passes through every point. Fewer than three points, or points on one line, give an empty
  /// spline. At most a few hundred points: the time is cubic.
  ThinPlate(const std::vector<Vec2<double>>& points, const std::vector<double>& heights, double smoothing);

  double at(double u, double v) const;
  bool empty() const { return centre_.empty(); }

 private:
  std::vector<Vec2<double>> centre_;
  std::vector<double> weight_;  // [centres + 3], the last: c, cu, cv
  Vec2<double> middle_{0, 0};
  double scale_ = 1;
};

}  // namespace ngs
