#pragma once
// The joint step with everything it needs resident on a device (passes/joint/resident_steps.h drives it).   Eq. (20)
//
// A step is a sequence of launches that nothing waits for. What can stop it, lists of tiles that outgrow their room or a
// gradient that Adam cannot take, is decided on the device: that step and all after it then change nothing, and
// `status` says which step it was, so that it can be done again, or refused.
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "ngs/ops/optim/adam.h"
#include "ngs/ops/field/film_mlp.h"
#include "ngs/ops/field/hash_grid.h"
#include "ngs/ops/losses/loss_align.h"
#include "ngs/ops/losses/loss_mask.h"
#include "ngs/ops/losses/loss_smooth.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/ops/field/ray_query.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/knn_graph.h"
#include "ngs/scene/scene.h"

namespace ngs {

/// Parameters with one rate: host memory that `download` writes. They are checked for unusable gradients in their order.
struct JointBlock {
  std::string name;
  std::span<float> value;
  AdamMoments* moments;
  double rate = 0;  // of the first step; 0: not trained
  double beta2 = 0.999;
  int sparse_columns = 0;  // as AdamOptions
};
/// The blocks of the Gaussians come first and in this order; then the field's, in the order of its store.
enum JointColumn { kJointLabel, kJointPosition, kJointRotation, kJointScale, kJointOpacity, kJointDc, kJointRest, kJointColumns };

/// The field: where its parts lie among the values of its store.
struct JointFieldLayout {
  const HashGrid* hash;
  const FilmMlp* film;
  std::size_t feature_offset;
  int neighbours;
  double width;       // of the RBF kernel, world
  bool conditioned;   // false: the network sees a condition of zeros (--effect film=off)
};

/// Which terms there are. A weight of a term that is off is not read.
struct JointTerms {
  bool photometric, align, density, mask, cont, smooth;
  bool label_moves_geometry, excess_variance, pixel_windows, whole_image;
  double photometric_weight, lambda_mask, lambda_cont, lambda_smooth;
  AlignOptions align_options;
  MaskLossForm mask_form;
  int smooth_points;
  SmoothnessScale smooth_scale;
};

/// Host memory, copied where it is not said to be kept; so are the parts of the field.
struct JointProblem {
  JointTerms terms;
  std::vector<JointBlock> blocks;
  const GaussianCloud& initial;  // kept: queries of first visits are those of this model
  int sh_degree;                 // bands to evaluate
  std::vector<std::uint8_t> trainable;  // [N, K] of the labels
  std::vector<std::uint8_t> frozen;     // [N] 1: shape, opacity and colour stay; empty: none
  int objects;
  std::span<const std::uint32_t> boundary;  // [B] rows
  const KnnGraph* colour_graph;             // of L_cont; no queries: none
  std::optional<JointFieldLayout> field;
  GridShape shape;
  RayOptions rays;
  double bbox_pad_px;
  SplatOptions splat, initial_splat;
  Vec3<float> background;
  std::uint64_t seed;
  double rate_decay;  // all rates fall exponentially to this factor
  std::int64_t views;
};

/// What a step needs of a view beside its camera; pointers are read before the step returns.
struct JointImages {
  const ImageF* photo;
  const ViewMasks* masks;
  PixelRegion region;  // of the photometric term; empty: all
};
struct JointView {
  std::size_t number;                   // in [0, views)
  Camera camera;                        // relative to the model's origin
  std::function<JointImages()> images;  // called where they are not on the device yet
};

/// Where the query points of a step come from.
enum class JointQueries : std::uint8_t { kInitial, kCurrent, kGiven };
struct JointRays {  // kGiven
  const RayQueries* rays;
  const KnnGraph* graph;
};

struct JointStatus {
  std::int64_t done = 0;         // steps that changed something
  std::int64_t pairs = 0;        // room that lists of tiles wanted
  bool full = false;             // halted: more than there is
  std::int64_t bad_block = -1;   // halted: this block has a gradient that Adam cannot take
  std::int64_t bad_index = 0;
  float bad_value = 0;
};

/// Unweighted, of the last step.
struct JointLosses {
  double photometric = 0, align = 0, mask = 0, cont = 0, smooth = 0;
};

class DeviceJoint {
 public:
  virtual ~DeviceJoint() = default;
  /// Parameters and moments from their blocks, `done` steps behind them, of `steps`.
  virtual void upload(std::int64_t done, std::int64_t steps) = 0;
  virtual void download() = 0;
  virtual void plan(std::int64_t steps) = 0;
  virtual void step(const JointView& view, JointQueries queries, const JointRays& given) = 0;
  virtual JointStatus status() = 0;  // waits for the steps
  virtual JointLosses losses() = 0;  // waits
  /// Room for lists of tiles of `pairs` entries; goes on after a halt.
  virtual void resume(std::int64_t pairs) = 0;
};

class DeviceJointOps {
 public:
  virtual ~DeviceJointOps() = default;
  virtual std::unique_ptr<DeviceJoint> start(const JointProblem& problem) const = 0;
};

}  // namespace ngs
