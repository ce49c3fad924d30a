#pragma once
// Assigns one cause to every wrong pixel of a rendered mask.
//
// The first cause that applies, by the Gaussians composited in the pixel (weights w = α T) and the truth:
// clang-format off
//   reach       the splat is transparent: alpha < 0.5
//   unseen      most of w belongs to Gaussians visible in at most two views with masks
//   floater     the object is occluded: alone it covers the pixel, the full model does not show it, and the occluder is
//               nearer by more than a tenth of the object's RMS radius
//   input-mask  the input mask of this view, which no stage has read, has the same error: so had the other input masks
//   straddler   most of w belongs to boundary Gaussians
//   soft-edge   the rendered value is uncertain (0.25 to 0.75)
//   label       Gaussians with confident labels of the wrong side
// clang-format on
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "ngs/ops/image/metrics.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/labels/label_column.h"

namespace ngs {

enum class ErrorCause : std::uint8_t { kNone, kReach, kUnseen, kFloater, kInputMask, kStraddler, kSoftEdge, kLabel };
inline constexpr std::size_t kErrorCauses = 8;
struct ErrorCauseName {
  std::string_view name, help;
  std::array<std::uint8_t, 3> rgb;  // colour in atlas images
};
inline constexpr std::array<ErrorCauseName, kErrorCauses> kErrorCauseNames = {
    {{"none", "correct", {0, 0, 0}},
     {"reach", "not covered by the splat", {160, 160, 160}},
     {"unseen", "Gaussians visible in at most two views", {255, 255, 0}},
     {"floater", "something in front of the object", {255, 0, 255}},
     {"input-mask", "the view's input mask has the same error", {255, 60, 40}},
     {"straddler", "Gaussians across the edge", {60, 220, 60}},
     {"soft-edge", "uncertain value at an edge", {0, 220, 255}},
     {"label", "confident labels of the wrong side", {255, 150, 0}}}};

struct AtlasInput {
  const GaussianCloud& cloud;
  const LabelColumns& labels;
  Camera camera;                      // of the truth's size
  SplatOptions splat;                 // with the low-pass filter for that size
  MaskPlane predicted, truth, input;  // one size; input.data may be null
};

struct ErrorAtlas {
  std::vector<ErrorCause> cause;  // [H·W]
  std::array<std::int64_t, kErrorCauses> pixels{};
  std::int64_t wrong() const;
};

ErrorAtlas error_atlas(const Exec& exec, const AtlasInput& input);

}  // namespace ngs
