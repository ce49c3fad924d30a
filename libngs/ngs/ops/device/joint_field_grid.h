#pragma once
// The field of the joint step on a device: what passes/joint/joint_field.cpp does with the ops, on resident parameters.
//                                                                                     Eqs. (1), (8)-(15), (18)
#include "ngs/ops/device/film_backward_schedule.h"
#include "ngs/ops/device/film_forward_schedule.h"
#include "ngs/ops/device/hash_grid_schedule.h"
#include "ngs/ops/device/joint_rays_grid.h"
#include "ngs/ops/losses/loss_smooth_kernels.h"
#include "ngs/ops/field/rbf.h"
#include "ngs/ops/field/rbf_kernels.h"
#include "ngs/ops/device/sum_schedule.h"
#include "ngs/ops/field/volume_kernels.h"

namespace ngs {

struct AddTo {
  static constexpr const char* kName = "add_to";
  const float* from;
  float* to;
  NGS_HD void operator()(std::int64_t i) const { to[i] += from[i]; }
};

/// An evenly spaced subset of the queries, each with a point beside it. Those beyond the last are the first query.
struct SmoothPoints {
  static constexpr const char* kName = "smooth_points";
  const ViewGrid* view;
  const std::int64_t* step;  // done before this one
  const float *position, *direction;
  int samples, most;
  std::uint64_t seed;
  double jitter_length;
  float *point, *moved, *ray;  // [most, 3] out
  double* count;               // [1] out

  NGS_HD static std::int64_t count_of(const ViewGrid& view, int samples, int most) {
    return min2<std::int64_t>(most, view.queries(samples));
  }
  NGS_HD void operator()(std::int64_t i) const {
    const std::int64_t queries = view->queries(samples), n = count_of(*view, samples, most);
    const std::int64_t q = i < n ? i * queries / n : 0;
    for (int a = 0; a < 3; ++a) {
      point[i * 3 + a] = position[q * 3 + a];
      ray[i * 3 + a] = direction[q / samples * 3 + a];
    }
    jitter_point(point + i * 3, seed, std::uint64_t(*step) * std::uint64_t(n) + std::uint64_t(i), jitter_length, moved + i * 3);
    if (i == 0) *count = double(n);
  }
};

struct SmoothnessOfView {
  static constexpr const char* kName = "smoothness";
  SmoothnessForwardBackward<float> kernel;
  SmoothnessScale scale;
  double weight;
  const double* count;
  NGS_HD void operator()(std::int64_t i) const {
    SmoothnessForwardBackward<float> here = kernel;
    const auto n = std::int64_t(*count);
    here.scale = i < n ? float(weight * smoothness_factor(scale, n)) : 0.f;
    here(i);
    if (i >= n) here.term[i] = 0;
  }
};

template <class Grid>
class FieldOnGrid {
  using Floats = DeviceBuffer<Grid, float>;

 public:
  FieldOnGrid(Grid& grid, const JointFieldLayout& field, DeviceSums sums)
      : grid_(grid), field_(field), sums_(sums), level_(grid, field.hash->levels()), inv_2h2_(inv_2h2(field.width)) {}

  /// Where the store lies, and where the boundary is now.
  struct Parameters {
    const float* values;
    float* grads;
    Rows<const float, 3> boundary;
  };
  struct Points {
    Rows<const float, 3> position, direction;
    std::int64_t per_direction;
    const GraphOnGrid<Grid>* graph;
  };
  struct Sampled {
    Floats weight, feature, encoding, density, rgb, context;
  };
  struct Volume {
    Floats colour, alpha, optical_depth, weight, after;
  };

  Sampled evaluate(const Parameters& p, const Points& at) const {
    const std::int64_t n = at.position.n;
    const int k = at.graph->neighbours;
    Sampled out{{grid_, n * k}, {grid_, n * kFeatures}, {grid_, n * field_.hash->config().outputs()}, {grid_, n}, {grid_, n * 3}, {}};
    grid_.each(n, RbfForward<float>{at.position, p.boundary, at.graph->indices(), features(p), inv_2h2_,
                                    {out.weight.data(), n, k}, {out.feature.data(), n, kFeatures}});
    if (!field_.conditioned) out.feature.zero();
    const HashGridView<float> view = hash_view(p, at.position);
    with_hash_features(field_.hash->config().features, [&](auto f) {
      grid_.each(n * view.levels, HashForward<float, f>{view, out.encoding.data()});
    });
    out.context = film_forward_on_grid(grid_, network(p, at, out), out.density.data(), out.rgb.data());
    return out;
  }

  /// Adds to the gradients.
  void differentiate(const Parameters& p, const Points& at, const Sampled& out, const float* grad_density,
                     const float* grad_rgb) const {
    const std::int64_t n = at.position.n, boundary = p.boundary.n;
    const Floats input(grid_, n * field_.hash->config().outputs()), condition(grid_, n * kFeatures);
    film_backward_on_grid(grid_, network(p, at, out), {grad_density, grad_rgb, input.data(), condition.data()},
                          p.grads + field_.film->offset());
    with_hash_features(field_.hash->config().features, [&](auto f) {
      hash_backward_on_grid<f>(grid_, {hash_view(p, at.position), input.data(), p.grads + field_.hash->offset()},
                               field_.hash->entries(), sums_);
    });
    if (!field_.conditioned) return;
    const Floats feature(grid_, boundary * kFeatures);
    grid_.each(boundary, RbfBackwardFeature<float>{at.graph->row_begin.data(), at.graph->edge.data(),
                                                   {out.weight.data(), n, at.graph->neighbours},
                                                   {condition.data(), n, kFeatures},
                                                   {feature.data(), boundary, kFeatures}});
    grid_.each(boundary * kFeatures, AddTo{feature.data(), p.grads + field_.feature_offset});
  }

