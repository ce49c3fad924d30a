#pragma once
// The FiLM network backward on a device. Each of kParts blocks processes a fixed range of tiles and accumulates its own
// copy of the parameter gradient. The copies are then summed in order. Adjoint of Eqs. (12)-(15).
#include "ngs/ops/device/film_tile_kernel.h"

namespace ngs {

template <int kWidth, int kQueries>
struct FilmBackwardTiles {
  using Tile = FilmTile<kWidth, kQueries>;
  static constexpr const char* kName = "film_backward_tiles";
  static constexpr int kThreads = Tile::kThreads;
  static constexpr std::int64_t kParts = 128;
  FilmOnDevice net;
  const float* grad_density;  // [Q]
  const float* grad_rgb;      // [Q, 3]
  float* grad_input;          // [Q, inputs] out
  float* grad_condition;      // [Q, condition] out
  float* part;                // [kParts, parameters] added to

  struct Shared {
    typename Tile::Plane x;  // activations, then ∂L/∂γ
    typename Tile::Plane g;  // ∂L/∂x, then ∂L/∂β, then ∂L/∂h
    typename Tile::Conditions condition, grad_condition;
    float raw[4][Tile::kStride];  // ∂L/∂ of the raw outputs
    float basis[kMaxDirections][Tile::kStride];
  };
  struct Thread {
    typename Tile::Cells cells;
  };

  template <class Block>
  NGS_HD void operator()(Block& block) const {
    const std::int64_t tiles = ceil_div<std::int64_t>(net.input.n, kQueries);
    const std::int64_t begin = block.index * tiles / kParts, end = (block.index + 1) * tiles / kParts;
    float* const g = part + block.index * std::int64_t(net.at.size);
    for (std::int64_t tile = begin; tile < end; ++tile) {
      const float* const context = net.context + tile * net.context_rows() * kQueries;
      head(block, tile * kQueries, context, g);
      for (int l = net.config.layers - 1; l >= 0; --l) {
        modulation(block, l, context + std::int64_t(l) * net.config.hidden * kQueries, g);
        layer(block, l, tile * kQueries, context, g);
      }
      store(block, tile * kQueries);
    }
  }

 private:
  /// x = ReLU(γ_l h_l + β_l).
  NGS_HD void modulate(int t, int l, const float* context, Shared& shared) const {
    const float* h = context + std::int64_t(l) * net.config.hidden * kQueries;
    for (int i = t; i < net.config.hidden * kQueries; i += kThreads) {
      const int r = i / kQueries, q = i % kQueries;
      const float gamma = Tile::modulation(net.gamma(l), r, q, shared.condition);
      const float beta = Tile::modulation(net.beta(l), r, q, shared.condition);
      shared.x[r * Tile::kStride + q] = Tile::relu(fma_lanes(gamma, h[i], beta));
    }
  }

  template <class Block>
  NGS_HD void head(Block& block, std::int64_t first, const float* context, float* g) const {
    const float* raw = context + std::int64_t(net.config.layers) * net.config.hidden * kQueries;
    block.phase([&](int t, Shared& shared, Thread&) {
      Tile::load_condition(t, net, first, shared.condition);
      for (int q = t; q < kQueries; q += kThreads) start(q, first + q, raw, shared);
    });
    block.phase([&](int t, Shared& shared, Thread&) { modulate(t, net.config.layers - 1, context, shared); });
    block.phase([&](int t, Shared& shared, Thread&) {
      const int hidden = net.config.hidden, directions = net.direction_inputs;
      for (int i = t; i < 4 * (hidden + 1); i += kThreads) {
        const int r = i / (hidden + 1), c = i % (hidden + 1);
        float sum = 0.f;
        for (int q = 0; q < kQueries; ++q)
          sum = fma_lanes(shared.raw[r][q], c < hidden ? shared.x[c * Tile::kStride + q] : 1.f, sum);
        g[c < hidden ? net.at.head_weight + std::size_t(r * hidden + c) : net.at.head_bias + std::size_t(r)] += sum;
      }
      for (int i = t; i < 3 * directions; i += kThreads) {
        float sum = 0.f;
        for (int q = 0; q < kQueries; ++q)
          sum = fma_lanes(shared.raw[1 + i / directions][q], shared.basis[i % directions][q], sum);
        g[net.at.direction_weight + std::size_t(i)] += sum;
      }
      for (int i = t; i < hidden * kQueries; i += kThreads) {
        const int c = i / kQueries, q = i % kQueries;
        float sum = 0.f;
        for (int r = 0; r < 4; ++r)
          sum = fma_lanes(net.params[net.at.head_weight + std::size_t(r * hidden + c)], shared.raw[r][q], sum);
        shared.g[c * Tile::kStride + q] = sum;
      }
    });
  }

