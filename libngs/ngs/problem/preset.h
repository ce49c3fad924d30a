#pragma once
// The settings of --quality, one row per quality. In libngs only this table depends on the quality; passes
// define what a half is. `ngs cut` also shortens mask tracking in drafts (tools/ngs/cut_plan.cpp).
#include <cstdint>

#include "ngs/options/field.h"

namespace ngs {

enum class Quality : std::uint8_t { kDraft, kStandard, kHigh, kReference };
inline constexpr NamedValue<Quality> kQualityNames[] = {{Quality::kDraft, "draft"},
                                                        {Quality::kStandard, "standard"},
                                                        {Quality::kHigh, "high"},
                                                        {Quality::kReference, "reference"}};

struct Preset {
  bool joint;         // take joint steps, unless --steps or --effect ask for them
  int epochs;         // joint steps per training view
  bool half_samples;  // halve the NeRF's rows, columns and depths: in one epoch more samples gain little (decision 013)
  bool half_contours;   // contour iterations at half the size, unless the object has narrow parts
  int contour_epochs;   // of the last contour iteration, with 21 views
  int averaged_epochs;  // contour iterations end at the mean of these last epochs: less noise of single views
  int more_iterations;  // contour iterations in addition to the two or three that depend on the masks
  bool half_floaters;   // search floaters in fewer views, at half the size
  bool bleed_through;   // look for Gaussians that are only visible through the object
};

constexpr Preset preset_of(Quality quality) {
  // clang-format off
  // A draft's few epochs still move too far to be averaged.
  //                                 joint, epochs, samples, contours: half, epochs, averaged, more; floaters, bleed
  switch (quality) {
    case Quality::kDraft:     return {     false,     1,    true,   true,       4,        0,   -1,     true,    false};
    case Quality::kStandard:  return {      true,    10,   false,  false,      10,        3,    0,    false,     true};
    case Quality::kHigh:      return {      true,    40,   false,  false,      15,        3,    2,    false,     true};
    case Quality::kReference: return {      true,   160,   false,  false,      15,        3,    5,    false,     true};
  }
  // clang-format on
  return {};
}

}  // namespace ngs
