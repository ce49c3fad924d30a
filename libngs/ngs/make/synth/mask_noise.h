#pragma once
// Typical mask errors in known amounts, for scenes with exact masks.
//
// All random draws depend on (seed, view, object) only, so a view's mask does not depend on the other views. Errors are
// applied in the order of the fields below. Ids in label maps: 0 = nothing.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/scene/views.h"

namespace ngs::synth {

struct MaskNoise {
  double merge = 0;  // probability, per view and object: one mask with a neighbour; of masks_of_everything() only
  double split = 0;  // probability, per view and mask: two parts, cut by a line; of masks_of_everything() only
  double background =
      0;  // probability, per view and surface of room and furniture: has a mask; of masks_of_everything() only
  double swap = 0;       // probability, per view and object: its id is exchanged with another object in the view
  double drop = 0;       // probability, per view and object: missing in the mask
  double snap_px = 0;    // contours snap to wrong edges of the photo at most this far away (contour_snap.h)
  double jitter_px = 0;  // standard deviation of a smooth random displacement of the contour
  double dilate_px = 0;  // radius; an object grows over unlabelled pixels
  double erode_px = 0;   // radius; an object shrinks away from every other id
  double blob = 0;       // probability, per view and object: an ellipse on its contour is added or removed
  bool any() const {
    return swap > 0 || drop > 0 || snap_px > 0 || jitter_px > 0 || dilate_px > 0 || erode_px > 0 || blob > 0;
  }
};

enum class NoiseOf : std::uint8_t { kLabelMaps, kOneObject, kEverything };
/// Parses "erode:1.5", "drop:0.1", …; several in one string are separated by commas. Throws kUsage otherwise, for
/// swap with kOneObject, and for merge, split and background without kEverything.
MaskNoise parse_mask_noise(std::span<const std::string> specs, NoiseOf of = NoiseOf::kLabelMaps);

/// Selects the mask to make. With `only_id` > 0 it is binary: 1 for that object's disturbed mask. Dilation and blobs
/// then also cover other objects, as in separately made masks.
struct MaskDraw {
  std::uint32_t only_id;
  int view;
  std::uint64_t seed;
  const ImageF* photo = nullptr;       // of the labels' size; required for snap_px
  const ImageU16* surfaces = nullptr;  // SynthView::surface; required for background
};

/// Copy of an exact label map with the errors of `noise`.
ImageU16 disturb_labels(const Exec& exec, const ImageU16& labels, const MaskNoise& noise, const MaskDraw& draw);

/// Masks of all objects of a view as a network without prompts makes them: with the errors of `noise`, and with ids 1,
/// 2, … without gaps in a random order that differs between views. `draw.only_id` must be 0.
ImageU16 masks_of_everything(const Exec& exec, const ImageU16& labels, const MaskNoise& noise, const MaskDraw& draw);

/// Which mask each view gets, [views]: the index of the view whose mask it gets, or -1 for none. round(missing · views)
/// views get none and round(wrong · views) views get that of another view, chosen by seed; all others get their own.
std::vector<int> mask_assignment(int views, double missing, double wrong, std::uint64_t seed);

}  // namespace ngs::synth
