#pragma once
// One view of a fixed cloud, rendered and weighed many times: projected and binned into tiles once.
#include <cstdint>
#include <memory>
#include <vector>

#include "ngs/ops/splat/splat.h"
#include "ngs/scene/view_prompt.h"
#include "ngs/scene/view_sums.h"

namespace ngs {

/// The cloud must outlive this object and must not change. CPU only. Takes about 90 bytes per Gaussian that may reach a
/// pixel and 40 bytes per (Gaussian, tile) pair.
class CachedView {
 public:
  CachedView(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& options);
  ~CachedView();
  CachedView(const CachedView&) = delete;
  CachedView& operator=(const CachedView&) = delete;

  const Camera& camera() const { return camera_; }
  /// [V] rows of the Gaussians that may reach a pixel, ascending.
  const std::vector<std::uint32_t>& rows() const;

  /// Bit-identical to ngs::render(). request.include must be null.
  RenderedView render(const Exec& exec, const RenderRequest& request);

  /// The weights of rows(), 0 if hidden, bit-identical to view_sums() with this mask [H·W] and no unknown pixels; valid
  /// until the next call. Only tiles whose mask differs from that of the previous call are composited again.
  const ViewSums& weigh(const Exec& exec, const PixelMask& mask);

 private:
  struct State;
  /// Stores the mask; [tiles] 1: the tile's mask has changed.
  std::vector<std::uint8_t> update_mask(const PixelMask& mask);
  /// [V] 1: listed in one of `tiles`; in the order of the projected view.
  std::vector<std::uint8_t> in_tiles(const std::vector<std::uint8_t>& tiles) const;

  Camera camera_;
  std::unique_ptr<State> state_;
};

}  // namespace ngs
