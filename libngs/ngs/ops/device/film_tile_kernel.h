#pragma once
// Building blocks of the FiLM network on a tile of queries in shared memory, for ops/device/film_forward_kernel.h and
// film_backward_kernel.h. Sums run in the order of ops/field/film_gemm_kernels.h. Hidden activations are therefore
// equal to the CPU's; only the output exponentials can differ. See Eqs. (12)-(15).
#include "ngs/backend/launcher.h"
#include "ngs/core/check.h"
#include "ngs/math/lane_scalar.h"
#include "ngs/math/sh.h"
#include "ngs/math/stable.h"
#include "ngs/ops/field/film_mlp_layout.h"
#include "ngs/scene/views.h"

namespace ngs {

inline constexpr int kMaxConditions = 4, kMaxDirections = 15;

/// The affine map from the condition to γ or β of a layer.
struct FilmModulation {
  const float *weight, *bias;
  int conditions;
};

NGS_HD inline std::int64_t film_context_rows(const FilmMlpConfig& c) { return std::int64_t(c.layers) * c.hidden + 4; }

/// Inputs and outputs of all queries: FilmMlpData on a device.
struct FilmOnDevice {
  FilmMlpConfig config;
  FilmMlpLayout at;
  int direction_inputs;
  const float* params;
  Matrix<const float> input, condition;
  Rows<const float, 3> direction;
  std::int64_t queries_per_direction;
  float density_scale;
  float* context;  // [tiles, layers · hidden + 4, tile of queries] h of every layer and the raw outputs

  NGS_HD std::int64_t context_rows() const { return film_context_rows(config); }
  NGS_HD int inputs(int layer) const { return layer == 0 ? config.inputs : config.hidden; }
  NGS_HD FilmModulation gamma(int layer) const {
    return {params + at.layer[layer].gamma_weight, params + at.layer[layer].gamma_bias, config.condition};
  }
  NGS_HD FilmModulation beta(int layer) const {
    return {params + at.layer[layer].beta_weight, params + at.layer[layer].beta_bias, config.condition};
  }
};

/// A block of 256 threads works on kQueries queries and up to kWidth features. A [features, queries] array is held in
/// registers: thread t has the features t / 16 + 16 i and the queries t % 16 + 16 j. Rows of shared arrays have an odd
/// length, so that neighbours in a row or column are in different banks.
template <int kWidth, int kQueries>
struct FilmTile {
  static constexpr int kThreads = 256, kStride = kQueries + 1;
  static constexpr int kRowsPerThread = kWidth / 16, kColumnsPerThread = kQueries / 16;
  using Cells = float[kRowsPerThread][kColumnsPerThread];
  using Plane = float[kWidth * kStride];
  using Conditions = float[kMaxConditions][kStride];

  /// cells = start[r] + Σ_k w[r][k] x[k][q] (transposed: w[k][r]) for r < rows; null start: 0.
  struct Product {
    const float* weight;
    int rows, depth, row_step, depth_step;
    const float* start;
  };
  NGS_HD static void product(int t, const Product& p, const Plane& x, Cells& cells) {
    for (int i = 0; i < kRowsPerThread; ++i)
      for (int j = 0; j < kColumnsPerThread; ++j) {
        const int r = t / 16 + 16 * i;
        cells[i][j] = p.start != nullptr && r < p.rows ? p.start[r] : 0.f;
      }
    for (int k = 0; k < p.depth; ++k) {
      float in[kColumnsPerThread];
      for (int j = 0; j < kColumnsPerThread; ++j) in[j] = x[k * kStride + t % 16 + 16 * j];
      for (int i = 0; i < kRowsPerThread; ++i) {
        const int r = t / 16 + 16 * i;
        if (r >= p.rows) continue;
        const float w = p.weight[r * p.row_step + k * p.depth_step];
        for (int j = 0; j < kColumnsPerThread; ++j) cells[i][j] = fma_lanes(w, in[j], cells[i][j]);
      }
    }
  }

  /// body(row, query, value) for the thread's cells below `rows`.
  template <class Body>
  NGS_HD static void each_cell(int t, int rows, Cells& cells, const Body& body) {
    for (int i = 0; i < kRowsPerThread; ++i)
      for (int j = 0; j < kColumnsPerThread; ++j) {
        const int r = t / 16 + 16 * i;
        if (r < rows) body(r, t % 16 + 16 * j, cells[i][j]);
      }
  }

