#pragma once
// Smoothness of the field's colour by finite differences.                                    Eq. (18); D14
#include <cstdint>

#include "ngs/core/hd.h"
#include "ngs/math/vec.h"
#include "ngs/scene/views.h"

namespace ngs {

/// term = ‖c(to) - c(from)‖² of a pair and its gradients with respect to both colours. Owns row i.
template <class T>
struct SmoothnessForwardBackward {
  static constexpr const char* kName = "smoothness";
  Rows<const T, 3> colour, moved_colour;  // [N, 3]
  T scale;                                // ∂(total)/∂(Σ term)
  T* term;                                // [N] out
  Rows<T, 3> grad_colour, grad_moved;     // [N, 3] out, overwritten

  NGS_HD void operator()(std::int64_t i) const {
    const Vec3<T> d = vec3(moved_colour.row(i)) - vec3(colour.row(i));
    term[i] = dot(d, d);
    const Vec3<T> g = (T(2) * scale) * d;
    T* forward = grad_moved.row(i);
    T* back = grad_colour.row(i);
    forward[0] = g.x;
    forward[1] = g.y;
    forward[2] = g.z;
    back[0] = -g.x;
    back[1] = -g.y;
    back[2] = -g.z;
  }
};

}  // namespace ngs