  /// ∂L/∂ of the query's raw outputs, and the initial values of its column; zeros beyond the last query.
  NGS_HD void start(int q, std::int64_t query, const float* raw, Shared& shared) const {
    const bool real = query < net.input.n;
    shared.raw[0][q] = real ? grad_density[query] * net.density_scale * sigmoid(raw[q]) : 0.f;
    for (int c = 0; c < 3; ++c)
      shared.raw[1 + c][q] = real ? grad_rgb[query * 3 + c] * sigmoid_slope(raw[(1 + c) * kQueries + q]) : 0.f;
    float basis[kMaxDirections];
    Tile::basis(net, query, basis);
    for (int k = 0; k < kMaxDirections; ++k) shared.basis[k][q] = basis[k];
    for (int k = 0; k < kMaxConditions; ++k) shared.grad_condition[k][q] = 0.f;
  }

  /// From ∂L/∂x_{l+1} in g, with x_{l+1} in x, to ∂L/∂h_l in g. Layer 0 includes the inner ReLU.
  template <class Block>
  NGS_HD void modulation(Block& block, int l, const float* h, float* g) const {
    const FilmMlpLayout::Layer layer = net.at.layer[l];
    const int hidden = net.config.hidden, conditions = net.config.condition;
    const float* p = net.params;
    block.phase([&](int t, Shared& shared, Thread&) {
      for (int i = t; i < hidden * kQueries; i += kThreads) {
        const int at = i / kQueries * Tile::kStride + i % kQueries;
        const float grad = shared.x[at] > 0.f ? shared.g[at] : 0.f;
        shared.x[at] = grad * h[i];
        shared.g[at] = grad;
      }
    });
    block.phase([&](int t, Shared& shared, Thread&) {
      const int columns = conditions + 1;  // the last one is the bias
      for (int i = t; i < 2 * hidden * columns; i += kThreads) {
        const bool is_gamma = i < hidden * columns;
        const int r = i / columns % hidden, k = i % columns;
        const typename Tile::Plane& u = is_gamma ? shared.x : shared.g;
        float sum = 0.f;
        for (int q = 0; q < kQueries; ++q)
          sum = fma_lanes(u[r * Tile::kStride + q], k < conditions ? shared.condition[k][q] : 1.f, sum);
        const std::size_t weight = is_gamma ? layer.gamma_weight : layer.beta_weight,
                          bias = is_gamma ? layer.gamma_bias : layer.beta_bias;
        g[k < conditions ? weight + std::size_t(r * conditions + k) : bias + std::size_t(r)] += sum;
      }
      for (int i = t; i < conditions * kQueries; i += kThreads) {
        const int k = i / kQueries, q = i % kQueries;
        float gamma = 0.f, beta = 0.f;
        for (int r = 0; r < hidden; ++r) {
          gamma = fma_lanes(p[layer.gamma_weight + std::size_t(r * conditions + k)], shared.x[r * Tile::kStride + q],
                            gamma);
          beta =
              fma_lanes(p[layer.beta_weight + std::size_t(r * conditions + k)], shared.g[r * Tile::kStride + q], beta);
        }
        shared.grad_condition[k][q] += gamma;
        shared.grad_condition[k][q] += beta;
      }
    });
    block.phase([&](int t, Shared& shared, Thread&) {
      for (int i = t; i < hidden * kQueries; i += kThreads) {
        const int r = i / kQueries, q = i % kQueries, at = r * Tile::kStride + q;
        const float through = shared.g[at] * Tile::modulation(net.gamma(l), r, q, shared.condition);
        shared.g[at] = l > 0 || h[i] > 0.f ? through : 0.f;
      }
    });
  }

