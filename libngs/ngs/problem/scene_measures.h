#pragma once
// Numbers of a scene that the passes' heuristics compare with a threshold. Pure functions of loaded data, each small
// enough to be tested against the naive measure that it replaces (tests/unit/problem/scene_measures_test.cpp).
//
// A level is 1/255: a difference of colour below half a level leaves no trace in a photo of 8 bits.
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

/// Largest opacity-weighted change of colour that the SH bands beyond the constant one cause in front of a
/// camera, levels. Not the largest coefficient: bands of what is transparent, or lies in no picture, show
/// nowhere. `world_unit`: math/world_unit.h.
double view_dependence_levels(const GaussianCloud& cloud, std::span<const Camera> cameras, double world_unit = 1);

/// Largest opacity that the antialiasing compensation takes from a Gaussian, levels; 0 where `splat` does not
/// ask for it. Not the flag alone: large footprints lose nothing.
double antialias_levels(const GaussianCloud& cloud, std::span<const Camera> cameras, const SplatOptions& splat);

/// Upper bound of the weight that any one Gaussian has on the wrong side of contours, summed over the views,
/// px. Not the share alone: half of a speck is nothing.
double straddling_bound_px(const GaussianCloud& cloud, std::span<const Camera> cameras, const SplatOptions& splat);

/// RMS difference between the colours [B, 3] of neighbours, levels. Not the spread of all colours, which a
/// boundary of two plain parts has too.
double neighbour_rms_levels(const KnnGraph& graph, Rows<const float, 3> colour);

/// Largest such difference, levels. Not the mean, in which the one seam of a plain boundary is lost.
double neighbour_most_levels(const KnnGraph& graph, Rows<const float, 3> colour);

/// Largest range of a channel over the colours [B, 3], levels. Not the neighbours' difference: a ramp has
/// none.
double colour_range_levels(Rows<const float, 3> colour);

/// RMS standard deviation of the 7x7 patches about the mask's contour, levels; 0 without a contour. Not that
/// of the whole photo, which may be textured elsewhere.
double contour_deviation_levels(const ImageF& photo, MaskPlane mask);

/// Side of the finest cell of an encoding with `finest` cells along `extent`, in median distances between
/// nearest neighbours. Not from extent and count: points lie on a curve or in clusters, not all over their
/// box.
double cells_per_spacing(const std::vector<float>& nearest_distance, double extent, int finest);

/// Mean of the gains in units of its standard error; 0 for fewer than two. Not the mean, which one view can
/// make.
double gain_in_errors(const std::vector<double>& gains);
/// The same as a score of the normal distribution: gains of few views have an uncertain standard error. Of three views
/// it stays below 1.75, of 12 it is 2 where gain_in_errors() is 2.38, of 32 where it is 2.12, of 100 where it is 2.04.
/// The transform of Student's t of Abramowitz and Stegun, 26.7.8. 0 for fewer than two.
double normal_score(double gain_in_errors, std::size_t views);
/// From here on a gain counts.
inline constexpr double kSignificant = 2;

/// Pixels of a mask, and those that no square of kNarrow_px in it covers; beyond the picture it may go on. Not the
/// contour's length by the area, which of a small thing is as large as of a thin one.
struct NarrowParts {
  double narrow_px2 = 0, all_px2 = 0;
};
inline constexpr int kNarrow_px = 9;
NarrowParts narrow_parts(MaskPlane mask);

/// Share of the rendered object weight that lies outside of the windows. Not the windows' share of the
/// picture.
double weight_outside(const ImageF& label, int x0, int y0, int x1, int y1);

}  // namespace ngs
