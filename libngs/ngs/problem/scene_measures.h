#pragma once
// Numbers that the passes' heuristics compare with thresholds. All are pure functions of loaded data. Each is tested
// against the naive measure that it replaces (tests/unit/problem/scene_measures_test.cpp).
//
// A level is 1/255: a colour difference below half a level is invisible in an 8-bit photo.
#include <cstdint>
#include <span>
#include <vector>

#include "ngs/ops/image/metrics.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/knn_graph.h"
#include "ngs/scene/views.h"

namespace ngs {

/// Largest opacity-weighted change of colour by the SH bands above degree 0 of Gaussians in view, levels. The largest
/// coefficient would be wrong: it may belong to a Gaussian that is transparent or in no view. `world_unit`:
/// math/world_unit.h.
double view_dependence_levels(const GaussianCloud& cloud, std::span<const Camera> cameras, double world_unit = 1);

/// Largest opacity that the antialiasing compensation removes from a Gaussian, levels; 0 if `splat` has it off. The
/// flag alone would be wrong: large footprints lose nothing.
double antialias_levels(const GaussianCloud& cloud, std::span<const Camera> cameras, const SplatOptions& splat);

/// Upper bound on the weight of one Gaussian on the wrong side of contours, summed over the views, px. The share would
/// be wrong: half of a tiny Gaussian does not matter.
double straddling_bound_px(const GaussianCloud& cloud, std::span<const Camera> cameras, const SplatOptions& splat);

/// RMS difference between the colours [B, 3] of neighbours, levels. The spread of all colours would be wrong: it is
/// large for a boundary of two plain parts too.
double neighbour_rms_levels(const KnnGraph& graph, Rows<const float, 3> colour);

/// Largest such difference, levels. The mean would be wrong: it hides a single seam in a plain boundary.
double neighbour_max_levels(const KnnGraph& graph, Rows<const float, 3> colour);

/// Largest range of a channel over the colours [B, 3], levels. The difference of neighbours would be wrong: it is
/// nearly 0 on a ramp.
double colour_range_levels(Rows<const float, 3> colour);

/// RMS standard deviation of the 7x7 patches on the mask's contour, levels; 0 without a contour. The whole photo would
/// be wrong: it may have texture elsewhere.
double contour_deviation_levels(const ImageF& photo, MaskPlane mask);

/// Side of the finest cell of an encoding with `finest` cells along `extent`, in median nearest-neighbour distances.
/// The mean spacing in the box would be wrong: points lie on a curve or in clusters.
double cells_per_spacing(const std::vector<float>& nearest_distance, double extent, int finest);

/// Mean of the gains, in units of its standard error; 0 for fewer than two. The mean alone would be wrong: a single
/// view can dominate it.
double gain_in_standard_errors(const std::vector<double>& gains);
/// The same as a score of the normal distribution, because the standard error of few views is uncertain. With three
/// views the score stays below 1.75. It is 2 for a gain_in_standard_errors() of 2.38 with 12 views, 2.12 with 32,
/// and 2.04 with 100. Transform of Student's t: Abramowitz and Stegun, 26.7.8. 0 for fewer than two views.
double normal_score(double gain_in_standard_errors, std::size_t views);
/// Minimum score of a significant gain.
inline constexpr double kSignificant = 2;

/// Number of pixels of a mask, and of those that no square of kNarrow_px inside the mask covers. The mask may continue
/// outside the image. Contour length by area would be wrong: it is as large for a small object as for a thin one.
struct NarrowParts {
  double narrow_px2 = 0, all_px2 = 0;
};
inline constexpr int kNarrow_px = 9;
NarrowParts narrow_parts(MaskPlane mask);

/// Share of the rendered object weight outside the window. The share of pixels would be wrong: most of them are empty.
double weight_outside(const ImageF& label, int x0, int y0, int x1, int y1);

}  // namespace ngs
