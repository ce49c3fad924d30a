#pragma once
// Small matrix products over a block of lanes: one lane = one query, so a matrix of activations is [features, columns]
// with one column per query of the block. Templated on the scalar (math/lanes.h); the order of summation is fixed.
//
// Why not a library: a general GEMM blocks by the cache sizes of the machine, so rounding would depend on the machine.
// It also does not support dual numbers.
#include "ngs/math/lanes.h"

namespace ngs {

/// The queries of one block: kBlockPacks packs of lanes. A multiple of kTilePacks.
inline constexpr int kBlockPacks = 12;
inline constexpr int kTilePacks = 3, kTileRows = 4;
template <class L>
inline constexpr int kBlockColumns = kBlockPacks* LaneTraits<L>::kLanes;

/// Row-major weights [rows, cols] of scalars.
template <class S>
struct WeightMatrix {
  const S* data;
  int rows, cols;
};

namespace detail {

/// y[r][·] = bias[r] + Σ_k w[r][k] x[k][·] for R rows and one tile of columns.
template <class L, int R, class S = typename LaneTraits<L>::Scalar>
inline void product_tile(const S* w, int cols, const S* x, const S* bias, S* y) {
  constexpr int kLanes = LaneTraits<L>::kLanes, kColumns = kBlockColumns<L>;
  L sum[R][kTilePacks];
  for (int r = 0; r < R; ++r)
    for (int p = 0; p < kTilePacks; ++p) sum[r][p] = L(bias ? bias[r] : S(0));
  for (int k = 0; k < cols; ++k) {
    L in[kTilePacks];
    for (int p = 0; p < kTilePacks; ++p) load_lanes(x + k * kColumns + p * kLanes, in[p]);
    for (int r = 0; r < R; ++r) {
      const L weight(w[r * cols + k]);
      for (int p = 0; p < kTilePacks; ++p) sum[r][p] = fma_lanes(weight, in[p], sum[r][p]);
    }
  }
  for (int r = 0; r < R; ++r)
    for (int p = 0; p < kTilePacks; ++p) store_lanes(y + r * kColumns + p * kLanes, sum[r][p]);
}

/// g[r][c] += Σ_columns u[r][·] x[c][·] for R rows and C cols.
template <class L, int R, int C, class S = typename LaneTraits<L>::Scalar>
inline void outer_tile(const S* u, const S* x, S* g, int stride) {
  constexpr int kLanes = LaneTraits<L>::kLanes, kColumns = kBlockColumns<L>;
  L sum[R][C];
  for (int r = 0; r < R; ++r)
    for (int c = 0; c < C; ++c) sum[r][c] = L(S(0));
  for (int p = 0; p < kBlockPacks; ++p) {
    L right[C];
    for (int c = 0; c < C; ++c) load_lanes(x + c * kColumns + p * kLanes, right[c]);
    for (int r = 0; r < R; ++r) {
      L left;
      load_lanes(u + r * kColumns + p * kLanes, left);
      for (int c = 0; c < C; ++c) sum[r][c] = fma_lanes(left, right[c], sum[r][c]);
    }
  }
  for (int r = 0; r < R; ++r)
    for (int c = 0; c < C; ++c) g[r * stride + c] += sum_lanes(sum[r][c]);
}

template <class L, int R, class S = typename LaneTraits<L>::Scalar>
inline void outer_rows(const S* u, const S* x, S* g, int cols) {
  constexpr int kColumns = kBlockColumns<L>;
  int c = 0;
  for (; c + 3 <= cols; c += 3) outer_tile<L, R, 3>(u, x + c * kColumns, g + c, cols);
  for (; c < cols; ++c) outer_tile<L, R, 1>(u, x + c * kColumns, g + c, cols);
}

}  // namespace detail

/// y = bias + w x: y [rows, columns], x [cols, columns]; null bias: 0.
template <class L, class S = typename LaneTraits<L>::Scalar>
void lanes_product(WeightMatrix<S> w, const S* x, const S* bias, S* y) {
  constexpr int kStep = kTilePacks * LaneTraits<L>::kLanes, kColumns = kBlockColumns<L>;
  for (int column = 0; column < kColumns; column += kStep) {
    int r = 0;
    for (; r + kTileRows <= w.rows; r += kTileRows)
      detail::product_tile<L, kTileRows>(w.data + r * w.cols, w.cols, x + column, bias ? bias + r : nullptr,
                                         y + r * kColumns + column);
    for (; r < w.rows; ++r)
      detail::product_tile<L, 1>(w.data + r * w.cols, w.cols, x + column, bias ? bias + r : nullptr,
                                 y + r * kColumns + column);
  }
}

/// g += u xᵀ, g [rows, cols]: the weight gradient of lanes_product for ∂L/∂y = u.
template <class L, class S = typename LaneTraits<L>::Scalar>
void lanes_outer_accumulate(const S* u, int rows, const S* x, int cols, S* g) {
  int r = 0;
  for (; r + kTileRows <= rows; r += kTileRows)
    detail::outer_rows<L, kTileRows>(u + r * kBlockColumns<L>, x, g + r * cols, cols);
  for (; r < rows; ++r) detail::outer_rows<L, 1>(u + r * kBlockColumns<L>, x, g + r * cols, cols);
}

/// g[r] += Σ_columns u[r][·]: the bias gradient.
template <class L, class S = typename LaneTraits<L>::Scalar>
void lanes_row_sums_accumulate(const S* u, int rows, S* g) {
  constexpr int kLanes = LaneTraits<L>::kLanes;
  for (int r = 0; r < rows; ++r) {
    L sum(S(0)), in;
    for (int p = 0; p < kBlockPacks; ++p) {
      load_lanes(u + r * kBlockColumns<L> + p * kLanes, in);
      sum += in;
    }
    g[r] += sum_lanes(sum);
  }
}

}  // namespace ngs
