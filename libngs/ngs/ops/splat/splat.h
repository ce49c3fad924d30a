#pragma once
// Differentiable Gaussian splatting of one view: project, bin, composite.              Eq. (2); paper.md §5.1
//
// Depth order is (camera z, Gaussian index), so equal depths have a defined order. Gaussians with `usable == 0`, behind
// the near plane or off-screen contribute nothing. Results do not depend on exec.threads.
#include <memory>

#include "ngs/backend/exec.h"
#include "ngs/ops/splat/splat_options.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/rendered_view.h"

namespace ngs {

class ResidentResults;

/// Preprocesses `cloud` for passes over many views; put the result into SplatOptions. Same results, faster. Takes 56
/// bytes per Gaussian, and for each concurrent pass about 150 bytes per visible Gaussian. The cloud must outlive the
/// last pass; after a change of rows call update_prepared(). With a device: copies the cloud into its memory, once for
/// all passes.
std::shared_ptr<PreparedCloud> prepare_cloud(const Exec& exec, const GaussianCloud& cloud);

/// Updates `prepared` after these rows (ascending) of its cloud have changed.
void update_prepared(const Exec& exec, const std::vector<std::int64_t>& rows, PreparedCloud& prepared);

/// The options with a prepared `cloud`: the one in `options` if it was made from `cloud`, else a new one.
SplatOptions prepared_for(const Exec& exec, SplatOptions options, const GaussianCloud& cloud);
/// The same on a device, where each call would copy the cloud; on the CPU the options as they are, for less memory.
SplatOptions prepared_for_device(const Exec& exec, SplatOptions options, const GaussianCloud& cloud);

/// Which images to produce, and from which Gaussians.
struct RenderRequest {
  bool colour = true;
  bool depth = false;
  Matrix<const float> label;              // [N, K] label channel values in [0, 1]; n = 0: none
  Vec3<float> background{0, 0, 0};        // background colour
  const std::uint8_t* include = nullptr;  // [N] 1: render; null: render all (amodal rendering passes a subset)
  // [N] 1: render() may skip tiles that none of these Gaussians touches. Pixels of skipped tiles are undefined, in
  // practice the background. null: all tiles are rendered
  const std::uint8_t* tiles_touching = nullptr;
  // [N] 1: render() may skip Gaussians behind the last of these in each tile. Requires that every Gaussian with a
  // non-zero label is flagged; label images are then bit-identical, the others undefined. null: none is skipped
  const std::uint8_t* stop_after = nullptr;
  // [tiles] 0: the tile of kTilePx² pixels may be skipped, which are then undefined; null: none is skipped. For
  // render() instead of the two above
  const std::uint8_t* tiles = nullptr;
};

/// Forward only. May be called by several threads at once, with a device too: it then renders for one after the other,
/// and skips nothing.
RenderedView render(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& options,
                    const RenderRequest& request);

/// Which Gaussians need gradients, and in which rows of CloudGradients they are stored.
struct GradientRows {
  std::vector<std::uint8_t> label_only = {};    // [N] 1: only label gradients, the rest is 0; empty: none
  std::vector<std::int32_t> gradient_row = {};  // [N] row of CloudGradients, -1: none; empty: row i
  std::int64_t rows = 0;                        // rows of CloudGradients if `gradient_row` is not empty
  // false: SH bands from 1 are constants: CloudGradients::sh_rest is empty, and positions have no gradient through them
  bool sh_rest = true;
};

/// A differentiable forward pass. Stores the projection and tile lists of the last forward for backward.
class SplatPass {
 public:
  /// `images`: with a device, the rendered images stay in its memory, and the host's values are undefined; null: they
  /// are copied to the host.
  explicit SplatPass(SplatOptions options, ResidentResults* images = nullptr);
  ~SplatPass();
  SplatPass(SplatPass&&) noexcept;
  SplatPass& operator=(SplatPass&&) noexcept;

  /// `cloud` and `request.label` must outlive the matching backward call.
  RenderedView& forward(const Exec& exec, const GaussianCloud& cloud, const Camera& camera,
                        const RenderRequest& request);

  /// Overwrites `out` with the gradients of the last forward. Adjoint of forward; ∂α/∂· = 0 where α is capped.
  void backward(const Exec& exec, const ViewGradients& gradients, CloudGradients& out, const GradientRows& wanted = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ngs
