#pragma once
// Why a rendered mask is wrong where it is: one cause per wrong pixel.
//
// The first cause that applies, from what composites the pixel (weights w = α T) and from the truth:
//   reach       the splat is transparent: alpha < 0.5
//   unseen      most of w belongs to Gaussians that at most two views with masks saw
//   floater     the object lies behind: alone it covers the pixel, the whole model does not show it, and what hides it
//               is nearer by more than a tenth of the object's RMS radius
//   input-mask  the input mask of this view, which no stage has seen, errs in the same way: so did its siblings
//   straddler   most of w belongs to boundary Gaussians
//   soft-edge   the rendered value is undecided (0.25 to 0.75)
//   label       Gaussians with certain labels of the wrong side
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "ngs/ops/image/metrics.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/labels/label_columns.h"

namespace ngs {

enum class ErrorCause : std::uint8_t { kNone, kReach, kUnseen, kFloater, kInputMask, kStraddler, kSoftEdge, kLabel };
inline constexpr std::size_t kErrorCauses = 8;
struct ErrorCauseName {
  std::string_view name, help;
  std::array<std::uint8_t, 3> rgb;  // in pictures
};
inline constexpr std::array<ErrorCauseName, kErrorCauses> kErrorCauseNames = {
    {{"none", "right", {0, 0, 0}},
     {"reach", "outside the splat's reach", {160, 160, 160}},
     {"unseen", "never or barely seen Gaussians", {255, 255, 0}},
     {"floater", "something before the object", {255, 0, 255}},
     {"input-mask", "the input mask of the view errs alike", {255, 60, 40}},
     {"straddler", "Gaussians across the edge", {60, 220, 60}},
     {"soft-edge", "undecided value at an edge", {0, 220, 255}},
     {"label", "certain labels of the wrong side", {255, 150, 0}}}};

struct AtlasInput {
  const GaussianCloud& cloud;
  const LabelColumns& labels;
  Camera camera;                      // of the truth's size
  SplatOptions splat;                 // its filter for that size
  MaskPlane predicted, truth, input;  // one size; input.data may be null
};

struct ErrorAtlas {
  std::vector<ErrorCause> cause;  // [H·W]
  std::array<std::int64_t, kErrorCauses> pixels{};
  std::int64_t wrong() const;
};

ErrorAtlas error_atlas(const Exec& exec, const AtlasInput& input);

}  // namespace ngs
