#pragma once
// Mask evidence per Gaussian, one forward pass per view.                 m_ij before Eq. (3); paper.md §5.2
#include "ngs/math/row_numbers.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/evidence.h"
#include "ngs/scene/scene.h"

namespace ngs {

class DeviceEvidence;

/// Weight of a pixel for a Gaussian with alpha α and transmittance T in front of it.
enum class PixelWeight : std::uint8_t {
  kRendered,      // w = α T, as in rendering
  kByVisibility,  // α T²: less where the Gaussian is seen through others
};

/// A view whose pixels are all known, without objects, or with one that covers `mask` [H·W] (0 or 1).
inline ViewMasks known_view(const Camera& camera) { return {camera.width_px, camera.height_px, {}, {}, true}; }
inline ViewMasks known_view(const Camera& camera, const std::vector<std::uint8_t>& mask) {
  return {camera.width_px, camera.height_px, {{mask.begin(), mask.end()}}, {}, true};
}

/// A camera and the masks of its view, at the camera's size.
struct MaskedView {
  const Camera& camera;
  const ViewMasks& masks;
  PixelWeight weight = PixelWeight::kRendered;
};

/// Evidence of one view for its visible Gaussians. With `of`: only for the Gaussians in `of`, and ViewSums::row holds
/// their numbers there. Empty if the view's masks are not available. Weights include occlusion; pixels with
/// masks.known == 0 are not counted.
ViewSums view_sums(const Exec& exec, const GaussianCloud& cloud, const MaskedView& view, const SplatOptions& options,
                   const RowNumbers* of = nullptr);

/// The weights of view_sums(), packed.
PackedSums packed_sums(const Exec& exec, const GaussianCloud& cloud, const MaskedView& view,
                       const SplatOptions& options, const RowNumbers* of = nullptr);

/// The mask of a view with most of a Gaussian's weight.
struct HeaviestMask {
  std::uint32_t row = 0;     // the Gaussian
  std::int32_t object = -1;  // index of the mask; -1: no weight in any
  double weight = 0;         // W, px
  double pixels = 0;         // known pixels reached (unweighted)
  double of_object = 0;      // W1 of `object`
  double of_all = 0;         // sum of W1 over the masks
};
/// Per visible Gaussian, from view_sums() without storing them. The order depends on cloud, camera and options only.
std::vector<HeaviestMask> heaviest_masks(const Exec& exec, const GaussianCloud& cloud, const MaskedView& view,
                                         const SplatOptions& options);

/// Adds view_sums() to `evidence` without storing it.
void add_view_evidence(const Exec& exec, const GaussianCloud& cloud, const MaskedView& view,
                       const SplatOptions& options, Evidence& evidence);

/// The same for a loop over views of one model. With a device the sums stay in its memory until result(), if they take
/// at most 2 GiB. `cloud` must outlive this object.
class EvidenceSum {
 public:
  EvidenceSum(const Exec& exec, const GaussianCloud& cloud, int objects, SplatOptions options);
  ~EvidenceSum();
  void add(const MaskedView& view);
  /// Call once, last.
  Evidence result();

 private:
  const Exec exec_;
  const GaussianCloud& cloud_;
  SplatOptions options_;
  Evidence sum_;  // zero with on_device_
  std::unique_ptr<DeviceEvidence> on_device_;
};

}  // namespace ngs