  /// Backward pass of the layer's matrix product: the parameter gradient, and ∂L/∂x_l in g.
  template <class Block>
  NGS_HD void layer(Block& block, int l, std::int64_t first, const float* context, float* g) const {
    const FilmMlpLayout::Layer layer = net.at.layer[l];
    const int hidden = net.config.hidden, inputs = net.inputs(l);
    block.phase([&](int t, Shared& shared, Thread&) {
      if (l > 0)
        modulate(t, l - 1, context, shared);
      else
        Tile::load_rows(t, net.input, first, shared.x, Tile::kStride);
    });
    block.phase([&](int t, Shared& shared, Thread& own) {
      Tile::outer(t, {shared.g, shared.x, hidden, inputs, g + layer.weight});
      for (int r = t; r < hidden; r += kThreads) {
        float sum = 0.f;
        for (int q = 0; q < kQueries; ++q) sum += shared.g[r * Tile::kStride + q];
        g[layer.bias + std::size_t(r)] += sum;
      }
      Tile::product(t, {net.params + layer.weight, inputs, hidden, 1, inputs, nullptr}, shared.g, own.cells);
    });
    block.phase([&](int t, Shared& shared, Thread& own) {
      Tile::each_cell(t, inputs, own.cells,
                      [&](int r, int q, float value) { shared.g[r * Tile::kStride + q] = value; });
    });
  }

  template <class Block>
  NGS_HD void store(Block& block, std::int64_t first) const {
    block.phase([&](int t, Shared& shared, Thread&) {
      const int inputs = net.config.inputs, conditions = net.config.condition;
      for (int i = t; i < inputs * kQueries; i += kThreads)
        if (first + i / inputs < net.input.n)
          grad_input[first * inputs + i] = shared.g[i % inputs * Tile::kStride + i / inputs];
      for (int i = t; i < conditions * kQueries; i += kThreads)
        if (first + i / conditions < net.input.n)
          grad_condition[first * conditions + i] = shared.grad_condition[i % conditions][i / conditions];
    });
  }
};

/// total += Σ parts, in double and in order.
struct FilmPartSums {
  static constexpr const char* kName = "film_part_sums";
  const float* part;  // [parts, parameters]
  std::int64_t parts, parameters;
  float* total_accumulate;
  NGS_HD void operator()(std::int64_t i) const {
    double sum = 0;
    for (std::int64_t k = 0; k < parts; ++k) sum += double(part[k * parameters + i]);
    total_accumulate[i] += float(sum);
  }
};

/// ∂L/∂ of a network's outputs and inputs.
struct FilmGradientsOnDevice {
  const float *density, *rgb;  // [Q], [Q, 3]
  float *input, *condition;    // [Q, inputs], [Q, condition] out
};

/// `net` has the context of the forward pass. Adds to `params_accumulate`.
template <class Launcher>
void film_backward_on_device(Launcher& launcher, const FilmOnDevice& net, const FilmGradientsOnDevice& gradients,
                             float* params_accumulate) {
  const auto parameters = std::int64_t(net.at.size);
  with_film_tile(net.config, [&](auto width, auto queries) {
    using Kernel = FilmBackwardTiles<width, queries>;
    DeviceBuffer<Launcher, float> part(launcher, Kernel::kParts * parameters);
    part.zero();
    launcher.launch_blocks(Kernel::kParts, Kernel{net, gradients.density, gradients.rgb, gradients.input,
                                                  gradients.condition, part.data()});
    launcher.parallel_for(parameters, FilmPartSums{part.data(), Kernel::kParts, parameters, params_accumulate});
  });
}

}  // namespace ngs
