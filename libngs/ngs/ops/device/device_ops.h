#pragma once
// The ops that have a device path. Each means the same as the op of the same name. Arguments and results are in host
// memory, or resident; results are already sized. Only the ops themselves use Exec::device_ops, not their
// callers. This header therefore includes the types and kernels of the ops, but not the headers that declare the ops.
//
// Abstract, because there is one implementation per Launcher (backend/launcher.h): CUDA, and an emulation
// for the tests.
#include <array>
#include <memory>
#include <mutex>

#include "ngs/backend/exec.h"
#include "ngs/ops/field/field_types.h"
#include "ngs/ops/field/film_mlp_layout.h"
#include "ngs/ops/field/hash_grid_kernels.h"
#include "ngs/ops/field/ray_query_kernels.h"
#include "ngs/ops/losses/loss_align_kernels.h"
#include "ngs/ops/losses/loss_cont_kernels.h"
#include "ngs/ops/losses/loss_mask_kernels.h"
#include "ngs/ops/losses/loss_smooth_kernels.h"
#include "ngs/ops/losses/photometric_kernels.h"
#include "ngs/ops/optim/adam_kernels.h"
#include "ngs/ops/optim/row_kernels.h"
#include "ngs/ops/splat/splat_gaussian.h"
#include "ngs/scene/evidence.h"
#include "ngs/scene/knn_graph.h"
#include "ngs/scene/scene.h"

