#pragma once
// Masks of many views in memory at once.
#include "ngs/scene/scene.h"

namespace ngs {

/// The masks of one view, run by run. Planes that are 0 or 1 but at contours, as walked masks are, take as much memory as
/// their contours are long; the same bits come back.
class PackedMasks {
 public:
  PackedMasks() = default;
  explicit PackedMasks(ViewMasks masks);

  ViewMasks unpacked() const;
  bool available() const { return rest_.available; }

 private:
  struct Run {
    float value;
    std::size_t end;  // of its pixels, in the plane
  };
  std::vector<std::vector<Run>> target_;  // [K]
  ViewMasks rest_;                        // all but the targets
};

}  // namespace ngs
