#pragma once
// The FiLM network forward on a device: a block evaluates all layers for a tile of queries.   Eqs. (12)-(15)
#include "ngs/ops/device/film_tile_kernel.h"

namespace ngs {

template <int kWidth, int kQueries>
struct FilmForwardTile {
  using Tile = FilmTile<kWidth, kQueries>;
  static constexpr const char* kName = "film_forward_tile";
  static constexpr int kThreads = Tile::kThreads;
  FilmOnDevice net;
  float* density;  // [Q]
  float* rgb;      // [Q, 3]

  struct Shared {
    typename Tile::Plane x;
    typename Tile::Conditions condition;
  };
  struct Thread {
    typename Tile::Cells cells;
  };

  template <class Block>
  NGS_HD void operator()(Block& block) const {
    const std::int64_t first = block.index * kQueries;
    float* const context = net.context + block.index * net.context_rows() * kQueries;
    block.phase([&](int t, Shared& shared, Thread&) {
      Tile::load_rows(t, net.input, first, shared.x, Tile::kStride);
      Tile::load_condition(t, net, first, shared.condition);
    });
    for (int l = 0; l < net.config.layers; ++l) {
      const FilmMlpLayout::Layer layer = net.at.layer[l];
      const float* p = net.params;
      float* const h = context + std::int64_t(l) * net.config.hidden * kQueries;
      block.phase([&](int t, Shared& shared, Thread& own) {
        const int inputs = net.inputs(l);
        Tile::product(t, {p + layer.weight, net.config.hidden, inputs, inputs, 1, p + layer.bias}, shared.x, own.cells);
      });
      block.phase([&](int t, Shared& shared, Thread& own) {
        Tile::each_cell(t, net.config.hidden, own.cells, [&](int r, int q, float value) {
          if (l == 0) value = Tile::relu(value);
          h[r * kQueries + q] = value;
          const float gamma = Tile::modulation(net.gamma(l), r, q, shared.condition);
          const float beta = Tile::modulation(net.beta(l), r, q, shared.condition);
          shared.x[r * Tile::kStride + q] = Tile::relu(fma_lanes(gamma, value, beta));
        });
      });
    }
    float* const raw = context + std::int64_t(net.config.layers) * net.config.hidden * kQueries;
    block.phase([&](int t, Shared& shared, Thread&) {
      for (int i = t; i < 4 * kQueries; i += kThreads) output(i / kQueries, i % kQueries, first, shared.x, raw);
    });
  }

 private:
  /// Output 0 is the density, 1 to 3 the colour.
  NGS_HD void output(int which, int q, std::int64_t first, const typename Tile::Plane& x, float* raw) const {
    const float* weight = net.params + net.at.head_weight + which * net.config.hidden;
    float sum = net.params[net.at.head_bias + std::size_t(which)];
    for (int k = 0; k < net.config.hidden; ++k) sum = fma_lanes(weight[k], x[k * Tile::kStride + q], sum);
    if (which > 0 && net.direction_inputs > 0) {
      float basis[kMaxDirections], turned = 0.f;
      Tile::basis(net, first + q, basis);
      const float* w = net.params + net.at.direction_weight + (which - 1) * net.direction_inputs;
      for (int k = 0; k < kMaxDirections; ++k)
        if (k < net.direction_inputs) turned = fma_lanes(w[k], basis[k], turned);
      sum += turned;
    }
    raw[which * kQueries + q] = sum;
    const std::int64_t query = first + q;
    if (query >= net.input.n) return;
    if (which == 0)
      density[query] = net.density_scale * softplus(sum);
    else
      rgb[query * 3 + which - 1] = sigmoid(sum);
  }
};

/// Values of the context that the backward pass needs.
inline std::int64_t device_film_context_size(const FilmMlpConfig& config, std::int64_t queries) {
  std::int64_t size = 0;
  with_film_tile(config, [&](auto, auto tile) {
    size = ceil_div<std::int64_t>(queries, tile) * film_context_rows(config) * tile;
  });
  return size;
}

/// Computes density, colour and context of all queries of `net`.
template <class Launcher>
void film_forward_on_device(Launcher& launcher, const FilmOnDevice& net, float* density, float* rgb) {
  with_film_tile(net.config, [&](auto width, auto queries) {
    launcher.launch_blocks(ceil_div<std::int64_t>(net.input.n, queries),
                           FilmForwardTile<width, queries>{net, density, rgb});
  });
}

}  // namespace ngs
