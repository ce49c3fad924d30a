#pragma once
// DeviceFieldOps on a Grid: copies in, the schedules, copies out.
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/device/film_backward_schedule.h"
#include "ngs/ops/device/film_forward_schedule.h"
#include "ngs/ops/device/hash_grid_schedule.h"
#include "ngs/ops/device/knn_schedule.h"
#include "ngs/ops/field/rbf_kernels.h"
#include "ngs/ops/field/volume_kernels.h"

namespace ngs {

template <class Grid>
class LaunchedFieldOps final : public DeviceFieldOps {
  using Floats = DeviceBuffer<Grid, float>;

 public:
  LaunchedFieldOps(Grid& grid, DeviceSums sums) : grid_(grid), sums_(sums) {}

  KnnGraph nearest(Rows<const float, 3> points, Rows<const float, 3> queries, int neighbours,
                   bool exclude_self) const override {
    const Floats p(grid_, points.data, points.n * 3), q(grid_, queries.data, queries.n * 3);
    const GraphOnGrid<Grid> found =
        nearest_on_grid<Grid>(grid_, {p.data(), points.n}, {q.data(), queries.n}, neighbours, exclude_self);
    KnnGraph graph;
    graph.neighbours = found.neighbours, graph.points = found.points;
    found.index.to(graph.index), found.dist2.to(graph.dist2);
    found.row_begin.to(graph.row_begin), found.edge.to(graph.edge);
    return graph;
  }

  void rbf_forward(const RbfProblem& problem, float inv_2h2, RbfField& out) const override {
    const RbfArrays a(grid_, problem);
    const KnnGraph& graph = *problem.graph;
    const Floats weight(grid_, std::int64_t(out.weight.size())), feature(grid_, std::int64_t(out.feature.size()));
    grid_.each(problem.query.n, RbfForward<float>{a.queries(), a.points(), a.indices(), a.features(), inv_2h2,
                                                  {weight.data(), problem.query.n, graph.neighbours},
                                                  {feature.data(), problem.query.n, problem.feature.c}});
    weight.to(out.weight.data()), feature.to(out.feature.data());
  }

  void rbf_backward(const RbfProblem& problem, float inv_2h2, const RbfField& field, Matrix<const float> grad_feature,
                    RbfGradients& out) const override {
    const RbfArrays a(grid_, problem);
    const KnnGraph& graph = *problem.graph;
    const std::int64_t queries = problem.query.n, points = problem.boundary.n;
    const Floats weight(grid_, field.weight), grad(grid_, grad_feature.data, grad_feature.n * grad_feature.c);
    const DeviceBuffer<Grid, std::int64_t> row_begin(grid_, graph.row_begin), edge(grid_, graph.edge);
    const Matrix<const float> weights{weight.data(), queries, graph.neighbours}, grads{grad.data(), queries, grad_feature.c};
    const Floats feature(grid_, std::int64_t(out.feature.size()));
    grid_.each(points, RbfBackwardFeature<float>{row_begin.data(), edge.data(), weights, grads,
                                                 {feature.data(), points, problem.feature.c}});
    feature.to(out.feature.data());
    if (out.boundary.empty()) return;
    const Floats exponent(grid_, queries * graph.neighbours), boundary(grid_, points * 3);
    grid_.each(queries, RbfBackwardExponent<float>{a.indices(), a.features(), weights, grads,
                                                   {exponent.data(), queries, graph.neighbours}});
    grid_.each(points, RbfBackwardPosition<float>{row_begin.data(), edge.data(), {exponent.data(), queries, graph.neighbours},
                                                  a.queries(), a.points(), inv_2h2, {boundary.data(), points}});
    boundary.to(out.boundary.data());
  }

  void hash_forward(const HashCall& call, std::vector<float>& out) const override {
    const HashArrays a(grid_, call);
    const Floats encoding(grid_, std::int64_t(out.size()));
    with_hash_features(call.features, [&](auto f) {
      grid_.each(call.grid.point.n * call.grid.levels, HashForward<float, f>{a.view, encoding.data()});
    });
    encoding.to(out.data());
  }
  void hash_backward(const HashCall& call, const std::vector<float>& grad_out, float* grad_table_accumulate) const override {
    const HashArrays a(grid_, call);
    const Floats grad(grid_, grad_out),
        table(grid_, grad_table_accumulate, std::int64_t(call.entries) * call.features);
    with_hash_features(call.features, [&](auto f) {
      hash_backward_on_grid<f>(grid_, {a.view, grad.data(), table.data()}, call.entries, sums_);
    });
    table.to(grad_table_accumulate);
  }
  void hash_backward_points(const HashCall& call, const std::vector<float>& grad_out,
                            std::vector<float>& grad_points) const override {
    const HashArrays a(grid_, call);
    const Floats grad(grid_, grad_out), points(grid_, std::int64_t(grad_points.size()));
    with_hash_features(call.features, [&](auto f) {
      grid_.each(call.grid.point.n, HashBackwardPosition<float, f>{a.view, grad.data(), {points.data(), call.grid.point.n}});
    });
    points.to(grad_points.data());
  }

  void film_forward(const FilmCall& call, const FilmMlpInputs& in, FilmMlpOutput& out) const override {
    const FilmArrays a(grid_, call, in);
    const Floats density(grid_, in.feature.n), rgb(grid_, in.feature.n * 3);
    film_forward_on_grid(grid_, a.net, density.data(), rgb.data()).to(out.context);
    density.to(out.density.data()), rgb.to(out.rgb.data());
  }

