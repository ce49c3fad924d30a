#pragma once
// Estimates exposure and white balance that differ between photos.                              paper.md §5.14
//
// With automatic exposure the same surface has a different colour in every photo, but the model has one colour. The
// model was trained on all photos and has their average exposure. Further training on such photos oscillates, and tests
// that compare colours between views misread the exposure. Per view and channel, the gain is the median over the pixels
// of photo / rendering, divided by the median of that over the views, which is the model's exposure. The median is
// robust: half of the pixels must be wrong to change it. A ratio of means would change with a shadow.
#include <array>

#include "ngs/problem/problem.h"

namespace ngs {

using ExposureGain = std::array<float, 3>;  // photo / photo at the model's exposure, R, G, B

struct ViewExposure {
  std::size_t view = 0;  // of the scene
  ExposureGain gain{1, 1, 1};
};

/// One entry per view of the list that has a photo. A gain is 1 if fewer than 256 pixels are neither dark nor clipped.
std::vector<ViewExposure> view_exposures(const Exec& exec, const Problem& input, const std::vector<std::size_t>& views);

/// Largest deviation from 1 of the gains and their inverses, percent.
double exposure_spread_percent(const std::vector<ViewExposure>& exposures);

/// The photo of `view` divided by its gains; unchanged if `exposures` lacks the view.
ImageF equalised_photo(const std::vector<ViewExposure>& exposures, std::size_t view, ImageF photo);

}  // namespace ngs
