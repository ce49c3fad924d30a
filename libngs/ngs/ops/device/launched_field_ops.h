#pragma once
// DeviceFieldOps on a Launcher: uploads, runs the kernels, downloads.
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/device/film_backward_kernel.h"
#include "ngs/ops/device/film_forward_kernel.h"
#include "ngs/ops/device/hash_grid_kernel.h"
#include "ngs/ops/device/knn_kernel.h"
#include "ngs/ops/field/rbf_kernels.h"
#include "ngs/ops/field/volume_kernels.h"

namespace ngs {

template <class Launcher>
class LaunchedFieldOps final : public DeviceFieldOps {
  using Floats = DeviceBuffer<Launcher, float>;

 public:
  LaunchedFieldOps(Launcher& launcher, DeviceSums sums) : launcher_(launcher), sums_(sums) {}

  void nearest(Rows<const float, 3> points, Rows<const float, 3> queries, bool exclude_self,
               KnnGraph& out) const override {
    const Floats p(launcher_, points.data, points.n * 3), q(launcher_, queries.data, queries.n * 3);
    const GraphOnDevice<Launcher> found(launcher_, {p.data(), points.n}, {q.data(), queries.n}, exclude_self, out);
    found.index.to(out.index);
    found.dist2.to(out.dist2);
    found.row_begin.to(out.row_begin);
    found.edge.to(out.edge);
  }

  void read_nodes(const ReadNodes& host) const override {
    const std::int64_t pixels = std::int64_t(host.map.width_px) * host.map.height_px, nodes = host.grid.nodes();
    const Floats depth(launcher_, host.map.depth, pixels), alpha(launcher_, host.map.alpha, pixels);
    const DeviceBuffer<Launcher, NodeDepth> node(launcher_, nodes);
    ReadNodes kernel = host;
    kernel.map.depth = depth.data();
    kernel.map.alpha = alpha.data();
    kernel.node = node.data();
    launcher_.parallel_for(nodes, kernel);
    node.to(host.node);
  }

  void rbf_forward(const RbfProblem& problem, float inv_2h2, RbfField& out) const override {
    const RbfArrays a(launcher_, problem);
    const KnnGraph& graph = *problem.graph;
    const Floats weight = result(out.weight), feature = result(out.feature);
    launcher_.parallel_for(problem.query.n, RbfForward<float>{a.queries(),
                                                              a.points(),
                                                              a.indices(),
                                                              a.features(),
                                                              inv_2h2,
                                                              {weight.data(), problem.query.n, graph.neighbours},
                                                              {feature.data(), problem.query.n, problem.feature.c}});
    weight.to(out.weight.data());
    feature.to(out.feature.data());
  }

  void rbf_backward(const RbfProblem& problem, const RbfField& field, Matrix<const float> grad_feature,
                    std::vector<float>& out) const override {
    const KnnGraph& graph = *problem.graph;
    const std::int64_t queries = problem.query.n, points = problem.boundary.n;
    const Floats weight(launcher_, field.weight), grad(launcher_, grad_feature.data, grad_feature.n * grad_feature.c),
        feature = result(out);
    const DeviceBuffer<Launcher, std::int64_t> row_begin(launcher_, graph.row_begin), edge(launcher_, graph.edge);
    launcher_.parallel_for(points, RbfBackwardFeature<float>{row_begin.data(),
                                                             edge.data(),
                                                             {weight.data(), queries, graph.neighbours},
                                                             {grad.data(), queries, grad_feature.c},
                                                             {feature.data(), points, problem.feature.c}});
    feature.to(out.data());
  }

  void hash_forward(const HashCall& call, std::vector<float>& out) const override {
    const HashArrays a(launcher_, call);
    const Floats encoding = result(out);
    with_hash_features(call.features, [&](auto f) {
      launcher_.parallel_for(call.grid.point.n * call.grid.levels, HashForward<float, f>{a.view, encoding.data()});
    });
    encoding.to(out.data());
  }
  void hash_backward(const HashCall& call, const std::vector<float>& grad_out,
                     float* grad_table_accumulate) const override {
    const HashArrays a(launcher_, call);
    const Floats grad(launcher_, grad_out),
        table(launcher_, grad_table_accumulate, std::int64_t(call.entries) * call.features);
    with_hash_features(call.features, [&](auto f) {
      hash_backward_on_device<f>(launcher_, {a.view, grad.data(), table.data()}, call.entries, sums_);
    });
    table.to(grad_table_accumulate);
  }

  void film_forward(const FilmCall& call, const FilmMlpInputs& in, FilmMlpOutput& out) const override {
    const FilmArrays a(launcher_, call, in);
    const Floats density = result(out.density), rgb = result(out.rgb), context = result(out.context);
    FilmOnDevice net = a.net;
    net.context = context.data();
    film_forward_on_device(launcher_, net, density.data(), rgb.data());
    density.to(out.density);
    rgb.to(out.rgb);
    context.to(out.context);
  }
  std::int64_t film_context_size(const FilmMlpConfig& config, std::int64_t queries) const override {
    return device_film_context_size(config, queries);
  }

