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
      o.hash_levels, o.hash_features, o.hash_log2_table, o.hash_base, std::max(o.hash_base, o.hash_finest), false};
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

FilmMlpConfig mlp_config(const JointOptions& o, const HashGridConfig& hash) {
  return {hash.outputs(), 3, o.mlp_hidden, o.mlp_layers, o.direction_degree};
}

/// The lattice that `uv` [R, 2] samples row by row.
PixelGrid lattice(const std::vector<float>& uv, const QueryView& view) {
  PixelGrid grid;
  grid.rows = view.rows, grid.cols = view.cols;
  grid.first_x = uv[0], grid.first_y = uv[1];
  if (view.cols > 1) grid.step_x = (double(uv[std::size_t(view.cols - 1) * 2]) - grid.first_x) / (view.cols - 1);
  if (view.rows > 1) grid.step_y = (double(uv.back()) - grid.first_y) / (view.rows - 1);
  grid.beyond_x = grid.first_x - view.box.min_x, grid.beyond_y = grid.first_y - view.box.min_y;
  return grid;
}

}  // namespace

double field_reach(const SampleOptions& sample, const GaussianCloud& cloud, const std::vector<Camera>& cameras,
                   const BoundarySet& boundary) {
  double reach = 0;
  for (const Camera& camera : cameras)
    reach = std::max(
        reach,
        sample.depth_span *
            boundary_box(relative_to(camera, cloud.origin), boundary.positions(), sample.bbox_pad_px).mean_distance);
  return reach;
}

double encoding_cells(const Exec& exec, double reach, double width, Rows<const float, 3> boundary, int finest) {
  std::vector<float> nearest;
  for (const float d2 : nearest_others(exec, boundary, 1).dist2) nearest.push_back(std::sqrt(d2));
  const double inverse = double(hash_box(boundary, reach + kBoxWidths * width).inv_extent.x);
  return inverse > 0 ? cells_per_spacing(nearest, 1 / inverse, finest) : 0;
}

JointField::JointField(const Exec& exec, const Setup& s)
    : options_(s.options),
      effects_(s.effects),
      sample_(s.sample),
      neighbours_(s.effects.rbf ? s.rbf.neighbours : 1),
      width_(rbf_width(exec, s.rbf, s.boundary.positions())),
      boundary_count_(s.boundary.size()),
      seed_(s.seed),
      hash_config_(hash_config(exec, s, width_)),
      hash_(hash_config_, hash_box(s.boundary.positions(), s.reach + kBoxWidths * width_),
            add_hash_grid(store_, "hash", hash_config_, s.seed)),
      mlp_(mlp_config(options_, hash_.config()),
           add_film_mlp(store_, "film", mlp_config(options_, hash_.config()), {.seed = s.seed}), width_) {
  feature_offset_ = store_.add("feature", {boundary_count_, 3});
  for (std::size_t i = 0; i < s.boundary.colour.size(); ++i)
    store_.values[feature_offset_ + i] = std::clamp(s.boundary.colour[i], 0.f, 1.f);
  moments_.resize(store_.blocks.size());
}

FieldRays JointField::rays(const Exec& exec, const Camera& camera, Rows<const float, 3> boundary,
                           const DepthMap& map) const {
  FieldRays out;
  out.rays = sample_view(exec, sample_, camera, boundary, map).rays;
  if (out.rays.rays() == 0) return out;
  out.graph = nearest_points(exec, boundary, out.rays.positions(), neighbours_);
  build_transpose(out.graph);
  return out;
}