  static Points points_of(const RaysOnGrid<Grid>& rays) {
    return {rays.positions(), {rays.direction.data(), rays.rays}, rays.samples, &rays.graph};
  }

  Volume render(const RaysOnGrid<Grid>& rays, const Sampled& at, Vec3<float> background) const {
    const std::int64_t n = rays.rays, samples = n * rays.samples;
    Volume out{{grid_, n * 3}, {grid_, n}, {grid_, n}, {grid_, samples}, {grid_, samples}};
    grid_.each(n, VolumeForward<float>{volume_rays(rays, at, background), out.colour.data(), out.alpha.data(),
                                       out.optical_depth.data(), out.weight.data(), out.after.data()});
    return out;
  }

  /// From ∂L/∂(colour, alpha) of the rays to the gradients of the parameters.
  struct Rendered {
    const Sampled& at;
    const Volume& volume;
  };
  void back_from(const Parameters& p, const RaysOnGrid<Grid>& rays, const Rendered& r, Vec3<float> background,
                 const RayValues<float>& grad) const {
    const std::int64_t samples = rays.rays * rays.samples;
    const Floats density(grid_, samples), rgb(grid_, samples * 3);
    grid_.each(rays.rays, VolumeBackward<float>{volume_rays(rays, r.at, background), r.volume.weight.data(),
                                                r.volume.after.data(), grad.colour, grad.alpha, nullptr, density.data(),
                                                rgb.data()});
    differentiate(p, points_of(rays), r.at, density.data(), rgb.data());
  }

  /// L_smth: adds `weight` times its gradient; sums[0]: Σ terms, sums[1]: points.
  struct SmoothTerm {
    double weight;
    int most;
    SmoothnessScale scale;
    std::uint64_t seed;
    const std::int64_t* step;
  };
  void smooth(const Parameters& p, const RaysOnGrid<Grid>& rays, const SmoothTerm& s, double* sums) const {
    const auto most = std::int64_t(min2<std::int64_t>(s.most, rays.rays * rays.samples));
    const Floats point(grid_, most * 3), moved(grid_, most * 3), ray(grid_, most * 3), term(grid_, most);
    grid_.each(most, SmoothPoints{rays.view.data(), s.step, rays.position.data(), rays.direction.data(), rays.samples, s.most,
                                  s.seed, s.scale.jitter_length, point.data(), moved.data(), ray.data(), sums + 1});
    GraphOnGrid<Grid> graph[2];
    Sampled at[2];
    Points points[2];
    for (int k = 0; k < 2; ++k) {
      const Rows<const float, 3> position{k == 0 ? point.data() : moved.data(), most};
      graph[k] = nearest_on_grid(grid_, p.boundary, position, field_.neighbours, false);
      points[k] = {position, {ray.data(), most}, 1, &graph[k]};
      at[k] = evaluate(p, points[k]);
    }
    const Floats grad(grid_, most * 3), grad_moved(grid_, most * 3);
    grid_.each(most, SmoothnessOfView{{{at[0].rgb.data(), most}, {at[1].rgb.data(), most}, 0, term.data(),
                                       {grad.data(), most}, {grad_moved.data(), most}},
                                      s.scale, s.weight, sums + 1});
    sums_on_grid(grid_, static_cast<const float*>(term.data()), most, 1, sums);
    Floats no_density(grid_, most);
    no_density.zero();
    for (int k = 0; k < 2; ++k)
      differentiate(p, points[k], at[k], no_density.data(), k == 0 ? grad.data() : grad_moved.data());
  }

 private:
  static constexpr int kFeatures = 3;  // of f_j

  HashGridView<float> hash_view(const Parameters& p, Rows<const float, 3> position) const {
    const HashGridConfig& c = field_.hash->config();
    return {level_.data(), c.levels, field_.hash->box(), c.smoothstep, p.values + field_.hash->offset(), position};
  }
  Matrix<const float> features(const Parameters& p) const {
    return {p.values + field_.feature_offset, p.boundary.n, kFeatures};
  }
  FilmOnGrid network(const Parameters& p, const Points& at, const Sampled& out) const {
    const FilmMlpConfig& c = field_.film->config();
    return {c, film_mlp_layout(c), film_direction_inputs(c), p.values + field_.film->offset(),
            {out.encoding.data(), at.position.n, c.inputs}, {out.feature.data(), at.position.n, c.condition},
            at.direction, at.per_direction, field_.film->density_scale(), out.context.data()};
  }
  static VolumeRays<float> volume_rays(const RaysOnGrid<Grid>& rays, const Sampled& at, Vec3<float> background) {
    return {rays.rays, rays.samples, at.density.data(), at.rgb.data(), rays.spacing.data(), background};
  }

  Grid& grid_;
  JointFieldLayout field_;
  DeviceSums sums_;
  DeviceBuffer<Grid, HashLevel> level_;
  float inv_2h2_;
};

}  // namespace ngs
