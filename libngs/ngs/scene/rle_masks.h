#pragma once
// Run-length encoded masks, to hold many views in memory.
#include "ngs/scene/scene.h"

namespace ngs {

/// The masks of one view, run-length encoded without loss. Memory of a plane is proportional to its contour length.
/// Planes that would not shrink, such as soft masks that vary per pixel, are stored unencoded.
class RleMasks {
 public:
  RleMasks() = default;
  explicit RleMasks(ViewMasks masks);

  ViewMasks unpacked() const;
  /// The same in the memory of `out`.
  void unpack(ViewMasks& out) const;
  bool available() const { return rest_.available; }
  std::size_t bytes() const;

 private:
  struct Run {
    float value;
    std::uint32_t end;  // one past its last pixel in the plane
  };
  struct Plane {
    std::vector<Run> runs;
    std::vector<float> values;  // instead of runs
  };
  static Plane packed(std::vector<float> plane);

  std::vector<Plane> target_;  // [K]
  ViewMasks rest_;             // everything except the targets
};

}  // namespace ngs
