#pragma once
// The field's MLP: density and colour from hash features, modulated by interpolated features. Eqs. (12)-(15)
//
// Modulation (FiLM) acts at every hidden layer. Its scale starts at 1 (b_γ = 1), so with an untrained condition the
// network is a plain MLP (C21). Density is softplus in units of 1 / density_length. With a length of the scene, such as
// the RBF width, samples can become opaque in any unit of the scene. softplus grows linearly, so finite weights need no
// clamp.
// Results, parameter gradients included, do not depend on exec.threads.
#include "ngs/backend/exec.h"
#include "ngs/ops/field/field_types.h"
#include "ngs/ops/field/film_mlp_layout.h"
#include "ngs/scene/param_store.h"

namespace ngs {

struct FilmMlpInit {
  std::uint64_t seed = 0;
  double density_bias = -2;  // raw density before training: softplus(-2) = 0.13
};

/// Appends the network's blocks "PREFIX.0.weight", ... to the store and initialises them; returns the offset of the
/// first. Weights: He-uniform; modulation weights: small; biases: 0, except b_γ = 1 and density_bias.
std::size_t add_film_mlp(ParamStore& store, const std::string& prefix, const FilmMlpConfig& config,
                         const FilmMlpInit& init);

class FilmMlp {
 public:
  /// `offset`: returned by add_film_mlp. `density_length` > 0, world.
  FilmMlp(const FilmMlpConfig& config, std::size_t offset, double density_length);

  const FilmMlpConfig& config() const { return config_; }
  void forward(const Exec& exec, const ParamStore& store, const FilmMlpInputs& in, FilmMlpOutput& out) const;
  /// The size of FilmMlpOutput::context.
  std::size_t context_size(const Exec& exec, std::int64_t queries) const;
  /// Adds the parameters' gradients to store.grads; overwrites `out` with the inputs'.
  void backward(const Exec& exec, ParamStore& store, const FilmMlpInputs& in, const FilmMlpOutputGradients& grad,
                FilmMlpGradients& out) const;

 private:
  FilmMlpConfig config_;
  std::size_t offset_;
  float density_scale_;
};

}  // namespace ngs
