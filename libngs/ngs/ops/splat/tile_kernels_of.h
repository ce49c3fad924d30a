#pragma once
// The kernel table of one lane type, specialised for the channel counts that the tools use.
#include "ngs/ops/splat/evidence_tile.h"
#include "ngs/ops/splat/splat_backward.h"

namespace ngs {

template <class L>
void forward_any(const ForwardTile<typename LaneTraits<L>::Scalar>& in) {
  switch (in.value.count) {
    case 1: return forward_tile<L, 1>(in);
    case 3: return forward_tile<L, 3>(in);
    case 4: return forward_tile<L, 4>(in);
    case 5: return forward_tile<L, 5>(in);
    default: return forward_tile<L, 0>(in);
  }
}

template <class L>
void backward_any(const BackwardTile<typename LaneTraits<L>::Scalar>& in) {
  switch (in.value.count) {
    case 1: return backward_tile<L, 1>(in);
    case 3: return backward_tile<L, 3>(in);
    case 4: return backward_tile<L, 4>(in);
    case 5: return backward_tile<L, 5>(in);
    default: return backward_tile<L, 0>(in);
  }
}

template <class L>
void evidence_any(const EvidenceTile<typename LaneTraits<L>::Scalar>& in) {
  if (has_uniform_targets<L>(in))
    return in.by_visibility ? evidence_of_uniform<L, true>(in) : evidence_of_uniform<L, false>(in);
  if (in.by_visibility) return evidence_tile<L, kAnyObjects, true>(in);
  if (in.objects == 1) return evidence_tile<L, 1>(in);
  if (in.objects == 3) return evidence_tile<L, 3>(in);  // rgb of a photo
  evidence_tile<L, kAnyObjects>(in);
}

template <class L>
TileKernels<typename LaneTraits<L>::Scalar> tile_kernels_of() {
  return {LaneTraits<L>::kLanes, record_tile<L>, forward_any<L>, backward_any<L>, evidence_any<L>};
}

}  // namespace ngs
