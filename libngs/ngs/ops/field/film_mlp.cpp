#include "ngs/ops/field/film_mlp.h"

#include <algorithm>
#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/core/rng.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/field/film_mlp_kernels.h"

namespace ngs {
namespace {

using Block = FilmMlpBlock<PackF>;

// Parameter gradients are summed in this many partial sums over fixed ranges of blocks, then in order: the rounding
// does not depend on the threads.
constexpr std::int64_t kPartialSums = 32;
// Blocks per task of the forward pass, to amortise its buffers.
constexpr std::int64_t kBlocksPerTask = 8;

std::int64_t block_count(std::int64_t queries) { return (queries + Block::kColumns - 1) / Block::kColumns; }

FilmMlpData<float> data_of(const float* params, const FilmMlpInputs& in, float density_scale) {
  FilmMlpData<float> data;
  data.params = params;
  data.input = in.feature;
  data.condition = in.condition;
  data.direction = in.direction;
  data.queries_per_direction = in.queries_per_direction;
  data.density_scale = density_scale;
  return data;
}

struct Initialiser {
  ParamStore& store;
  std::string prefix;
  std::uint64_t seed, next = 0;

  /// Appends a block with values from U(-bound, bound) + centre.
  std::size_t add(const std::string& name, std::vector<std::int64_t> shape, double bound, double centre = 0) {
    const std::size_t offset = store.add(prefix + "." + name, std::move(shape));
    for (std::size_t i = offset; i < store.values.size(); ++i)
      store.values[i] = float(centre + bound * (2 * rng_uniform(seed, RngStream::kMlpInit, next++) - 1));
    return offset;
  }
};

void check_config(const FilmMlpConfig& c) {
  NGS_CHECK(c.inputs >= 1 && c.condition >= 1, "the network needs inputs and a condition");
  NGS_CHECK(c.hidden >= 1 && c.hidden <= 128 && c.layers >= 1 && c.layers <= kMaxFilmLayers,
            "hidden in [1, 128], layers in [1, 4]");
  NGS_CHECK(c.direction_degree >= 0 && c.direction_degree <= 3, "direction_degree in [0, 3]");
}

}  // namespace

std::size_t add_film_mlp(ParamStore& store, const std::string& prefix, const FilmMlpConfig& c,
                         const FilmMlpInit& init) {
  check_config(c);
  constexpr double kModulation = 0.5;  // γ stays near 1 and β near 0 for conditions of order 1
  const double from_condition = kModulation / std::sqrt(double(c.condition)), from_hidden = std::sqrt(3.0 / c.hidden);
  Initialiser block{store, prefix, init.seed};
  const std::size_t begin = store.values.size();
  for (int l = 0; l < c.layers; ++l) {
    const std::string name = std::to_string(l) + ".";
    const int inputs = l == 0 ? c.inputs : c.hidden;
    block.add(name + "weight", {c.hidden, inputs}, std::sqrt(6.0 / inputs));
    block.add(name + "bias", {c.hidden}, 0);
    block.add(name + "gamma_weight", {c.hidden, c.condition}, from_condition);
    block.add(name + "gamma_bias", {c.hidden}, 0, 1);
    block.add(name + "beta_weight", {c.hidden, c.condition}, from_condition);
    block.add(name + "beta_bias", {c.hidden}, 0);
  }
  block.add("head_weight", {4, c.hidden}, from_hidden);
  const std::size_t head_bias = block.add("head_bias", {4}, 0);
  store.values[head_bias] = float(init.density_bias);
  const int direction = film_direction_inputs(c);
  block.add("direction_weight", {3, direction}, direction > 0 ? kModulation / std::sqrt(double(direction)) : 0);
  NGS_CHECK(store.values.size() - begin == film_mlp_layout(c).size, "blocks and layout disagree");
  return begin;
}

FilmMlp::FilmMlp(const FilmMlpConfig& config, std::size_t offset, double density_length)
    : config_(config), offset_(offset), density_scale_(float(1 / density_length)) {
  check_config(config);
  NGS_CHECK(density_length > 0, "density_length must be positive");
}

void FilmMlp::forward(const Exec& exec, const ParamStore& store, const FilmMlpInputs& in, FilmMlpOutput& out) const {
  const std::int64_t queries = in.feature.n, blocks = block_count(queries);
  NGS_CHECK(in.feature.c == config_.inputs && in.condition.c == config_.condition && in.condition.n == queries,
            "shapes of the network's inputs");
  out.density.resize(std::size_t(queries));
  out.rgb.resize(std::size_t(queries) * 3);
  out.context.resize(context_size(exec, queries));
  if (exec.device_ops)
    return exec.device_ops->field.film_forward({config_, store.values.data() + offset_, density_scale_}, in, out);
  FilmMlpData<float> data = data_of(store.values.data() + offset_, in, density_scale_);
  data.density = out.density.data();
  data.rgb = out.rgb.data();
  const std::size_t block_size = film_context_size<PackF>(config_);
  for_each_task(exec, (blocks + kBlocksPerTask - 1) / kBlocksPerTask, [&](std::int64_t task) {
    Block block(config_);
    const std::int64_t end = std::min(blocks, (task + 1) * kBlocksPerTask);
    for (std::int64_t b = task * kBlocksPerTask; b < end; ++b)
      block.forward(data, b, &out.context[std::size_t(b) * block_size]);
  });
}

std::size_t FilmMlp::context_size(const Exec& exec, std::int64_t queries) const {
  if (exec.device_ops) return std::size_t(exec.device_ops->field.film_context_size(config_, queries));
  return std::size_t(block_count(queries)) * film_context_size<PackF>(config_);
}

void FilmMlp::backward(const Exec& exec, ParamStore& store, const FilmMlpInputs& in, const FilmMlpOutputGradients& grad,
                       FilmMlpGradients& out) const {
  const std::int64_t queries = in.feature.n, blocks = block_count(queries);
  NGS_CHECK(std::int64_t(grad.density.size()) == queries && std::int64_t(grad.rgb.size()) == 3 * queries,
            "one gradient per output");
  const FilmCall call{config_, store.values.data() + offset_, density_scale_, store.grads.data() + offset_};
  out.feature.resize(std::size_t(queries * config_.inputs));
  out.condition.resize(std::size_t(queries * config_.condition));
  if (exec.device_ops) return exec.device_ops->field.film_backward(call, in, grad, out);
  const FilmMlpData<float> data = data_of(store.values.data() + offset_, in, density_scale_);
  const std::size_t block_size = film_context_size<PackF>(config_);
  const FilmMlpGrads<float> grads{grad.density.data(), grad.rgb.data(), out.feature.data(), out.condition.data()};
  const std::size_t params = film_mlp_layout(config_).size;
  std::vector<float> partial(std::size_t(kPartialSums) * params, 0.f);
  for_each_task(exec, kPartialSums, [&](std::int64_t sum) {
    const std::int64_t begin = sum * blocks / kPartialSums, end = (sum + 1) * blocks / kPartialSums;
    if (begin == end) return;
    Block block(config_);
    for (std::int64_t b = begin; b < end; ++b)
      block.backward(data, grads, b, &grad.forward.context[std::size_t(b) * block_size],
                     &partial[std::size_t(sum) * params]);
  });
  for_each_index(exec, std::int64_t(params), [&](std::int64_t i) {
    double total = 0;
    for (std::size_t sum = 0; sum < std::size_t(kPartialSums); ++sum)
      total += double(partial[sum * params + std::size_t(i)]);
    store.grads[offset_ + std::size_t(i)] += float(total);
  });
}

}  // namespace ngs
