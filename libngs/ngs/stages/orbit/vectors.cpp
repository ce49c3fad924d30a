#include "ngs/stages/orbit/vectors.h"

namespace ngs::orbit {

std::vector<Vec> even_directions(int count) {
  constexpr double kGoldenAngle = 2.39996322972865332;  // rad
  std::vector<Vec> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, radius = std::sqrt(1 - z * z), angle = kGoldenAngle * i;
    directions.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
  }
  return directions;
}

}  // namespace ngs::orbit
