#pragma once
// Differentiable Gaussian splatting of one view: project, bin, composite.              Eq. (2); PAPER.md §5.1
//
// Depth order is (camera z, Gaussian index), so equal depths have a defined order. Gaussians with
// `usable == 0`, behind the near plane or off-screen contribute nothing. Results do not depend on
// exec.threads.
#include <memory>

#include "ngs/backend/exec.h"
#include "ngs/ops/splat/splat_options.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/rendered_view.h"

namespace ngs {

/// `cloud` made ready for passes over many views, to be put into SplatOptions: the same results, sooner. Takes 56 bytes
/// per Gaussian, and per pass that runs at a time about 150 per Gaussian that the view sees. The cloud must
/// not go before the last pass with it, nor change but by update_prepared(). Null where passes run on a device, which
/// does without.
std::shared_ptr<PreparedCloud> prepare_cloud(const Exec& exec, const GaussianCloud& cloud);

/// Follows a change of these rows (increasing) of the cloud that `prepared` was made from.
void update_prepared(const Exec& exec, const std::vector<std::int64_t>& rows, PreparedCloud& prepared);

/// The options with what serves `cloud`: what they have, or what is made for it now.
SplatOptions prepared_for(const Exec& exec, SplatOptions options, const GaussianCloud& cloud);

/// Which images to produce, and from which Gaussians.
struct RenderRequest {
  bool colour = true;
  bool depth = false;
  Matrix<const float> label;              // [N, K] label channel values in [0, 1]; n = 0: none
  Vec3<float> background{0, 0, 0};        // colour behind everything
  const std::uint8_t* include = nullptr;  // [N] 1: draw; null: draw all (amodal rendering passes a subset)
  // [N] 1: render() may skip every tile that none of these Gaussians touches: its pixels are then undefined, in
  // practice the background; null: all tiles are rendered
  const std::uint8_t* tiles_touching = nullptr;
  // [N] 1: every Gaussian with a label that is not 0 is one of these, and only labels are rendered: render() may then
  // skip the Gaussians behind the last of these in each tile, with the same labels to the bit; null: none is skipped
  const std::uint8_t* stop_after = nullptr;
};

/// Forward only.
RenderedView render(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& options,
                    const RenderRequest& request);

/// Which Gaussians' gradients are wanted, and where they go.
struct GradientRows {
  std::vector<std::uint8_t> label_alone = {};  // [N] 1: that of the labels alone, the rest of the row is 0; empty: none
  std::vector<std::int32_t> place = {};        // [N] row of CloudGradients, -1: none; empty: row i. Not on a device
  std::int64_t rows = 0;                       // of CloudGradients, where there is `place`
};

/// One forward pass that can be differentiated. Keeps the projection and the tile lists of the last forward.
class SplatPass {
 public:
  explicit SplatPass(SplatOptions options);
  ~SplatPass();
  SplatPass(SplatPass&&) noexcept;
  SplatPass& operator=(SplatPass&&) noexcept;

  /// `cloud` and `request.label` must outlive the matching backward call.
  const RenderedView& forward(const Exec& exec, const GaussianCloud& cloud, const Camera& camera,
                              const RenderRequest& request);

  /// Overwrites `out` with the gradients of the last forward. Adjoint of forward; ∂α/∂· = 0 where α is capped.
  void backward(const Exec& exec, const ViewGradients& gradients, CloudGradients& out, const GradientRows& wanted = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ngs
