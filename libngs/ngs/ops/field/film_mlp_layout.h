#pragma once
// Layout of the FiLM network's parameters in their flat vector. Only integers, so kernels may include it.
#include <cstddef>

namespace ngs {

inline constexpr int kMaxFilmLayers = 4;

/// Sizes of the network.
struct FilmMlpConfig {
  int inputs = 16;           // L·F of the hash encoding
  int condition = 3;         // F of f_inter
  int hidden = 64;           // 16..128
  int layers = 2;            // 1..4 hidden layers, each with its own modulation
  int direction_degree = 2;  // 0..3: SH bands of the view direction that reach the colour head; 0: none (C14)
};

/// Inputs of the view direction: the SH bands beyond the constant one, which the bias replaces.
constexpr int film_direction_inputs(const FilmMlpConfig& c) {
  return (c.direction_degree + 1) * (c.direction_degree + 1) - 1;
}

/// Offsets from the start of the network's parameters. Outputs of the head: density, r, g, b.
struct FilmMlpLayout {
  struct Layer {
    std::size_t weight, bias;              // [hidden, in], [hidden]; in = inputs for layer 0, else hidden
    std::size_t gamma_weight, gamma_bias;  // [hidden, condition], [hidden]
    std::size_t beta_weight, beta_bias;    // [hidden, condition], [hidden]
    int inputs;
  };
  Layer layer[kMaxFilmLayers];
  std::size_t head_weight, head_bias;  // [4, hidden], [4]
  std::size_t direction_weight;        // [3, direction inputs]
  std::size_t size;
};

constexpr FilmMlpLayout film_mlp_layout(const FilmMlpConfig& c) {
  FilmMlpLayout at{};
  std::size_t next = 0;
  const auto take = [&next](int rows, int cols) {
    const std::size_t begin = next;
    next += std::size_t(rows) * std::size_t(cols);
    return begin;
  };
  for (int l = 0; l < c.layers; ++l) {
    FilmMlpLayout::Layer& layer = at.layer[l];
    layer.inputs = l == 0 ? c.inputs : c.hidden;
    layer.weight = take(c.hidden, layer.inputs);
    layer.bias = take(c.hidden, 1);
    layer.gamma_weight = take(c.hidden, c.condition);
    layer.gamma_bias = take(c.hidden, 1);
    layer.beta_weight = take(c.hidden, c.condition);
    layer.beta_bias = take(c.hidden, 1);
  }
  at.head_weight = take(4, c.hidden);
  at.head_bias = take(4, 1);
  at.direction_weight = take(3, film_direction_inputs(c));
  at.size = next;
  return at;
}

}  // namespace ngs
