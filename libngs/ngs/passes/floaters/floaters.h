#pragma once
// Floaters before the object: Gaussians of no surface that cover it in some views.           PAPER.md §5.8
//
// A splat explains a photo as well by paint on a haze near the camera as by the object itself. The masks of
// the views that see the haze from elsewhere call it background, rightly, and where it covers the object the
// rendered mask has a hole. Nothing here reads a mask of a held-out view; photos of all views are read, as
// when the model was trained.
//
// The object's surface is what its core (problem/object_core.h) renders. A Gaussian far from the core and
// nearer to the camera than that surface is a candidate. At a pixel the photo decides between the two: it shows the
// surface where it is closer to the core's colour than to the one that the Gaussians in front have in the other views'
// photos, by more than the noise. A training view's own mask vetoes where it says that something else is seen. A
// candidate is a floater if the photos see through it in at least `sees_past` of its weight before the
// surface.
#include "ngs/options/field.h"
#include "ngs/problem/object_core.h"
#include "ngs/problem/problem.h"
#include "ngs/stages/fit/photo_refit.h"

namespace ngs {

struct FloaterOptions {
  CoreOptions core = {};       // whose margin is also the one from the surface
  double surface_alpha = 0.9;  // opacity of the core from which a pixel has a surface
  double sees_past = 0.5;   // of a candidate's weight before the surface
  double least_reach = 0.1;    // share of a candidate's weight before the surface, in its best view
  double noise_factor = 2;     // times the median difference of core and photo: what colours must differ by
  double least_hidden = 1e-3;  // of the surface's pixels that floaters hide, over all views; less is not worth a refit
  std::size_t most_views = std::size_t(-1);  // with photos that the search looks at, evenly spread
  int rounds = 4;                            // what stands behind a floater shows in the next round
};

struct FloaterFinding {
  std::vector<std::uint8_t> floater;  // [N]
  std::vector<std::uint8_t> far;      // [N] neither of the core nor near it; empty: no core
  std::int64_t count = 0;
  std::map<std::string, double> figures;  // core, candidates, margin (world), noise, rounds
};

/// Mean opacity of what stands before the object's surface, over its pixels in the views with photos: 0 where
/// no search can find anything.
double front_opacity(const Exec& exec, const FloaterOptions& options, const Problem& input);

/// Empty finding where the input has no core, no photos, or nothing is found. Needs input.labels.
FloaterFinding find_floaters(const Exec& exec, Monitor& monitor, const FloaterOptions& options, const Problem& input);

/// Logit of the opacity of a Gaussian that was taken out: below what any view draws.
inline constexpr float kRemovedLogit = -20.f;

struct FloaterRemoval {
  GaussianCloud cloud;  // floaters at kRemovedLogit, what they covered refitted to the photos: colours of all of it,
                        // geometry of what is far from the core
  std::map<std::string, double> figures;  // PSNR before, without, after the refit, at the size of the input, of
                                          // at most 8 views
};

FloaterRemoval remove_floaters(const Exec& exec, Monitor& monitor, const RefitOptions& refit, const Problem& input,
                               const FloaterFinding& finding);

/// Labels of `cloud`, from which the floaters were removed: evidence gathered anew; floaters have label and
/// prob 0 and are no boundary.
std::vector<LabelColumns> labels_without_floaters(const Exec& exec, Monitor& monitor, const Problem& input,
                                                  const GaussianCloud& cloud, const std::vector<std::uint8_t>& floater);

}  // namespace ngs
