#include "ngs/stages/contours/contour_options.h"

#include <algorithm>
#include <cmath>

namespace ngs {

int contour_epochs(const ContourOptions& contour, Quality quality, std::size_t views) {
  constexpr int kEpochs = 15;
  if (contour.epochs > 0 || !preset_of(quality).contours) return contour.epochs;
  const double share = std::min(1.0, std::sqrt(double(kViewsOfAllEpochs) / double(std::max<std::size_t>(views, 1))));
  return int(std::ceil(kEpochs * share));
}

int contour_iterations(const ContourOptions& contour, Quality quality, bool misaligned) {
  return contour.iterations > 0 ? contour.iterations : (misaligned ? 3 : 2) + preset_of(quality).more_iterations;
}

int early_epochs(int epochs) {
  constexpr double kShare = 0.5;
  return int(std::ceil(kShare * epochs));
}

}  // namespace ngs
