#include "ngs/field/joint_field.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/check.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/ops/optim/rows.h"
#include "ngs/problem/scene_measures.h"

namespace ngs {
namespace {

constexpr double kBoxWidths = 4;  // margin of the encoding's box about the query points, in kernel widths
constexpr int kFeatures = 3;      // length of f_j and f_inter; f_j starts as the colour of Gaussian j

HashGridConfig hash_config(const Exec& exec, const JointField::Setup& s, double width) {
  const FieldOptions& o = s.options;
  HashGridConfig config{o.hash_levels, kHashFeatures, o.hash_log2_table, kHashBase, std::max(kHashBase, o.hash_finest)};
  if (!s.parts.on("hash")) {
    config.levels = 1;
    config.max_resolution = config.base_resolution;
  }
  if (s.parts.on("fine-hash")) return config;
  const std::vector<HashLevel> levels = hash_levels(config);
  int kept = 1;
  while (kept < config.levels && encoding_cells(exec, s.reach, width, s.boundary.positions(),
                                                int(levels[std::size_t(kept)].resolution)) >= kFinestCell)
    ++kept;
  config.levels = kept;
  config.max_resolution = int(levels[std::size_t(kept - 1)].resolution);
  return config;
}

FieldShape shape_of(const Exec& exec, const JointField::Setup& s) {
  const FieldOptions& o = s.options;
  FieldShape shape;
  shape.width = rbf_width(exec, s.rbf, s.boundary.positions());
  shape.hash = hash_config(exec, s, shape.width);
  shape.box = hash_box(s.boundary.positions(), s.reach + kBoxWidths * shape.width);
  shape.hidden = o.mlp_hidden;
  shape.layers = o.mlp_layers;
  shape.film = s.parts.on("film");
  shape.neighbours = s.parts.on("rbf") ? s.rbf.neighbours : 1;
  shape.boundary = s.boundary.size();
  return shape;
}

FilmMlpConfig mlp_config(const FieldShape& s) {
  return {s.hash.outputs(), kFeatures, s.hidden, s.layers, kDirectionDegree};
}

}  // namespace

double encoding_cells(const Exec& exec, double reach, double width, Rows<const float, 3> boundary, int finest) {
  std::vector<float> nearest;
  for (const float d2 : nearest_others(exec, boundary, 1).dist2) nearest.push_back(std::sqrt(d2));
  const double inverse = double(hash_box(boundary, reach + kBoxWidths * width).inv_extent.x);
  return inverse > 0 ? cells_per_spacing(nearest, 1 / inverse, finest) : 0;
}

JointField::JointField(const FieldShape& shape, std::uint64_t seed, const Exec& exec)
    : shape_(shape),
      seed_(seed),
      hash_(shape.hash, shape.box, add_hash_grid(store_, "hash", shape.hash, seed)),
      mlp_(mlp_config(shape), add_film_mlp(store_, "film", mlp_config(shape), {.seed = seed}), shape.width),
      results_(exec) {
  feature_offset_ = store_.add("feature", {shape.boundary, kFeatures});
  moments_.resize(store_.blocks.size());
}

JointField::JointField(const Exec& exec, const Setup& s) : JointField(shape_of(exec, s), s.seed, exec) {
  smooth_points_ = s.options.smooth_points;
  smooth_step_ = s.options.smooth_step;
  recompute_neighbours_ = !s.parts.on("rbf");
  for (std::size_t i = 0; i < std::size_t(shape_.boundary) * kFeatures; ++i)
    store_.values[feature_offset_ + i] = std::clamp(s.boundary.colour[i], 0.f, 1.f);
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
          {store_.values.data() + feature_offset_, shape_.boundary, kFeatures},
          points.graph,
          shape_.width};
}

JointField::Points JointField::points_of(const FieldRays& rays, Rows<const float, 3> boundary) const {
  return {
      rays.rays.positions(), &rays.graph, {rays.rays.direction.data(), rays.rays.rays()}, rays.rays.samples, boundary};
}

void JointField::evaluate(const Exec& exec, const Points& points, Sampled& out) {
  const auto queries = std::size_t(points.position.n);
  results_.shape(out.rbf.weight, points.graph->index.size());
  results_.shape(out.rbf.feature, queries * kFeatures);
  results_.shape(out.encoding, queries * std::size_t(mlp_.config().inputs));
  results_.shape(out.network.density, queries);
  results_.shape(out.network.rgb, queries * 3);
  results_.shape(out.network.context, mlp_.context_size(exec, points.position.n));
  rbf_forward(exec, rbf_problem(points), out.rbf);
  if (!shape_.film) fill_zero(exec, out.rbf.feature);
  hash_.forward(exec, store_, points.position, out.encoding);
  mlp_.forward(exec, store_, out.inputs(points.direction, points.per_direction, mlp_.config()), out.network);
}

/// Adds the gradients of the network, the hash tables and the features.
void JointField::differentiate(const Exec& exec, const Points& points, const Sampled& at, const OutputGradients& grad) {
  auto& [inputs, to_feature] = input_grad_;
  results_.shape(inputs.feature, at.encoding.size());
  results_.shape(inputs.condition, at.rbf.feature.size());
  mlp_.backward(exec, store_, at.inputs(points.direction, points.per_direction, mlp_.config()),
                {at.network, grad.density, grad.rgb}, inputs);
  hash_.backward(exec, store_, points.position, inputs.feature);
  if (!shape_.film) return;
  results_.shape(to_feature, std::size_t(points.boundary.n) * kFeatures);
  rbf_backward(exec, rbf_problem(points), at.rbf, {inputs.condition.data(), points.position.n, kFeatures}, to_feature);
  for_each_row(exec, std::int64_t(to_feature.size()),
               AddValues{to_feature.data(), store_.grads.data() + feature_offset_});
}

