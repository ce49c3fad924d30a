#pragma once
// Interpolates the colours of boundary Gaussians at query points.        Eqs. (8)-(9), Algorithm 1 step 5
#include <string>

#include "ngs/core/monitor.h"
#include "ngs/ops/field/rbf.h"
#include "ngs/options/field.h"
#include "ngs/scene/boundary_set.h"
#include "ngs/scene/query_field.h"

namespace ngs {

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
