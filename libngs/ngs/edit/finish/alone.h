#pragma once
// The object rendered alone in the views of the scene, compared with its mask in the scene.
#include <vector>

#include "ngs/edit/finish/support_view.h"

namespace ngs::finish {

struct AloneViews {
  const std::vector<SupportView>& views;
  const SplatOptions& splat;  // of the scene, not prepared for a model
  double behind;              // as in SupportView::sides()
};

/// Pixels of all views where alpha of `object` alone is at least 1/2, but the scene does not show it, or the reverse.
/// [object] 0 in `keep`: left out.
std::int64_t wrong_pixels(const Exec& exec, const AloneViews& in, const GaussianCloud& object,
                          const std::vector<std::uint8_t>& keep);

/// Takes Gaussians from `keep` [object] that show the object, rendered alone, where the scene does not: outside of its
/// rendered mask and the soft edge of it, with more of their weight than within. Where other things stand in front
/// of the object alone, only if no view sees the Gaussian's centre (`seen` [object] 0), and with more than 10 times
/// that. Returns their number; 0 if `keep` would have more wrong_pixels().
std::int64_t drop_contradicted(const Exec& exec, const AloneViews& in, const GaussianCloud& object,
                               const std::vector<std::uint8_t>& seen, std::vector<std::uint8_t>& keep);

}  // namespace ngs::finish
