#include "ngs/passes/joint/joint_field.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/check.h"
#include "ngs/ops/field/knn.h"
#include "ngs/ops/losses/loss_smooth.h"
#include "ngs/passes/detectors.h"

namespace ngs {
namespace {

constexpr double kBoxWidths = 4;  // kernel widths that the encoding's box is larger than what is asked of it

HashGridConfig hash_config(const Exec& exec, const JointField::Setup& s, double width) {
  const JointOptions& o = s.options;
  HashGridConfig config{
      o.hash_levels,    o.hash_features, o.hash_log2_table, o.hash_base, std::max(o.hash_base, o.hash_finest),
      o.hash_smoothstep};
  if (!s.effects.hash) config.levels = 1, config.max_resolution = config.base_resolution;
  if (s.effects.fine_hash) return config;
  const std::vector<HashLevel> levels = hash_levels(config);
  int kept = 1;
  while (kept < config.levels && encoding_cells(exec, s.reach, width, s.boundary.positions(),
                                                int(levels[std::size_t(kept)].resolution)) >= kFinestCell)
    ++kept;
  config.levels = kept, config.max_resolution = int(levels[std::size_t(kept - 1)].resolution);
  return config;
}

FieldShape shape_of(const Exec& exec, const JointField::Setup& s) {
  const JointOptions& o = s.options;
  FieldShape shape;
  shape.width = rbf_width(exec, s.rbf, s.boundary.positions());
  shape.hash = hash_config(exec, s, shape.width);
  shape.box = hash_box(s.boundary.positions(), s.reach + kBoxWidths * shape.width);
  shape.hidden = o.mlp_hidden, shape.layers = o.mlp_layers, shape.direction_degree = o.direction_degree;
  shape.features = o.feature_values, shape.film = s.effects.film, shape.concatenate = o.concatenate;
  shape.objects = o.field_masks ? s.objects : 0;
  shape.neighbours = s.effects.rbf ? s.rbf.neighbours : 1;
  shape.boundary = s.boundary.size();
  return shape;
}

FilmMlpConfig mlp_config(const FieldShape& s, int direction_degree) {
  return {s.hash.outputs() + (s.concatenate ? s.features : 0), s.features, s.hidden, s.layers, direction_degree};
}

/// ∂L/∂Δ [R]: rendering knows a density by σ Δ alone.                                            adjoint of Eq. (1)
std::vector<float> spacing_gradient(const RayQueries& rays, const std::vector<float>& density,
                                    const std::vector<float>& to_density) {
  std::vector<float> out(rays.spacing.size(), 0.f);
  const auto samples = std::size_t(rays.samples);
  for (std::size_t r = 0; r < out.size(); ++r) {
    double sum = 0;
    for (std::size_t q = r * samples; q < (r + 1) * samples; ++q) sum += double(to_density[q]) * double(density[q]);
    out[r] = float(sum / double(rays.spacing[r]));
  }
  return out;
}

// A head is a network with three outputs in (0, 1), of which an object takes one.
constexpr int kHeadObjects = 3;

}  // namespace

double encoding_cells(const Exec& exec, double reach, double width, Rows<const float, 3> boundary, int finest) {
  std::vector<float> nearest;
  for (const float d2 : nearest_others(exec, boundary, 1).dist2) nearest.push_back(std::sqrt(d2));
  const double inverse = double(hash_box(boundary, reach + kBoxWidths * width).inv_extent.x);
  return inverse > 0 ? cells_per_spacing(nearest, 1 / inverse, finest) : 0;
}

JointField::JointField(const FieldShape& shape, const FieldOptions& rates, std::uint64_t seed)
    : rates_(rates),
      shape_(shape),
      seed_(seed),
      hash_(shape.hash, shape.box, add_hash_grid(store_, "hash", shape.hash, seed)),
      mlp_(mlp_config(shape, shape.direction_degree),
           add_film_mlp(store_, "film", mlp_config(shape, shape.direction_degree), {.seed = seed}), shape.width) {
  feature_offset_ = store_.add("feature", {shape.boundary, shape.features});
  const FilmMlpConfig head = mlp_config(shape, 0);
  for (int first = 0; first < shape.objects; first += kHeadObjects) {
    const std::string name = "object." + std::to_string(first / kHeadObjects);
    const std::size_t at = add_film_mlp(store_, name, head, {.seed = seed + 1 + std::uint64_t(first)});
    heads_.emplace_back(head, at, shape.width);
  }
  head_volume_.resize(heads_.size());
  moments_.resize(store_.blocks.size());
}

JointField::JointField(const Exec& exec, const Setup& s) : JointField(shape_of(exec, s), s.options, s.seed) {
  smooth_points_ = s.options.smooth_points, smooth_step_ = s.options.smooth_step, smooth_form_ = s.options.smooth_form;
  rate_literal_ = s.options.rate_literal;
  sample_ = s.sample;
  own_neighbours_ = !s.effects.rbf;
  if (s.options.field_positions) want_position_gradient();
  if (s.options.field_depth) want_query_gradient();
  const auto features = std::size_t(shape_.features);
  for (std::size_t b = 0; b < std::size_t(shape_.boundary); ++b)  // beyond the colour: zero, moved by the gradient
    for (std::size_t f = 0; f < 3; ++f)
      store_.values[feature_offset_ + b * features + f] = std::clamp(s.boundary.colour[b * 3 + f], 0.f, 1.f);
}

FilmMlpInputs JointField::Sampled::inputs(Rows<const float, 3> direction, std::int64_t per_direction,
                                          const FilmMlpConfig& config) const {
  const auto queries = std::int64_t(encoding.size()) / config.inputs;
  return {{encoding.data(), queries, config.inputs},
          {rbf.feature.data(), queries, config.condition},
          direction,
          per_direction};
}

RbfProblem JointField::rbf_problem(const Points& points) const {
  return {points.position,
          points.boundary,
          {store_.values.data() + feature_offset_, shape_.boundary, shape_.features},
          points.graph,
          shape_.width};
}

JointField::Points JointField::points_of(const FieldRays& rays, Rows<const float, 3> boundary) const {
  return {
      rays.rays.positions(), &rays.graph, {rays.rays.direction.data(), rays.rays.rays()}, rays.rays.samples, boundary};
}

/// f_inter behind every row of f_hash.
void JointField::concatenate(Sampled& out) const {
  const auto hash = std::size_t(shape_.hash.outputs()), features = std::size_t(shape_.features);
  const std::size_t queries = out.encoding.size() / hash;
  std::vector<float> rows(queries * (hash + features));
  for (std::size_t q = 0; q < queries; ++q) {
    float* row = &rows[q * (hash + features)];
    std::copy_n(&out.encoding[q * hash], hash, row);
    std::copy_n(&out.rbf.feature[q * features], features, row + hash);
  }
  out.encoding = std::move(rows);
}

void JointField::evaluate(const Exec& exec, const Points& points, Sampled& out) const {
  rbf_forward(exec, rbf_problem(points), out.rbf);
  if (!shape_.film) std::fill(out.rbf.feature.begin(), out.rbf.feature.end(), 0.f);
  hash_.forward(exec, store_, points.position, out.encoding);
  if (shape_.concatenate && points.position.n > 0) concatenate(out);
  mlp_.forward(exec, store_, out.inputs(points.direction, points.per_direction, mlp_.config()), out.network);
  out.heads.resize(heads_.size());
  for (std::size_t h = 0; h < heads_.size(); ++h)
    heads_[h].forward(exec, store_, out.inputs({}, 1, heads_[h].config()), out.heads[h]);
}

void JointField::differentiate(const Exec& exec, const Points& points, const Sampled& at, const OutputGradients& grad,
                               std::vector<float>* to_points) {
  FilmMlpGradients inputs =
      mlp_.backward(exec, store_, at.inputs(points.direction, points.per_direction, mlp_.config()), at.network,
                    {grad.density, grad.rgb});
  const std::vector<float> no_density(grad.object.empty() ? 0 : grad.density.size(), 0.f);
  for (std::size_t h = 0; h < grad.object.size(); ++h) {
    const FilmMlpGradients more = heads_[h].backward(exec, store_, at.inputs({}, 1, heads_[h].config()), at.heads[h],
                                                     {no_density, grad.object[h]});
    for (std::size_t i = 0; i < more.feature.size(); ++i) inputs.feature[i] += more.feature[i];
    for (std::size_t i = 0; i < more.condition.size(); ++i) inputs.condition[i] += more.condition[i];
  }
  differentiate_inputs(exec, points, at, std::move(inputs), to_points);
}

/// From the network's inputs to the tables, the features, the boundary's positions and the points.
void JointField::differentiate_inputs(const Exec& exec, const Points& points, const Sampled& at,
                                      FilmMlpGradients inputs, std::vector<float>* to_points) {
  const auto hash = std::size_t(shape_.hash.outputs()), features = std::size_t(shape_.features);
  const auto queries = std::size_t(points.position.n);
  if (shape_.concatenate) {
    std::vector<float> encoding(queries * hash);
    for (std::size_t q = 0; q < queries; ++q) {
      const float* row = &inputs.feature[q * (hash + features)];
      std::copy_n(row, hash, &encoding[q * hash]);
      for (std::size_t f = 0; f < features; ++f) inputs.condition[q * features + f] += row[hash + f];
    }
    inputs.feature = std::move(encoding);
  }
  hash_.backward(exec, store_, points.position, inputs.feature);
  if (to_points != nullptr) hash_.backward_points(exec, store_, points.position, inputs.feature, *to_points);
  if (!shape_.film) return;
  const Matrix<const float> to_feature{inputs.condition.data(), points.position.n, shape_.features};
  const RbfGradients out = rbf_backward(exec, rbf_problem(points), at.rbf, to_feature, !position_grad_.empty());
  for (std::size_t i = 0; i < out.feature.size(); ++i) store_.grads[feature_offset_ + i] += out.feature[i];
  for (std::size_t i = 0; i < out.boundary.size(); ++i) position_grad_[i] += out.boundary[i];
  if (to_points == nullptr) return;
  const std::vector<float> through_weights = rbf_backward_queries(exec, rbf_problem(points), at.rbf, to_feature);
  for (std::size_t i = 0; i < through_weights.size(); ++i) (*to_points)[i] += through_weights[i];
}

VolumeInputs JointField::volume_inputs(const FieldRays& rays, const std::vector<float>& rgb,
                                       Vec3<float> background) const {
  return {rays.rays.samples, sampled_.network.density.data(), rgb.data(), rays.rays.spacing.data(), rays.rays.rays(),
          background};
}

const VolumeOutput& JointField::forward(const Exec& exec, const FieldRays& rays, Rows<const float, 3> boundary,
                                        Vec3<float> background) {
  query_grad_ = {};
  evaluate(exec, points_of(rays, boundary), sampled_);
  volume_forward(exec, volume_inputs(rays, sampled_.network.rgb, background), volume_);
  const auto objects = std::size_t(shape_.objects);
  mask_.resize(std::size_t(rays.rays.rays()) * objects);
  for (std::size_t h = 0; h < heads_.size(); ++h) {
    volume_forward(exec, volume_inputs(rays, sampled_.heads[h].rgb, {0, 0, 0}), head_volume_[h]);
    for (std::size_t k = h * kHeadObjects; k < std::min(objects, (h + 1) * kHeadObjects); ++k)
      for (std::size_t r = 0; r < mask_.size() / objects; ++r)
        mask_[r * objects + k] = head_volume_[h].colour[r * 3 + k % kHeadObjects];
  }
  return volume_;
}

void JointField::backward(const Exec& exec, const FieldRays& rays, Rows<const float, 3> boundary,
                          Vec3<float> background, const FieldGradients& gradients) {
  VolumeGradients sum;
  volume_backward(exec, volume_inputs(rays, sampled_.network.rgb, background), volume_,
                  {gradients.align.colour, gradients.align.alpha, {}}, sum);
  std::vector<std::vector<float>> object;
  const auto objects = std::size_t(shape_.objects);
  const std::size_t count = gradients.mask.empty() ? 0 : std::size_t(rays.rays.rays());
  const std::vector<float> no_alpha(count, 0.f);
  for (std::size_t h = 0; count > 0 && h < heads_.size(); ++h) {
    std::vector<float> colour(count * 3, 0.f);
    for (std::size_t k = h * kHeadObjects; k < std::min(objects, (h + 1) * kHeadObjects); ++k)
      for (std::size_t r = 0; r < count; ++r) colour[r * 3 + k % kHeadObjects] = gradients.mask[r * objects + k];
    VolumeGradients of_head;
    volume_backward(exec, volume_inputs(rays, sampled_.heads[h].rgb, {0, 0, 0}), head_volume_[h],
                    {colour, no_alpha, {}}, of_head);
    for (std::size_t i = 0; i < sum.density.size(); ++i) sum.density[i] += of_head.density[i];
    object.push_back(std::move(of_head.rgb));
  }
  differentiate(exec, points_of(rays, boundary), sampled_, {sum.density, sum.rgb, object},
                wants_queries_ ? &query_grad_.position : nullptr);
  if (wants_queries_) query_grad_.spacing = spacing_gradient(rays.rays, sampled_.network.density, sum.density);
}

double JointField::smoothness(const Exec& exec, const FieldRays& rays, Rows<const float, 3> boundary, double weight,
                              std::int64_t step) {
  const std::int64_t queries = rays.rays.positions().n, count = std::min<std::int64_t>(smooth_points_, queries);
  if (count == 0) return 0;
  const std::int64_t per_point = pairs_per_point(smooth_form_), pairs = count * per_point;
  std::vector<float> position, direction;
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t q = i * queries / count, ray = q / rays.rays.samples;
    position.insert(position.end(), rays.rays.position.begin() + q * 3, rays.rays.position.begin() + q * 3 + 3);
    direction.insert(direction.end(), rays.rays.direction.begin() + ray * 3, rays.rays.direction.begin() + ray * 3 + 3);
  }
  const SmoothnessPairs ends =
      smoothness_pairs(exec, smooth_form_, {position.data(), count}, smooth_step_ * shape_.width,
                       {seed_, std::uint64_t(step) * std::uint64_t(count)});
  const std::vector<float>* sets[2] = {&ends.from, &ends.to};
  KnnGraph graph[2];
  Sampled at[2];
  const auto points = [&](int k) {
    return Points{{sets[k]->data(), pairs}, &graph[k], {direction.data(), count}, per_point, boundary};
  };
  for (int k = 0; k < 2; ++k) {
    graph[k] = nearest_points(exec, boundary, {sets[k]->data(), pairs}, shape_.neighbours);
    build_transpose(graph[k]);
    evaluate(exec, points(k), at[k]);
  }
  SmoothnessGradients gradients;
  const double loss = loss_smooth_backward(exec, {ends.length, shape_.width}, {at[0].network.rgb, at[1].network.rgb},
                                           weight, gradients);
  const std::vector<float> no_density(std::size_t(pairs), 0.f);
  const std::vector<float>* grad[2] = {&gradients.colour, &gradients.moved_colour};
  for (int k = 0; k < 2; ++k) differentiate(exec, points(k), at[k], {no_density, *grad[k], {}});
  return loss;
}

AdamOptions JointField::adam_of(const ParamBlock& block) const {
  AdamOptions adam;
  const bool table = block.name.starts_with("hash"), feature = block.name == "feature";
  adam.lr = rate_literal_ ? kLiteralRate : table ? rates_.rate_hash : feature ? rates_.rate_feature : rates_.rate_mlp;
  if (table) adam.sparse_columns = hash_.config().features, adam.beta2 = 0.99;
  return adam;
}

void JointField::step(const Exec& exec, std::int64_t step, double decay) {
  for (std::size_t b = 0; b < store_.blocks.size(); ++b) {
    const ParamBlock& block = store_.blocks[b];
    AdamOptions adam = adam_of(block);
    adam.lr *= decay;
    const std::span<float> grad = store_.grad_of(block);
    if (!grad.empty()) adam_step(exec, adam, step, {block.name, store_.value_of(block), grad}, moments_[b]);
  }
  store_.zero_grads();
  std::fill(position_grad_.begin(), position_grad_.end(), 0.f);
}

}  // namespace ngs
