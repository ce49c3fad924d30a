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
/// per Gaussian, and per pass that runs at a time about 150 per Gaussian that the view sees. The cloud must neither
/// change nor go before the last pass with it. Null where passes run on a device, which does without.
std::shared_ptr<const PreparedCloud> prepare_cloud(const Exec& exec, const GaussianCloud& cloud);

/// Which images to produce, and from which Gaussians.
struct RenderRequest {
  bool colour = true;
  bool depth = false;
  Matrix<const float> label;              // [N, K] label channel values in [0, 1]; n = 0: none
  Vec3<float> background{0, 0, 0};        // colour behind everything
  const std::uint8_t* include = nullptr;  // [N] 1: draw; null: draw all (amodal rendering passes a subset)
};

/// Forward only.
RenderedView render(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& options,
                    const RenderRequest& request);

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

  /// Overwrites `out` with the gradients of the last forward. Adjoint of forward; ∂α/∂· = 0 where α is capped. Of
  /// Gaussians with label_alone[i] != 0 (empty: none) only that of the labels is found; their other rows are 0.
  void backward(const Exec& exec, const ViewGradients& gradients, CloudGradients& out,
                const std::vector<std::uint8_t>& label_alone = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ngs
