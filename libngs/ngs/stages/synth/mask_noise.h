#pragma once
// Mistakes that mask makers make, in known amounts, for scenes whose exact masks are known.
//
// All draws depend on (seed, view, object) alone, so a view's mask does not depend on the others. They act in the
// order of the fields below. Ids in label maps: 0 = nothing.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/scene/views.h"

namespace ngs::synth {

struct MaskNoise {
  double swap = 0;       // probability, per view and object: ids exchanged with another object in view
  double drop = 0;       // probability, per view and object: absent from the mask
  double snap_px = 0;    // contours snap to wrong edges of the photo at most this far away (contour_snap.h)
  double jitter_px = 0;  // standard deviation of a smooth random displacement of the contour
  double dilate_px = 0;  // radius; an object grows over what is unlabelled
  double erode_px = 0;   // radius; an object shrinks from every other id
  double blob = 0;       // probability, per view and object: an ellipse on its contour added or cut off
  bool any() const {
    return swap > 0 || drop > 0 || snap_px > 0 || jitter_px > 0 || dilate_px > 0 || erode_px > 0 || blob > 0;
  }
};

enum class NoiseOf : std::uint8_t { kLabelMaps, kOneObject };
/// From "erode:1.5", "drop:0.1", …; several in one string are separated by commas. Error kUsage otherwise, and for swap
/// where there is one object only.
MaskNoise parse_mask_noise(std::span<const std::string> specs, NoiseOf of = NoiseOf::kLabelMaps);

/// Which mask is drawn. With `only_id` > 0 it is binary: 1 where the disturbed mask of that object is, and growing or
/// blobs then also run over other objects, as separately made masks do.
struct MaskDraw {
  std::uint32_t only_id;
  int view;
  std::uint64_t seed;
  const ImageF* photo = nullptr;  // of the labels' size; needed for snap_px
};

/// Erroneous copy of an exact label map.
ImageU16 disturb_labels(const Exec& exec, const ImageU16& labels, const MaskNoise& noise, const MaskDraw& draw);

/// What a share of the views gets instead of its own mask: [views] the index of the view whose mask it gets, its own
/// or, where `wrong`, another's; -1 where it gets none. Exactly round(share · views) of each kind, chosen by seed.
std::vector<int> view_fates(int views, double missing, double wrong, std::uint64_t seed);

}  // namespace ngs::synth