FieldRays JointField::rays(const Exec& exec, const Camera& camera, const QueryField& field, std::size_t view,
                           const BoundarySet& boundary) const {
  FieldRays out;
  const QueryView& grid = field.views[view];
  const auto begin =
      std::size_t(std::lower_bound(field.view.begin(), field.view.end(), std::int32_t(view)) - field.view.begin());
  const auto end =
      std::size_t(std::upper_bound(field.view.begin(), field.view.end(), std::int32_t(view)) - field.view.begin());
  const auto samples = std::size_t(grid.depth_samples);
  if (begin == end) return out;
  if (end - begin != std::size_t(grid.rows) * std::size_t(grid.cols) * samples)
    throw Error(ErrorCode::kBadInput,
                "view '" + grid.name + "' of the field: " + std::to_string(end - begin) +
                    " queries, expected the whole grid of " +
                    std::to_string(std::size_t(grid.rows) * std::size_t(grid.cols) * samples),
                "sample again: ngs-sample scene.json boundary.ply -o queries.ply");
  RayQueries& rays = out.rays;
  rays.samples = grid.depth_samples;
  rays.position.assign(field.position.begin() + std::ptrdiff_t(begin * 3),
                       field.position.begin() + std::ptrdiff_t(end * 3));
  rays.depth.assign(field.depth.begin() + std::ptrdiff_t(begin), field.depth.begin() + std::ptrdiff_t(end));
  for (std::size_t q = begin; q < end; q += samples) {
    const double u = field.uv[q * 2], v = field.uv[q * 2 + 1];
    const Vec3<double> d =
        transpose(camera.rotation) * Vec3<double>{(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0};
    const double length = std::sqrt(dot(d, d));
    const double first = field.depth[q], last = field.depth[q + samples - 1];
    const double half = samples > 1 ? (last - first) / 2 : std::max(field.depth_span * first, field.depth_epsilon);
    rays.pixel.insert(rays.pixel.end(), {float(u), float(v)});
    rays.direction.insert(rays.direction.end(), {float(d.x / length), float(d.y / length), float(d.z / length)});
    rays.near.push_back(float(samples > 1 ? first : first - half)),
        rays.far.push_back(float(samples > 1 ? last : first + half));
    rays.spacing.push_back(float(2 * half / double(std::max<std::size_t>(samples - 1, 1))));
  }
  rays.grid = lattice(rays.pixel, grid);
  if (!effects_.rbf || field.neighbours == 0) {
    out.graph = nearest_points(exec, boundary.positions(), rays.positions(), neighbours_);
  } else {
    out.graph.neighbours = field.neighbours;
    out.graph.points = boundary.size();
    const auto k = std::size_t(field.neighbours);
    for (std::size_t i = begin * k; i < end * k; ++i) {
      const auto row = std::lower_bound(boundary.row.begin(), boundary.row.end(), field.neighbour[i]);
      if (row == boundary.row.end() || *row != field.neighbour[i])
        throw Error(ErrorCode::kInconsistent,
                    "the field names Gaussian " + std::to_string(field.neighbour[i]) +
                        " as a neighbour, which is not in the boundary set",
                    "interpolate again: ngs-rbf boundary.ply queries.ply -o field.ply");
      out.graph.index.push_back(std::uint32_t(row - boundary.row.begin()));
    }
  }
  build_transpose(out.graph);
  return out;
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
          {store_.values.data() + feature_offset_, boundary_count_, 3},
          points.graph,
          width_};
}

JointField::Points JointField::points_of(const FieldRays& rays, Rows<const float, 3> boundary) const {
  return {
      rays.rays.positions(), &rays.graph, {rays.rays.direction.data(), rays.rays.rays()}, rays.rays.samples, boundary};
}

void JointField::evaluate(const Exec& exec, const Points& points, Sampled& out) const {
  rbf_forward(exec, rbf_problem(points), out.rbf);
  if (!effects_.film) std::fill(out.rbf.feature.begin(), out.rbf.feature.end(), 0.f);
  hash_.forward(exec, store_, points.position, out.encoding);
  mlp_.forward(exec, store_, out.inputs(points.direction, points.per_direction, mlp_.config()), out.network);
}

