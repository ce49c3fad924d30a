#pragma once
// Exposure and white balance that differ from photo to photo.                                   PAPER.md §5.14
//
// A model has one colour for a thing; a camera that measures the light anew gives it another one in every photo. The
// model was trained on all of them and stands between; trained on, it is pulled to and fro, and what compares the
// colours of views takes the exposure for a sign. Per view and channel the gain is the median over pixels of photo /
// render, relative to the median over views, which is the model's own. Not the ratio of means, which a shadow or
// whatever the model lacks changes: half of the pixels must lie.
#include <array>

#include "ngs/problem/problem.h"

namespace ngs {

using ExposureGain = std::array<float, 3>;  // photo = gain * what the model's exposure would show, R, G, B

struct ViewExposure {
  std::size_t view = 0;  // of the scene
  ExposureGain gain{1, 1, 1};
};

/// The views of the list that have a photo; a gain is 1 where fewer than 256 pixels are neither dark nor clipped.
std::vector<ViewExposure> view_exposures(const Exec& exec, const Problem& input, const std::vector<std::size_t>& views);

/// How far the worst gain is from 1, in percent (of the larger of gain and 1 / gain).
double exposure_spread_percent(const std::vector<ViewExposure>& exposures);

/// The photo of `view` as the model's exposure would have it; unchanged where `exposures` lacks the view.
ImageF levelled_photo(const std::vector<ViewExposure>& exposures, std::size_t view, ImageF photo);

}  // namespace ngs