namespace ngs {

/// One view between forward and backward.
class DeviceSplat {
 public:
  virtual ~DeviceSplat() = default;
  /// out[c]: channel c of an image, out[count]: alpha. `for_backward`: backward() will follow.
  virtual void forward(const std::vector<Plane<float>>& out, bool for_backward) = 0;
  virtual void backward(const std::vector<Plane<const float>>& grad, const std::vector<std::uint8_t>& moves,
                        const CloudGradientView<float>& out) = 0;
};

/// A cloud's columns in device memory, for many views. Colours are copied when they are first needed, so the host's
/// columns must outlive it.
class DeviceCloud {
 public:
  virtual ~DeviceCloud() = default;
};

/// A cloud, and its columns in device memory if they are there; else they are copied for the call.
struct CloudOnHost {
  CloudView<float> view;
  DeviceCloud* resident = nullptr;
};

/// A view of a cloud, and its masks. `by_visibility`: PixelWeight::kByVisibility (ops/splat/evidence.h). `wanted` [N]:
/// the rows whose sums are returned; null: all.
struct EvidenceCall {
  ViewProjector<float> view;
  CloudOnHost cloud;
  const ViewMasks& masks;
  bool by_visibility;
  const std::uint8_t* wanted = nullptr;
};

/// Evidence of a loop over views, summed in device memory.
class DeviceEvidence {
 public:
  virtual ~DeviceEvidence() = default;
  virtual void add(const EvidenceCall& call) = 0;
  /// `out`: evidence of the same shape without a view.
  virtual void download(Evidence& out) const = 0;
};

/// The part of a view in front of a surface (FrontView of ops/splat/front_layer.h).
class DeviceFrontView {
 public:
  virtual ~DeviceFrontView() = default;
  /// `candidate` [N]; `number` [N]: the row of `value` of each candidate, null if it has no columns.
  virtual void layer(const std::uint8_t* candidate, const std::uint32_t* number, const Matrix<const float>& value,
                     ImageF& out) const = 0;
  /// W and W1 of the candidates with W > 0 in front, for `marked` [H·W] as the mask; ascending.
  virtual ViewSums sums(const std::uint8_t* candidate, const std::vector<std::uint8_t>& marked) const = 0;
};

class DeviceSplatOps {
 public:
  virtual ~DeviceSplatOps() = default;
  virtual std::unique_ptr<DeviceCloud> resident(const CloudView<float>& cloud) const = 0;
  virtual std::unique_ptr<DeviceSplat> view(const ViewProjector<float>& view, const CloudOnHost& cloud,
                                            const ChannelPlan<float>& plan) const = 0;
  /// view_sums() of one view (ops/splat/evidence.h), ascending by row.
  virtual ViewSums evidence(const EvidenceCall& call) const = 0;
  /// `limit` [H, W, 1] camera z of the surface, world.
  virtual std::unique_ptr<DeviceFrontView> front_view(const ViewProjector<float>& view, const CloudOnHost& cloud,
                                                      const ImageF& limit) const = 0;
  virtual std::unique_ptr<DeviceEvidence> evidence_sum(std::int64_t gaussians, int objects) const = 0;
};

/// The table of a hash grid and the query points, on the host.
struct HashCall {
  HashGridView<float> grid;
  int features;
  std::uint64_t entries;
};

struct FilmCall {
  FilmMlpConfig config;
  const float* params;  // FilmMlpLayout
  float density_scale;
  float* grad_params_accumulate = nullptr;
};

class DeviceFieldOps {
 public:
  virtual ~DeviceFieldOps() = default;
  /// Fills a graph's arrays, the transpose too. `out.neighbours` is the number of neighbours, at most that of the
  /// points.
  virtual void nearest(Rows<const float, 3> points, Rows<const float, 3> queries, bool exclude_self,
                       KnnGraph& out) const = 0;
  /// Fills kernel.node on the host.
  virtual void read_nodes(const ReadNodes& kernel) const = 0;
  virtual void rbf_forward(const RbfProblem& problem, float inv_2h2, RbfField& out) const = 0;
  virtual void rbf_backward(const RbfProblem& problem, const RbfField& field, Matrix<const float> grad_feature,
                            std::vector<float>& out) const = 0;
  virtual void hash_forward(const HashCall& call, std::vector<float>& out) const = 0;
  virtual void hash_backward(const HashCall& call, const std::vector<float>& grad_out,
                             float* grad_table_accumulate) const = 0;
  /// The size of FilmMlpOutput::context.
  virtual std::int64_t film_context_size(const FilmMlpConfig& config, std::int64_t queries) const = 0;
  virtual void film_forward(const FilmCall& call, const FilmMlpInputs& in, FilmMlpOutput& out) const = 0;
  virtual void film_backward(const FilmCall& call, const FilmMlpInputs& in, const FilmMlpOutputGradients& grad,
                             FilmMlpGradients& out) const = 0;
  virtual void volume_forward(const VolumeInputs& in, VolumeOutput& out) const = 0;
  virtual void volume_backward(const VolumeInputs& in, const VolumeOutput& forward, const VolumeOutputGradients& grad,
                               VolumeGradients& out) const = 0;
};

/// The losses take the kernels of the CPU with host pointers.
class DeviceLossOps {
 public:
  virtual ~DeviceLossOps() = default;
  /// Returns the sums over nodes.
  virtual std::array<double, 3> align_forward(const AlignForward<float>& kernel) const = 0;
  virtual void align_backward(const AlignBackwardField<float>& field, const AlignBackwardImage<float>& image,
                              std::int64_t rect_pixels) const = 0;
  virtual void density_weight(const DensityWeight& kernel, std::int64_t pixels) const = 0;
  /// Returns the sum over pixels.
  virtual double mask(const MaskLossRow<float, double>& kernel, int height) const = 0;
  /// Returns the sum over points.
  virtual double continuity(const ContinuityForward<float>& forward, const ContinuityBackward<float>* backward,
                            const AddRowColourGradients* add) const = 0;
  /// Returns the sum over pairs.
  virtual double smoothness(const SmoothnessForwardBackward<float>& kernel) const = 0;
  /// Sums of w |x - y| and w S over the crop.
  struct PhotometricSums {
    double l1, ssim;
  };
  virtual PhotometricSums photometric(const ssim::Comparison<float>& host) const = 0;
  /// The first gradient that is not finite or above `limit` in magnitude; then no value of any block is changed.
  struct UnusableGradient {
    std::size_t block;
    std::int64_t index;  // -1: none
    float value;
  };
  virtual UnusableGradient adam(const AdamBlocks& blocks, float limit) const = 0;
};

/// Keeps host arrays in device memory (ops/optim/resident.h): ops that get such an array, or a part of it, then use the
/// copy there. Runs the kernels of ops/optim/row_kernels.h on such arrays.
class DeviceArrays {
 public:
  virtual ~DeviceArrays() = default;
  virtual void keep(void* host, std::size_t bytes) const = 0;
  /// Like keep(), for an array that no op changes: the host's values stay valid.
  virtual void keep_input(const void* host, std::size_t bytes) const = 0;
  /// Like keep(), for an array whose values are undefined until an op writes them.
  virtual void reserve(void* host, std::size_t bytes) const = 0;
  /// Sets an array to zero if it is resident; else returns false.
  virtual bool zero(void* host, std::size_t bytes) const = 0;
  /// Copies a resident array's values to the host or back; it stays resident.
  virtual void update_host(void* host, std::size_t bytes) const = 0;
  virtual void update_device(const void* host, std::size_t bytes) const = 0;
  /// Copies the array back, and forgets it.
  virtual void give_back(void* host) const = 0;
  virtual void drop(const void* host) const noexcept = 0;
  /// All arrays of the kernel are resident.
  virtual void run(const RowKernel& kernel, std::int64_t rows) const = 0;
};

/// One thread at a time uses a device. Threads of a parallel loop that render hold `rendering` (ops/splat/splat.h).
struct DeviceOps {
  const DeviceSplatOps& splat;
  const DeviceFieldOps& field;
  const DeviceLossOps& loss;
  const DeviceArrays& arrays;
  mutable std::mutex rendering = {};
};

}  // namespace ngs