VolumeInputs JointField::volume_inputs(const FieldRays& rays, Vec3<float> background) const {
  return {rays.rays.samples,
          sampled_.network.density.data(),
          sampled_.network.rgb.data(),
          rays.rays.spacing.data(),
          rays.rays.rays(),
          background};
}

const VolumeOutput& JointField::forward(const Exec& exec, const FieldRays& rays, Rows<const float, 3> boundary,
                                        Vec3<float> background) {
  evaluate(exec, points_of(rays, boundary), sampled_);
  const auto count = std::size_t(rays.rays.rays()), samples = count * std::size_t(rays.rays.samples);
  results_.shape(volume_.colour, count * 3);
  results_.shape(volume_.alpha, count);
  results_.shape(volume_.optical_depth, count);
  results_.shape(volume_.weight, samples);
  results_.shape(volume_.transmittance_after, samples);
  volume_forward(exec, volume_inputs(rays, background), volume_);
  return volume_;
}

void JointField::backward(const Exec& exec, const FieldRays& rays, Rows<const float, 3> boundary,
                          Vec3<float> background, const AlignFieldGradients& gradients) {
  VolumeGradients& sum = volume_grad_;
  results_.shape(sum.density, sampled_.network.density.size());
  results_.shape(sum.rgb, sampled_.network.rgb.size());
  volume_backward(exec, volume_inputs(rays, background), volume_, {gradients.colour, gradients.alpha, {}}, sum);
  differentiate(exec, points_of(rays, boundary), sampled_, {sum.density, sum.rgb});
}

double JointField::smoothness(const Exec& exec, const FieldRays& rays, Rows<const float, 3> boundary, double weight,
                              std::int64_t step) {
  const std::int64_t queries = rays.rays.positions().n, count = std::min<std::int64_t>(smooth_points_, queries);
  if (count == 0) return 0;
  SmoothPairs& s = smooth_;
  std::vector<float> position, direction;
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t q = i * queries / count, ray = q / rays.rays.samples;
    position.insert(position.end(), rays.rays.position.begin() + q * 3, rays.rays.position.begin() + q * 3 + 3);
    direction.insert(direction.end(), rays.rays.direction.begin() + ray * 3, rays.rays.direction.begin() + ray * 3 + 3);
  }
  SmoothnessPairs ends = smoothness_pairs(exec, {position.data(), count}, smooth_step_ * shape_.width,
                                          {seed_, std::uint64_t(step) * std::uint64_t(count)});
  results_.assign(s.direction, std::move(direction));
  results_.assign(s.position[0], std::move(ends.from));
  results_.assign(s.position[1], std::move(ends.to));
  const auto points = [&](int k) {
    return Points{{s.position[k].data(), count}, &s.graph[k], {s.direction.data(), count}, 1, boundary};
  };
  for (int k = 0; k < 2; ++k) {
    nearest_points(exec, boundary, points(k).position, shape_.neighbours, {s.graph[k], results_});
    evaluate(exec, points(k), s.at[k]);
  }
  for (std::vector<float>* grad : {&s.grad.colour, &s.grad.moved_colour}) results_.shape(*grad, std::size_t(count) * 3);
  const double loss = loss_smooth_backward(exec, {ends.length, shape_.width},
                                           {s.at[0].network.rgb, s.at[1].network.rgb}, weight, s.grad);
  results_.shape(s.no_density, std::size_t(count));
  fill_zero(exec, s.no_density);
  for (int k = 0; k < 2; ++k)
    differentiate(exec, points(k), s.at[k], {s.no_density, k == 0 ? s.grad.colour : s.grad.moved_colour});
  return loss;
}

AdamOptions JointField::adam_of(const ParamBlock& block) const {
  AdamOptions adam;
  const bool table = block.name.starts_with("hash"), feature = block.name == "feature";
  adam.lr = table ? kHashRate : feature ? kFeatureRate : kMlpRate;
  if (table) {
    adam.sparse_columns = hash_.config().features;
    adam.beta2 = 0.99;
  }
  return adam;
}

void JointField::add_to(Resident& resident) {
  resident.add(store_.values);
  resident.add(store_.grads);
  for (std::size_t b = 0; b < store_.blocks.size(); ++b)
    for (std::vector<float>* values : {&moments_[b].m, &moments_[b].v}) {
      values->resize(store_.blocks[b].size);
      resident.add(*values);
    }
}

void JointField::step(const Exec& exec, std::int64_t step, double decay) {
  std::vector<AdamGroup> groups;
  const auto step_groups = [&] {
    adam_step(exec, step, groups);
    groups.clear();
  };
  for (std::size_t b = 0; b < store_.blocks.size(); ++b) {
    const ParamBlock& block = store_.blocks[b];
    AdamOptions adam = adam_of(block);
    adam.lr *= decay;
    const std::span<float> grad = store_.grad_of(block);
    if (!grad.empty()) groups.push_back({adam, {block.name, store_.value_of(block), grad}, moments_[b]});
    if (groups.size() == AdamBlocks::kMax) step_groups();
  }
  step_groups();
  fill_zero(exec, store_.grads);
}

}  // namespace ngs