  void film_backward(const FilmCall& call, const FilmMlpInputs& in, const FilmMlpOutput& forward,
                     const std::vector<float>& grad_density, const std::vector<float>& grad_rgb, FilmMlpGradients& out,
                     float* grad_params_accumulate) const override {
    const FilmArrays a(grid_, call, in);
    const Floats context(grid_, forward.context), density(grid_, grad_density), rgb(grid_, grad_rgb);
    const Floats feature(grid_, std::int64_t(out.feature.size())), condition(grid_, std::int64_t(out.condition.size()));
    const Floats total(grid_, grad_params_accumulate, std::int64_t(a.net.at.size));
    FilmOnGrid net = a.net;
    net.context = context.data();
    film_backward_on_grid(grid_, net, {density.data(), rgb.data(), feature.data(), condition.data()}, total.data());
    feature.to(out.feature.data()), condition.to(out.condition.data()), total.to(grad_params_accumulate);
  }

  void volume_forward(const VolumeInputs& in, VolumeOutput& out) const override {
    const VolumeArrays a(grid_, in);
    const std::int64_t samples = in.rays * in.samples;
    const Floats colour(grid_, in.rays * 3), alpha(grid_, in.rays), depth(grid_, in.rays), weight(grid_, samples),
        after(grid_, samples);
    grid_.each(in.rays, VolumeForward<float>{a.view, colour.data(), alpha.data(), depth.data(), weight.data(), after.data()});
    colour.to(out.colour.data()), alpha.to(out.alpha.data()), depth.to(out.optical_depth.data());
    weight.to(out.weight.data()), after.to(out.transmittance_after.data());
  }
  void volume_backward(const VolumeInputs& in, const VolumeOutput& forward, const std::vector<float>& grad_colour,
                       const std::vector<float>& grad_alpha, const std::vector<float>& grad_optical_depth,
                       VolumeGradients& out) const override {
    const VolumeArrays a(grid_, in);
    const std::int64_t samples = in.rays * in.samples;
    const Floats weight(grid_, forward.weight), after(grid_, forward.transmittance_after), colour(grid_, grad_colour),
        alpha(grid_, grad_alpha), depth(grid_, grad_optical_depth), density(grid_, samples), rgb(grid_, samples * 3);
    grid_.each(in.rays, VolumeBackward<float>{a.view, weight.data(), after.data(), colour.data(), alpha.data(),
                                              depth.data(), density.data(), rgb.data()});
    density.to(out.density.data()), rgb.to(out.rgb.data());
  }

 private:
  struct RbfArrays {
    const RbfProblem& problem;
    Floats query, boundary, feature;
    DeviceBuffer<Grid, std::uint32_t> index;
    RbfArrays(Grid& grid, const RbfProblem& p)
        : problem(p), query(grid, p.query.data, p.query.n * 3), boundary(grid, p.boundary.data, p.boundary.n * 3),
          feature(grid, p.feature.data, p.feature.n * p.feature.c), index(grid, p.graph->index) {}
    Rows<const float, 3> queries() const { return {query.data(), problem.query.n}; }
    Rows<const float, 3> points() const { return {boundary.data(), problem.boundary.n}; }
    Matrix<const float> features() const { return {feature.data(), problem.feature.n, problem.feature.c}; }
    Matrix<const std::uint32_t> indices() const { return {index.data(), problem.query.n, problem.graph->neighbours}; }
  };
  struct HashArrays {
    DeviceBuffer<Grid, HashLevel> level;
    Floats table, point;
    HashGridView<float> view;
    HashArrays(Grid& grid, const HashCall& call)
        : level(grid, call.grid.level, call.grid.levels),
          table(grid, call.grid.table, std::int64_t(call.entries) * call.features),
          point(grid, call.grid.point.data, call.grid.point.n * 3), view(call.grid) {
      view.level = level.data(), view.table = table.data(), view.point.data = point.data();
    }
  };
  struct FilmArrays {
    Floats params, input, condition, direction;
    FilmOnGrid net;
    FilmArrays(Grid& grid, const FilmCall& call, const FilmMlpInputs& in)
        : params(grid, call.params, std::int64_t(film_mlp_layout(call.config).size)),
          input(grid, in.feature.data, in.feature.n * in.feature.c),
          condition(grid, in.condition.data, in.condition.n * in.condition.c),
          direction(grid, in.direction.data, in.direction.n * 3),
          net{call.config, film_mlp_layout(call.config), film_direction_inputs(call.config), params.data(),
              {input.data(), in.feature.n, in.feature.c}, {condition.data(), in.condition.n, in.condition.c},
              {direction.data(), in.direction.n}, in.queries_per_direction, call.density_scale, nullptr} {}
  };
  struct VolumeArrays {
    Floats density, rgb, spacing;
    VolumeRays<float> view;
    VolumeArrays(Grid& grid, const VolumeInputs& in)
        : density(grid, in.density, in.rays * in.samples), rgb(grid, in.rgb, in.rays * in.samples * 3),
          spacing(grid, in.spacing, in.rays),
          view{in.rays, in.samples, density.data(), rgb.data(), spacing.data(), in.background} {}
  };

  Grid& grid_;
  DeviceSums sums_;
};

}  // namespace ngs