  void film_backward(const FilmCall& call, const FilmMlpInputs& in, const FilmMlpOutputGradients& grad,
                     FilmMlpGradients& out) const override {
    const FilmArrays a(launcher_, call, in);
    const Floats context(launcher_, grad.forward.context), density(launcher_, grad.density), rgb(launcher_, grad.rgb);
    const Floats feature = result(out.feature), condition = result(out.condition);
    const Floats total(launcher_, call.grad_params_accumulate, std::int64_t(a.net.at.size));
    FilmOnDevice net = a.net;
    net.context = context.data();
    film_backward_on_device(launcher_, net, {density.data(), rgb.data(), feature.data(), condition.data()},
                            total.data());
    feature.to(out.feature);
    condition.to(out.condition);
    total.to(call.grad_params_accumulate);
  }

  void volume_forward(const VolumeInputs& in, VolumeOutput& out) const override {
    const VolumeArrays a(launcher_, in);
    const Floats colour = result(out.colour), alpha = result(out.alpha), depth = result(out.optical_depth),
                 weight = result(out.weight), after = result(out.transmittance_after);
    launcher_.parallel_for(
        in.rays, VolumeForward<float>{a.view, colour.data(), alpha.data(), depth.data(), weight.data(), after.data()});
    colour.to(out.colour.data());
    alpha.to(out.alpha.data());
    depth.to(out.optical_depth.data());
    weight.to(out.weight.data());
    after.to(out.transmittance_after.data());
  }
  void volume_backward(const VolumeInputs& in, const VolumeOutput& forward, const VolumeOutputGradients& grad,
                       VolumeGradients& out) const override {
    const VolumeArrays a(launcher_, in);
    const Floats weight(launcher_, forward.weight), after(launcher_, forward.transmittance_after),
        colour(launcher_, grad.colour), alpha(launcher_, grad.alpha), depth(launcher_, grad.optical_depth),
        density = result(out.density), rgb = result(out.rgb);
    launcher_.parallel_for(in.rays, VolumeBackward<float>{a.view, weight.data(), after.data(), colour.data(),
                                                          alpha.data(), depth.data(), density.data(), rgb.data()});
    density.to(out.density.data());
    rgb.to(out.rgb.data());
  }

 private:
  Floats result(const std::vector<float>& host) const {
    return Floats::result(launcher_, host.data(), std::int64_t(host.size()));
  }
  struct RbfArrays {
    const RbfProblem& problem;
    Floats query, boundary, feature;
    DeviceBuffer<Launcher, std::uint32_t> index;
    RbfArrays(Launcher& launcher, const RbfProblem& p)
        : problem(p),
          query(launcher, p.query.data, p.query.n * 3),
          boundary(launcher, p.boundary.data, p.boundary.n * 3),
          feature(launcher, p.feature.data, p.feature.n * p.feature.c),
          index(launcher, p.graph->index) {}
    Rows<const float, 3> queries() const { return {query.data(), problem.query.n}; }
    Rows<const float, 3> points() const { return {boundary.data(), problem.boundary.n}; }
    Matrix<const float> features() const { return {feature.data(), problem.feature.n, problem.feature.c}; }
    Matrix<const std::uint32_t> indices() const { return {index.data(), problem.query.n, problem.graph->neighbours}; }
  };
  struct HashArrays {
    DeviceBuffer<Launcher, HashLevel> level;
    Floats table, point;
    HashGridView<float> view;
    HashArrays(Launcher& launcher, const HashCall& call)
        : level(launcher, call.grid.level, call.grid.levels),
          table(launcher, call.grid.table, std::int64_t(call.entries) * call.features),
          point(launcher, call.grid.point.data, call.grid.point.n * 3),
          view(call.grid) {
      view.level = level.data();
      view.table = table.data();
      view.point.data = point.data();
    }
  };
  struct FilmArrays {
    Floats params, input, condition, direction;
    FilmOnDevice net;
    FilmArrays(Launcher& launcher, const FilmCall& call, const FilmMlpInputs& in)
        : params(launcher, call.params, std::int64_t(film_mlp_layout(call.config).size)),
          input(launcher, in.feature.data, in.feature.n * in.feature.c),
          condition(launcher, in.condition.data, in.condition.n * in.condition.c),
          direction(launcher, in.direction.data, in.direction.n * 3),
          net{call.config,
              film_mlp_layout(call.config),
              film_direction_inputs(call.config),
              params.data(),
              {input.data(), in.feature.n, in.feature.c},
              {condition.data(), in.condition.n, in.condition.c},
              {direction.data(), in.direction.n},
              in.queries_per_direction,
              call.density_scale,
              nullptr} {}
  };
  struct VolumeArrays {
    Floats density, rgb, spacing;
    VolumeRays<float> view;
    VolumeArrays(Launcher& launcher, const VolumeInputs& in)
        : density(launcher, in.density, in.rays * in.samples),
          rgb(launcher, in.rgb, in.rays * in.samples * 3),
          spacing(launcher, in.spacing, in.rays),
          view{in.rays, in.samples, density.data(), rgb.data(), spacing.data(), in.background} {}
  };

  Launcher& launcher_;
  DeviceSums sums_;
};

}  // namespace ngs
