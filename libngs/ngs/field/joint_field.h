#pragma once
// The NeRF of the joint optimisation: boundary features, RBF condition, hash encoding, FiLM network and volume
// rendering along the rays of one view, forward and backward.                                    Eqs. (1), (4)-(15)
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/field/field_options.h"
#include "ngs/field/sample_stage.h"
#include "ngs/ops/field/film_mlp.h"
#include "ngs/ops/field/hash_grid.h"
#include "ngs/ops/field/ray_query.h"
#include "ngs/ops/field/volume.h"
#include "ngs/ops/losses/loss_align.h"
#include "ngs/ops/losses/loss_smooth.h"
#include "ngs/ops/optim/adam.h"
#include "ngs/ops/optim/resident.h"
#include "ngs/scene/boundary_set.h"
#include "ngs/scene/param_store.h"

namespace ngs {

/// The rays of one view, with the neighbours of their query points. Empty if the boundary is not in view.
struct FieldRays {
  RayQueries rays;
  KnnGraph graph;                        // query -> boundary
  std::vector<std::uint8_t> on_surface;  // [R] the ray takes part in L_align (C15)
};

/// Maximum distance of query points from the boundary, world.
double field_reach(const SampleOptions& sample, const GaussianCloud& cloud, const std::vector<Camera>& cameras,
                   const BoundarySet& boundary);

/// Side of the finest useful cell of the encoding, in spacings of the boundary: two cells per spacing.
inline constexpr double kFinestCell = 0.5;

/// Side of the finest cell of the encoding, in spacings of the boundary (problem/scene_measures.h).
double encoding_cells(const Exec& exec, double reach, double width, Rows<const float, 3> boundary, int finest);

struct FieldShape {
  HashGridConfig hash;
  HashBox<float> box{};  // of the encoding, world, relative to the model's origin
  int hidden = 64, layers = 2;
  bool film = true;  // off: the condition is zero
  double width = 1;  // kernel width, world
  int neighbours = 8;
  std::int64_t boundary = 0;  // Gaussians
};

/// Validates a field written by ngs-sample. kBadInput: it does not have the nodes of every grid in order, each with
/// pixel and depth. kInconsistent: it is relative to another origin. `name`: of the file, for messages.
void require_grids(const QueryField& field, const GaussianCloud& cloud, const std::string& name);

class JointField {
 public:
  struct Setup {
    const FieldOptions& options;
    const PartSwitches& parts;
    const SampleOptions& sample;
    const RbfOptions& rbf;
    const GaussianCloud& cloud;
    const BoundarySet& boundary;
    double reach = 0;  // maximum distance of query points from the boundary, world; grows the encoding's box
    std::uint64_t seed = 0;
  };
  JointField(const Exec& exec, const Setup& setup);
  /// A field with initial parameters; the features are zero. `exec`: where it will run.
  JointField(const FieldShape& shape, std::uint64_t seed, const Exec& exec = {});

  /// Rays from one view of a file of ngs-sample and ngs-rbf.
  FieldRays rays(const Exec& exec, const Camera& camera, const QueryField& field, std::size_t view,
                 const BoundarySet& boundary) const;
  /// Keeps the rays of a step where ops run; finds their neighbours if they have no graph.
  const FieldRays& hold(const Exec& exec, FieldRays&& rays, Rows<const float, 3> boundary);

  /// Renders the field along the rays. `boundary`: current positions.
  const VolumeOutput& forward(const Exec& exec, const FieldRays& rays, Rows<const float, 3> boundary,
                              Vec3<float> background);
  /// Adds the gradient of the last forward() to the parameters' gradients.
  void backward(const Exec& exec, const FieldRays& rays, Rows<const float, 3> boundary, Vec3<float> background,
                const AlignFieldGradients& gradients);

  /// L_smth (Eq. 18) at an evenly spaced subset of the rays' query points. Adds `weight` times its gradient.
  double smoothness(const Exec& exec, const FieldRays& rays, Rows<const float, 3> boundary, double weight,
                    std::int64_t step);

  void add_to(Resident& resident);
  /// One Adam step on all parameters, then clears the gradients. `decay` multiplies the rates.
  void step(const Exec& exec, std::int64_t step, double decay);

  ParamStore& parameters() { return store_; }
  const ParamStore& parameters() const { return store_; }
  std::vector<AdamMoments>& moments() { return moments_; }
  const FieldShape& shape() const { return shape_; }

 private:
  struct Sampled {  // one evaluation of the network
    RbfField rbf;
    std::vector<float> encoding;  // [Q, inputs] f_hash
    FilmMlpOutput network;
    FilmMlpInputs inputs(Rows<const float, 3> direction, std::int64_t per_direction, const FilmMlpConfig& config) const;
  };
  struct InputGradients {
    FilmMlpGradients network;
    std::vector<float> feature;  // [B, F]
  };
  struct SmoothPairs {  // both ends of the pairs of L_smth
    std::vector<float> position[2], direction;
    KnnGraph graph[2];
    Sampled at[2];
    SmoothnessGradients grad;
    std::vector<float> no_density;  // [pairs] 0
  };
  struct OutputGradients {
    const std::vector<float>&density, &rgb;  // [Q], [Q, 3]
  };
  struct Points {  // inputs of one evaluation
    Rows<const float, 3> position;
    const KnnGraph* graph;
    Rows<const float, 3> direction;
    std::int64_t per_direction;
    Rows<const float, 3> boundary;
  };
  AdamOptions adam_of(const ParamBlock& block) const;
  void evaluate(const Exec& exec, const Points& points, Sampled& out);
  void differentiate(const Exec& exec, const Points& points, const Sampled& at, const OutputGradients& grad);
  VolumeInputs volume_inputs(const FieldRays& rays, Vec3<float> background) const;
  RbfProblem rbf_problem(const Points& points) const;
  Points points_of(const FieldRays& rays, Rows<const float, 3> boundary) const;

  bool recompute_neighbours_ = false;  // true: ignore neighbours stored in a file
  int smooth_points_ = 0;
  double smooth_step_ = 0;
  FieldShape shape_;
  ParamStore store_;
  std::size_t feature_offset_ = 0;
  std::uint64_t seed_ = 0;
  std::vector<AdamMoments> moments_;
  HashGrid hash_;
  FilmMlp mlp_;
  ResidentResults results_;  // the following arrays
  FieldRays rays_;
  Sampled sampled_;
  VolumeOutput volume_;
  VolumeGradients volume_grad_;
  InputGradients input_grad_;
  SmoothPairs smooth_;
};

}  // namespace ngs
