#pragma once
// A Gaussian as the compositing kernels read it, from its 2D covariance.
#include "ngs/ops/splat/splat_gaussian.h"

namespace ngs::test {

/// Mean (x, y) px, blurred covariance [[xx xy] [xy yy]] px².
inline SplatRecord<float> splat_record(double x, double y, double xx, double xy, double yy, float opacity) {
  const double det = xx * yy - xy * xy;
  const ProjectedGaussian<float> p{0,         0,         float(yy / det), float(-xy / det), float(xx / det),
                                   float(xx), float(yy), float(det),      opacity};
  return record_of<float>(p, x, y);
}

}  // namespace ngs::test