void JointField::differentiate(const Exec& exec, const Points& points, const Sampled& at,
                               const std::vector<float>& grad_density, const std::vector<float>& grad_rgb) {
  const FilmMlpGradients inputs =
      mlp_.backward(exec, store_, at.inputs(points.direction, points.per_direction, mlp_.config()), at.network,
                    {grad_density, grad_rgb});
  hash_.backward(exec, store_, points.position, inputs.feature);
  if (!effects_.film) return;
  const auto queries = std::int64_t(inputs.condition.size()) / 3;
  const RbfGradients features =
      rbf_backward(exec, rbf_problem(points), at.rbf, {inputs.condition.data(), queries, 3}, false);
  for (std::size_t i = 0; i < features.feature.size(); ++i) store_.grads[feature_offset_ + i] += features.feature[i];
}

const VolumeOutput& JointField::forward(const Exec& exec, const FieldRays& rays, Rows<const float, 3> boundary,
                                        Vec3<float> background) {
  evaluate(exec, points_of(rays, boundary), sampled_);
  volume_forward(exec,
                 {rays.rays.samples, sampled_.network.density.data(), sampled_.network.rgb.data(),
                  rays.rays.spacing.data(), rays.rays.rays(), background},
                 volume_);
  return volume_;
}

void JointField::backward(const Exec& exec, const FieldRays& rays, Rows<const float, 3> boundary,
                          Vec3<float> background, const AlignFieldGradients& gradients) {
  volume_backward(exec,
                  {rays.rays.samples, sampled_.network.density.data(), sampled_.network.rgb.data(),
                   rays.rays.spacing.data(), rays.rays.rays(), background},
                  volume_, {gradients.colour, gradients.alpha, {}}, volume_grad_);
  differentiate(exec, points_of(rays, boundary), sampled_, volume_grad_.density, volume_grad_.rgb);
}

double JointField::smoothness(const Exec& exec, const FieldRays& rays, Rows<const float, 3> boundary, double weight,
                              std::int64_t step) {
  const std::int64_t queries = rays.rays.positions().n, count = std::min<std::int64_t>(options_.smooth_points, queries);
  if (count == 0) return 0;
  std::vector<float> position, direction;
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t q = i * queries / count, ray = q / rays.rays.samples;
    position.insert(position.end(), rays.rays.position.begin() + q * 3, rays.rays.position.begin() + q * 3 + 3);
    direction.insert(direction.end(), rays.rays.direction.begin() + ray * 3, rays.rays.direction.begin() + ray * 3 + 3);
  }
  const SmoothnessScale scale{options_.smooth_step * width_, width_};
  const std::vector<float> moved = jittered_points(exec, {position.data(), count}, seed_,
                                                   std::uint64_t(step) * std::uint64_t(count), scale.jitter_length);
  const std::vector<float>* sets[2] = {&position, &moved};
  KnnGraph graph[2];
  Sampled at[2];
  for (int k = 0; k < 2; ++k) {
    graph[k] = nearest_points(exec, boundary, {sets[k]->data(), count}, neighbours_);
    build_transpose(graph[k]);
    evaluate(exec, {{sets[k]->data(), count}, &graph[k], {direction.data(), count}, 1, boundary}, at[k]);
  }
  SmoothnessGradients gradients;
  const double loss = loss_smooth_backward(exec, scale, {at[0].network.rgb, at[1].network.rgb}, weight, gradients);
  const std::vector<float> no_density(std::size_t(count), 0.f);
  const std::vector<float>* grad[2] = {&gradients.colour, &gradients.moved_colour};
  for (int k = 0; k < 2; ++k)
    differentiate(exec, {{sets[k]->data(), count}, &graph[k], {direction.data(), count}, 1, boundary}, at[k],
                  no_density, *grad[k]);
  return loss;
}

AdamOptions JointField::adam_of(const ParamBlock& block) const {
  AdamOptions adam;
  const bool table = block.name.starts_with("hash"), feature = block.name == "feature";
  adam.lr = options_.rate_literal ? kLiteralRate
            : table               ? options_.rate_hash
            : feature             ? options_.rate_feature
                                  : options_.rate_mlp;
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
}

}  // namespace ngs
