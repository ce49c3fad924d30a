#pragma once
// A sparse (SfM) reconstruction: surface points and their observations.
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
  std::vector<Observation> track;  // empty if the reader does not load it
};

}  // namespace ngs
