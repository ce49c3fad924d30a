#pragma once
// Floaters in front of the object: Gaussians on no surface that cover the object in some views.     paper.md §5.8
//
// Training can fit a photo with floaters near the camera instead of the object itself. Other views' masks correctly
// label these floaters background, so the rendered mask has a hole where they cover the object. The search reads photos
// of all views, as training did. It reads no mask of a held-out view.
//
// The object's surface is the rendering of its core (problem/object_core.h). Gaussians far from the core and nearer to
// the camera than the surface are candidates. Each pixel of a photo is compared with two colours: the core's, and the
// mean colour of the Gaussians in front in the photos of all other views. The pixel sees past the floater if the core's
// colour is closer by more than the noise. Pixels that a training view's mask labels background never count. A
// candidate is a floater if the photos see past at least `sees_past` of its weight in front of the surface.
#include "ngs/make/fit/photo_refit.h"
#include "ngs/options/field.h"
#include "ngs/problem/object_core.h"
#include "ngs/problem/problem.h"

namespace ngs {

struct FloaterOptions {
  CoreOptions core = {};       // its margin is also the minimum distance from the surface
  double surface_alpha = 0.9;  // minimum opacity of the core at a pixel with a surface
  double sees_past = 0.5;      // minimum share of a candidate's weight in front of the surface that photos see past
  double min_reach = 0.1;      // minimum share of a candidate's weight in front of the surface, in its best view
  double noise_factor = 2;     // minimum colour difference, in medians of the difference of core and photo
  double min_hidden = 1e-3;    // minimum share of the surface's pixels hidden by floaters, over all views
  std::size_t max_views = std::size_t(-1);  // maximum number of views with photos to search, evenly spread
  int rounds = 4;                           // maximum number of searches; each uncovers Gaussians for the next
};

struct FloaterFinding {
  std::vector<std::uint8_t> floater;  // [N]
  std::vector<std::uint8_t> far;      // [N] 1: neither in the core nor near it; empty: no core
  std::int64_t count = 0;
  std::map<std::string, double> figures;  // core, candidates, margin (world), noise, rounds
};

/// Mean opacity of the Gaussians in front of the object's surface, over the surface's pixels in the views with photos.
/// At 0 a search finds nothing.
double front_opacity(const Exec& exec, const FloaterOptions& options, const Problem& input);

/// Needs input.labels. `count` is 0 without a core, without photos, and without floaters.
FloaterFinding find_floaters(const Exec& exec, Monitor& monitor, const FloaterOptions& options, const Problem& input);

/// Logit of the opacity of a removed Gaussian: too small to be rendered.
inline constexpr float kRemovedLogit = -20.f;

struct FloaterRemoval {
  // Floaters have kRemovedLogit. The uncovered Gaussians are refitted to the photos: colours of all of them, geometry
  // of those far from the core.
  GaussianCloud cloud;
  // PSNR with the floaters, without them, and after the refit, at the input's size, over at most 8 views.
  std::map<std::string, double> figures;
};

FloaterRemoval remove_floaters(const Exec& exec, Monitor& monitor, const RefitOptions& refit, const Problem& input,
                               const FloaterFinding& finding);

/// Recomputes the labels from the evidence of `cloud`, which has the floaters removed. Floaters get label, prob,
/// variance and boundary 0.
std::vector<LabelColumns> labels_without_floaters(const Exec& exec, Monitor& monitor, const Problem& input,
                                                  const GaussianCloud& cloud, const std::vector<std::uint8_t>& floater);

}  // namespace ngs
