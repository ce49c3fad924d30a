#pragma once
// What --quality changes: one row per quality, and nothing else asks for a quality.
#include <cstdint>

#include "ngs/options/field.h"

namespace ngs {

enum class Quality : std::uint8_t { kDraft, kStandard, kHigh, kReference };
inline constexpr NamedValue<Quality> kQualityNames[] = {{Quality::kDraft, "draft"},
                                                        {Quality::kStandard, "standard"},
                                                        {Quality::kHigh, "high"},
                                                        {Quality::kReference, "reference"}};

struct Preset {
  int epochs;           // joint steps per training view
  bool half_samples;    // half of the NeRF's rows, columns and depths: one epoch learns little from more (decision 013)
  bool contours;        // contours are refined, unless --contour-epochs asks for it
  int more_iterations;  // of contour refinement, beyond the two or three that the masks call for
  bool half_floaters;   // floaters are searched in fewer views, at half the size
};

constexpr Preset preset_of(Quality quality) {
  // clang-format off
  //                                       epochs  samples  contours  more  floaters
  switch (quality) {
    case Quality::kDraft:     return {          1,    true,    false,    0,     true};
    case Quality::kStandard:  return {         10,   false,     true,    0,    false};
    case Quality::kHigh:      return {         40,   false,     true,    2,    false};
    case Quality::kReference: return {        160,   false,     true,    5,    false};
  }
  // clang-format on
  return {};
}

}  // namespace ngs
