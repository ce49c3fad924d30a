#pragma once
// The continuous field of the joint optimisation: boundary features, RBF condition, hash encoding, FiLM
// network and volume rendering on the rays of one view, forward and backward.          Eqs. (1), (4)-(15)
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/ops/field/film_mlp.h"
#include "ngs/ops/field/hash_grid.h"
#include "ngs/ops/field/ray_query.h"
#include "ngs/ops/field/volume.h"
#include "ngs/ops/losses/loss_align.h"
#include "ngs/ops/optim/adam.h"
#include "ngs/passes/joint/joint_options.h"
#include "ngs/scene/boundary_set.h"
#include "ngs/scene/param_store.h"

namespace ngs {

/// The rays of one view with the neighbours of their query points. No rays: the view does not see the
/// boundary.
struct FieldRays {
  RayQueries rays;
  KnnGraph graph;                        // query -> boundary
  std::vector<std::uint8_t> on_surface;  // [R] the ray takes part in L_align (C15)
};

/// How far query points may lie from the boundary, world.
double field_reach(const SampleOptions& sample, const GaussianCloud& cloud, const std::vector<Camera>& cameras,
                   const BoundarySet& boundary);

/// Finest useful cell of the encoding, in spacings of the boundary: two cells to a spacing.
inline constexpr double kFinestCell = 0.5;

/// Side of the finest cell of the encoding, in spacings of the boundary (passes/detectors.h).
double encoding_cells(const Exec& exec, double reach, double width, Rows<const float, 3> boundary, int finest);

class JointField {
 public:
  struct Setup {
    const JointOptions& options;
    const JointSwitches& effects;
    const SampleOptions& sample;
    const RbfOptions& rbf;
    const GaussianCloud& cloud;
    const BoundarySet& boundary;
    double reach = 0;  // world: how far query points may lie from the boundary; the encoding's box is grown by it
    std::uint64_t seed = 0;
  };
  JointField(const Exec& exec, const Setup& setup);

  /// Rays of `camera` (relative to the model's origin) about the boundary as it is now. `map`: see
  /// sample_view.
  FieldRays rays(const Exec& exec, const Camera& camera, Rows<const float, 3> boundary, const DepthMap& map) const;
  /// The same from one view of the artifact of ngs-sample and ngs-rbf.
  FieldRays rays(const Exec& exec, const Camera& camera, const QueryField& field, std::size_t view,
                 const BoundarySet& boundary) const;

  /// Renders the field along the rays. `boundary` positions as they are now.
  const VolumeOutput& forward(const Exec& exec, const FieldRays& rays, Rows<const float, 3> boundary,
                              Vec3<float> background);
  /// Adds the gradient of what the last forward rendered to the parameters' gradients.
  void backward(const Exec& exec, const FieldRays& rays, Rows<const float, 3> boundary, Vec3<float> background,
                const AlignFieldGradients& gradients);

  /// L_smth (Eq. 18) at an evenly spaced subset of the last forward's query points; adds `weight` times its
  /// gradient.
  double smoothness(const Exec& exec, const FieldRays& rays, Rows<const float, 3> boundary, double weight,
                    std::int64_t step);

  /// One Adam step on all parameters; clears the gradients. `decay` multiplies the rates.
  void step(const Exec& exec, std::int64_t step, double decay);

  ParamStore& parameters() { return store_; }
  const ParamStore& parameters() const { return store_; }
  std::vector<AdamMoments>& moments() { return moments_; }
  double width() const { return width_; }

 private:
  struct Sampled {  // one evaluation of the network
    RbfField rbf;
    std::vector<float> encoding;
    FilmMlpOutput network;
    FilmMlpInputs inputs(Rows<const float, 3> direction, std::int64_t per_direction, const FilmMlpConfig& config) const;
  };
  struct Points {  // what is evaluated
    Rows<const float, 3> position;
    const KnnGraph* graph;
    Rows<const float, 3> direction;
    std::int64_t per_direction;
    Rows<const float, 3> boundary;
  };
  AdamOptions adam_of(const ParamBlock& block) const;
  void evaluate(const Exec& exec, const Points& points, Sampled& out) const;
  void differentiate(const Exec& exec, const Points& points, const Sampled& at, const std::vector<float>& grad_density,
                     const std::vector<float>& grad_rgb);
  RbfProblem rbf_problem(const Points& points) const;
  Points points_of(const FieldRays& rays, Rows<const float, 3> boundary) const;

  JointOptions options_;
  JointSwitches effects_;
  SampleOptions sample_;
  int neighbours_ = 8;
  double width_ = 1;
  ParamStore store_;
  std::size_t feature_offset_ = 0;
  std::int64_t boundary_count_ = 0;
  std::uint64_t seed_ = 0;
  std::vector<AdamMoments> moments_;
  HashGridConfig hash_config_;
  HashGrid hash_;
  FilmMlp mlp_;
  Sampled sampled_;
  VolumeOutput volume_;
  VolumeGradients volume_grad_;
};

}  // namespace ngs
