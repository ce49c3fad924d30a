#pragma once
// Interpolation of the boundary Gaussians' colours at query points.      Eqs. (8)-(9), Algorithm 1 step 5
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
          Field<int>{"neighbours", "", "boundary Gaussians per query point (before Eq. 8)", 1, kMaxNeighbours});
    visit(self.width, Text{"width", "auto|WORLD",
                           "kernel width, the paper's sigma (Eq. 8); auto: from the mean spacing of the boundary (C22)"}
                          .of("nerf"));
    visit(self.width_factor, Field<double>{"width_factor", "", "--width auto: times this", 1e-3, 1e3}.of("nerf"));
  }
};

/// kInconsistent where the field is of a model with another origin.
void require_same_origin(const QueryField& field, const std::array<double, 3>& origin);

/// The kernel width in world units. kUsage where `options.width` is neither auto nor a positive number.
double rbf_width(const Exec& exec, const RbfOptions& options, Rows<const float, 3> boundary);

struct RbfSummary {
  double width = 0;              // world
  std::int64_t far_queries = 0;  // nearest boundary Gaussian beyond 4 widths: practically its own feature
  double mean_nearest = 0;       // world, mean distance to the nearest
};

/// Fills feature (the colours of the neighbours, weighted), neighbour (rows of the model) and weight of
/// `field`. kInconsistent where the field is of a model with another origin, kBadInput where a position is
/// not finite.
RbfSummary interpolate_features(const Exec& exec, Monitor& monitor, const RbfOptions& options,
                                const BoundarySet& boundary, QueryField& field);

}  // namespace ngs
