#pragma once
// Continuity of colour between neighbouring boundary Gaussians.                                    Eq. (17)
#include <cstdint>

#include "ngs/core/hd.h"
#include "ngs/math/vec.h"
#include "ngs/scene/views.h"

namespace ngs {

/// Inputs of forward and backward: the directed neighbour graph of B with one weight per edge.
template <class T>
struct ContinuityGraph {
  Matrix<const std::uint32_t> index;  // [B, K] neighbours of each
  const std::int64_t* row_begin;      // [B + 1] the transpose (KnnGraph)
  const std::int64_t* edge;           // [B·K]
  const T* weight;                    // [B, K] per edge; null: 1 / K
  Rows<const T, 3> colour;            // [B, 3]

  NGS_HD T edge_weight(std::int64_t e) const { return weight ? weight[e] : T(1) / T(index.c); }
};

/// term_i = Σ_j ω_ij ‖C_i - C_j‖². Owns row i.
template <class T>
struct ContinuityForward {
  static constexpr const char* kName = "continuity_forward";
  ContinuityGraph<T> graph;
  T* term;  // [B] out

  NGS_HD void operator()(std::int64_t i) const {
    T sum = T(0);
    const Vec3<T> here = vec3(graph.colour.row(i));
    for (int slot = 0; slot < graph.index.c; ++slot) {
      const Vec3<T> d = here - vec3(graph.colour.row(graph.index.row(i)[slot]));
      sum += graph.edge_weight(i * graph.index.c + slot) * dot(d, d);
    }
    term[i] = sum;
  }
};

/// ∂/∂C_i: i's own edges and those that point to it, both gathered. Owns row i.
template <class T>
struct ContinuityBackward {
  static constexpr const char* kName = "continuity_backward";
  ContinuityGraph<T> graph;
  T scale;                 // ∂(total)/∂(Σ term)
  Rows<T, 3> grad_colour;  // [B, 3] out, overwritten

  NGS_HD void operator()(std::int64_t i) const {
    Vec3<T> sum{T(0), T(0), T(0)};
    const Vec3<T> here = vec3(graph.colour.row(i));
    for (int slot = 0; slot < graph.index.c; ++slot)
      sum =
          sum + graph.edge_weight(i * graph.index.c + slot) * (here - vec3(graph.colour.row(graph.index.row(i)[slot])));
    for (std::int64_t at = graph.row_begin[i]; at < graph.row_begin[i + 1]; ++at) {
      const std::int64_t e = graph.edge[at];
      sum = sum + graph.edge_weight(e) * (here - vec3(graph.colour.row(e / graph.index.c)));
    }
    T* g = grad_colour.row(i);
    const T twice = T(2) * scale;
    g[0] = twice * sum.x;
    g[1] = twice * sum.y;
    g[2] = twice * sum.z;
  }
};

}  // namespace ngs
