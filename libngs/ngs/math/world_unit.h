#pragma once
// The world length that the absolute lengths of renderers and methods count as 1: the near planes (0.2 and 0.01), the
// least depth of a sample, the least depth window. It is 1 in ordinary worlds. In a world so small that these lengths
// would remove the model (a coin in metres, lengths x 0.001), it is smaller, and all of them shrink with it.
#include <cmath>

namespace ngs {

/// The largest power of two that is at most `ratio` and at most 1; 1 if `ratio` is not above 0. Powers of two keep the
/// digits of the lengths that they multiply.
inline double world_unit_from(double ratio) {
  if (!(ratio > 0 && ratio < 1)) return 1;
  int exponent = 0;
  std::frexp(ratio, &exponent);  // ratio = m 2^exponent, 0.5 <= m < 1
  return std::ldexp(1.0, exponent - 1);
}

/// 1 if the nearest surface of interest is behind the near plane; else the unit with which the near plane is at most a
/// tenth of that distance away. `near`: the near plane in ordinary worlds.
inline double world_unit_for(double nearest, double near) {
  return nearest >= near ? 1 : world_unit_from(0.1 * nearest / near);
}

}  // namespace ngs