  /// g[r][c] += Σ_q u[r][q] x[c][q]; g is in global memory and belongs to the block.
  struct Outer {
    static constexpr int kTile = 4;  // 64 rows by 64 columns of g at a time
    const Plane& u;
    const Plane& x;
    int rows, cols;
    float* g;
  };
  NGS_HD static void outer(int t, const Outer& o) {
    for (int r0 = 0; r0 < o.rows; r0 += 16 * Outer::kTile)
      for (int c0 = 0; c0 < o.cols; c0 += 16 * Outer::kTile) outer_tile(o, r0 + t / 16, c0 + t % 16);
  }

  /// γ or β of feature r: bias + Σ_k W[r][k] c[k].
  NGS_HD static float modulation(const FilmModulation& m, int r, int q, const Conditions& condition) {
    float sum = m.bias[r];
    for (int k = 0; k < m.conditions; ++k) sum = fma_lanes(m.weight[r * m.conditions + k], condition[k][q], sum);
    return sum;
  }
  NGS_HD static float relu(float x) { return x < 0.f ? 0.f : x; }  // keeps NaN

  /// Loads rows [first, first + kQueries) of `rows` as columns; zeros beyond the last row.
  NGS_HD static void load_rows(int t, const Matrix<const float>& rows, std::int64_t first, float* columns, int stride) {
    for (int i = t; i < rows.c * kQueries; i += kThreads) {
      const int q = i / rows.c, k = i % rows.c;
      columns[k * stride + q] = first + q < rows.n ? rows.row(first + q)[k] : 0.f;
    }
  }
  NGS_HD static void load_condition(int t, const FilmOnDevice& net, std::int64_t first, Conditions& condition) {
    load_rows(t, net.condition, first, &condition[0][0], kStride);
  }
  /// Basis functions of the query's direction; zeros beyond the last query.
  NGS_HD static void basis(const FilmOnDevice& net, std::int64_t query, float* out) {
    for (int i = 0; i < kMaxDirections; ++i) out[i] = 0.f;
    if (net.direction_inputs > 0 && query < net.input.n)
      sh_rest_basis(net.config.direction_degree, vec3(net.direction.row(query / net.queries_per_direction)), out);
  }

 private:
  /// The thread's part of a tile of g: rows r, r + 16, ... and columns c, c + 16, ...
  NGS_HD static void outer_tile(const Outer& o, int r, int c) {
    constexpr int kTile = Outer::kTile;
    float sum[kTile][kTile];
    for (int i = 0; i < kTile; ++i)
      for (int j = 0; j < kTile; ++j) sum[i][j] = 0.f;
    for (int q = 0; q < kQueries; ++q) {
      float left[kTile], right[kTile];
      for (int i = 0; i < kTile; ++i) {
        left[i] = r + 16 * i < o.rows ? o.u[(r + 16 * i) * kStride + q] : 0.f;
        right[i] = c + 16 * i < o.cols ? o.x[(c + 16 * i) * kStride + q] : 0.f;
      }
      for (int i = 0; i < kTile; ++i)
        for (int j = 0; j < kTile; ++j) sum[i][j] = fma_lanes(left[i], right[j], sum[i][j]);
    }
    for (int i = 0; i < kTile; ++i)
      for (int j = 0; j < kTile; ++j)
        if (r + 16 * i < o.rows && c + 16 * j < o.cols) o.g[(r + 16 * i) * o.cols + c + 16 * j] += sum[i][j];
  }
};

/// Calls body(width, queries) with the tile size that fits the network and 48 KiB of shared memory.
template <class Body>
void with_film_tile(const FilmMlpConfig& c, const Body& body) {
  NGS_CHECK(c.condition <= kMaxConditions, "the device path takes up to 4 conditions");
  const int width = max2(c.hidden, c.inputs);
  if (width <= 64) return body(std::integral_constant<int, 64>{}, std::integral_constant<int, 64>{});
  NGS_CHECK(width <= 128, "the device path takes up to 128 features");
  body(std::integral_constant<int, 128>{}, std::integral_constant<int, 32>{});
}

}  // namespace ngs
