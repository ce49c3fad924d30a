#pragma once
// One view of a cloud that does not change, drawn and weighed again and again: projected and sorted into tiles once.
#include <cstdint>
#include <memory>
#include <vector>

#include "ngs/ops/splat/splat.h"
#include "ngs/scene/view_prompt.h"

namespace ngs {

/// What a mask says of the Gaussians of a view, [V]; m_ij before Eq. (3), PAPER.md §5.2.
struct MaskSums {
  std::vector<double> weight;         // rendering weight over all pixels; 0: not seen
  std::vector<double> object_weight;  // of it inside the mask, at most `weight`
};

/// The cloud must outlive it, and its columns stay as they are. On the CPU. Takes about 90 bytes for every Gaussian
/// that may reach a pixel and 40 for every tile that one reaches.
class CachedView {
 public:
  CachedView(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& options);
  ~CachedView();
  CachedView(const CachedView&) = delete;
  CachedView& operator=(const CachedView&) = delete;

  const Camera& camera() const { return camera_; }
  /// [V] the Gaussians that may reach a pixel, increasing.
  const std::vector<std::uint32_t>& rows() const;

  /// As render(), to the bit. request.include is null.
  RenderedView render(const Exec& exec, const RenderRequest& request);

  /// As view_sums() of a view with this mask [H·W] and nothing unknown, to the bit, until the next call. Only tiles in
  /// which it differs from the mask of the call before are gone through.
  const MaskSums& weigh(const Exec& exec, const PixelMask& mask);

 private:
  struct State;
  /// [tiles] 1: to be gone through. Takes the mask.
  std::vector<std::uint8_t> take(const PixelMask& mask);
  /// [V] 1: in one of the tiles, in the order of the projected view.
  std::vector<std::uint8_t> in_tiles(const std::vector<std::uint8_t>& tiles) const;

  Camera camera_;
  std::unique_ptr<State> state_;
};

}  // namespace ngs
