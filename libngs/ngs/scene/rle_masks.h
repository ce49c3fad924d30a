#pragma once
// Masks of many views in memory at once.
#include "ngs/scene/scene.h"

namespace ngs {

/// The masks of one view, run by run. Planes that are 0 or 1 but at contours take as much memory as their contours are
/// long; those that runs would not make smaller, as soft masks that vary from pixel to pixel, stay as they are. The
/// same bits come back.
class RleMasks {
 public:
  RleMasks() = default;
  explicit RleMasks(ViewMasks masks);

  ViewMasks unpacked() const;
  bool available() const { return rest_.available; }
  std::size_t bytes() const;

 private:
  struct Run {
    float value;
    std::uint32_t end;  // of its pixels, in the plane
  };
  struct Plane {
    std::vector<Run> runs;
    std::vector<float> values;  // instead of runs
  };
  static Plane packed(std::vector<float> plane);

  std::vector<Plane> target_;  // [K]
  ViewMasks rest_;             // all but the targets
};

}  // namespace ngs
