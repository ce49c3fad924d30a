#pragma once
// Boxes, grids and query points of every view.                    Eqs. (4)-(7), Algorithm 1 steps 2-4
#include <string>
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/ops/field/ray_query.h"
#include "ngs/ops/field/rbf.h"
#include "ngs/ops/field/sample_grid.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/options/field.h"
#include "ngs/scene/boundary_set.h"
#include "ngs/scene/query_field.h"
#include "ngs/scene/scene.h"

namespace ngs {

/// Smallest half depth window, in units of math/world_unit.h (Eq. 7).
inline constexpr double kDepthEpsilon = 1e-4;

struct SampleOptions {
  int rows = 64, cols = 64;
  int depth_samples = 8;
  double bbox_pad_px = 5;
  double depth_span = 0.1;
  // The grid covers the full image of every view that shows the boundary. Set by --effect box=off only.
  bool whole_image = false;
  double world_unit = 1;  // the scene's (math/world_unit.h)

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.rows,
          Field<int>{"rows", "", "Grid rows per view, fewer if a cell would be under 1 px (Eq. 5)", 1, 4096});
    visit(self.cols, Field<int>{"cols", "", "Grid columns per view (Eq. 5)", 1, 4096});
    visit(self.depth_samples, Field<int>{"depth_samples", "", "Query points per ray, the paper's K (Eq. 7)", 1, 256});
    visit(self.bbox_pad_px, Field<double>{"bbox_pad_px", "px",
                                          "Margin of the box around the boundary, the paper's delta (Eq. 4)", 0, 1e4});
    visit(self.depth_span,
          Field<double>{"depth_span", "", "Half depth window relative to the depth, the paper's alpha (Eq. 7)", 0, 1});
  }
};

/// Upper bound of the number of query points.
std::int64_t most_queries(const SampleOptions& options, std::size_t views);

/// Options for the rays of a view whose boundary has the mean distance `mean_distance` (world units).
RayOptions ray_options(const SampleOptions& options, double mean_distance);

struct ViewSample {
  BoundaryBox boundary;  // its box is the area of the grid, the full image with whole_image; visible == 0: no rays
  RayQueries rays;
};

/// The grid and rays of one camera. `camera` is relative to the model's origin (relative_to). Depth windows are centred
/// on the rendered depth of the pixel (C12), or with an empty `map` on the mean distance.
ViewSample sample_view(const Exec& exec, const SampleOptions& options, const Camera& camera,
                       Rows<const float, 3> boundary, const DepthMap& map);

struct SampleInputs {
  const GaussianCloud& cloud;
  const BoundarySet& boundary;
  const Scene& scene;
  std::vector<std::size_t> views;  // indices of scene.views
  SplatOptions splat = {};
};

/// Query points of the given views, with depth windows centred on the rendered depth.
QueryField sample_queries(const Exec& exec, Monitor& monitor, const SampleOptions& options, const SampleInputs& in);

// Interpolates the colours of boundary Gaussians at query points.        Eqs. (8)-(9), Algorithm 1 step 5

struct RbfOptions {
  int neighbours = 8;
  std::string width = "auto";
  double width_factor = 1.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.neighbours,
          Field<int>{"neighbours", "", "Boundary Gaussians used per query point (before Eq. 8)", 1, kMaxNeighbours});
    visit(self.width, Text{"width", "auto|WORLD",
                           "Kernel width, the paper's sigma (Eq. 8); auto: from the mean spacing of the boundary (C22)"}
                          .of("nerf"));
    visit(self.width_factor,
          Field<double>{"width_factor", "", "Factor on the width of --width auto", 1e-3, 1e3}.of("nerf"));
  }
};

/// Throws kInconsistent if `origin` differs from that of the field.
void require_same_origin(const QueryField& field, const std::array<double, 3>& origin);

/// The kernel width in world units. Throws kUsage if `options.width` is neither auto nor a positive number.
double rbf_width(const Exec& exec, const RbfOptions& options, Rows<const float, 3> boundary);

struct RbfSummary {
  double width = 0;              // world
  std::int64_t far_queries = 0;  // nearest boundary Gaussian beyond 4 widths: the query gets its colour alone
  double mean_nearest = 0;       // world, mean distance to the nearest boundary Gaussian
};

/// Fills `field`: feature (weighted mean colour of the neighbours), neighbour (rows of the model) and weight. Throws
/// kInconsistent if the boundary has another origin than the field, kBadInput if a position is not finite.
RbfSummary interpolate_features(const Exec& exec, Monitor& monitor, const RbfOptions& options,
                                const BoundarySet& boundary, QueryField& field);

}  // namespace ngs
