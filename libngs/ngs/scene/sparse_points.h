#pragma once
// A sparse reconstruction: points on surfaces, and where the views saw them.
#include <cstdint>
#include <vector>

#include "ngs/math/vec.h"

namespace ngs {

struct SparsePoint {
  Vec3<double> position{};  // world
  std::uint8_t rgb[3] = {128, 128, 128};
  struct Observation {
    int view;     // index
    double x, y;  // px
  };
  std::vector<Observation> track;  // empty where a reader does not keep it
};

}  // namespace ngs
