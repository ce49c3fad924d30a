// Cost and error of the arithmetic on one scene: numerical.json of pipelines/work-precision.mk.
//
//   ngs_numerical scene.json boundary.ply > numerical.json
//
// Independent of task accuracy. Splat: the label image of the first training view, in float and double, with the
// cut-offs of 3DGS (alpha < 1/255, transmittance < 1e-4, footprint radius), against the rendering equation in double
// without cut-offs. RBF: features of query points near the boundary, from the K nearest in float, against all boundary
// Gaussians in double.
#include <cmath>
#include <ctime>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "ngs/core/rng.h"
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/field/rbf_stage.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/ops/field/rbf.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/ops/splat/cloud_view.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/ops/splat/splat_engine.h"
#include "ngs/ops/splat/tile_kernels_of.h"
#include "ngs/ops/splat/tile_scratch.h"
#include "ngs/problem/view_list.h"
#include "ngs/scene/boundary_set.h"

namespace ngs::bench {
namespace {

using Json = nlohmann::ordered_json;

double cpu_now_s() {
  timespec used{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
  return double(used.tv_sec) + 1e-9 * double(used.tv_nsec);
}

/// Minimum CPU seconds of three calls.
double seconds(const std::function<void()>& body) {
  double best = INFINITY;
  for (int again = 0; again < 3; ++again) {
    const double before = cpu_now_s();
    body();
    best = std::min(best, cpu_now_s() - before);
  }
  return best;
}

Json point(const std::string& knob, const std::string& setting, double cpu_s, double error) {
  return {{"knob", knob}, {"setting", setting}, {"cpu_s", cpu_s}, {"error", error}};
}

/// Columns of a model in double, and its label image.
struct DoubleModel {
  using S = double;
  std::vector<S> position, rotation, log_scale, logit_opacity, label;
  CloudView<S> view;

  DoubleModel(const GaussianCloud& c, const std::vector<float>& labels)
      : position(c.position.begin(), c.position.end()),
        rotation(c.rotation.begin(), c.rotation.end()),
        log_scale(c.log_scale.begin(), c.log_scale.end()),
        logit_opacity(c.logit_opacity.begin(), c.logit_opacity.end()),
        label(labels.begin(), labels.end()) {
    view.size = c.size();
    view.position = position.data();
    view.rotation = rotation.data();
    view.log_scale = log_scale.data();
    view.logit_opacity = logit_opacity.data();
    view.usable = c.usable.data();
  }

  std::vector<double> image(const Camera& camera) const {
    ChannelPlan<S> request;
    request.colour = false;
    request.label = {label.data(), view.size, 1};
    SplatEngine<S> engine(tile_kernels_of<S>(), {}, view, camera, request);
    std::vector<S> plane(std::size_t(camera.width_px) * std::size_t(camera.height_px)), alpha = plane;
    engine.forward({}, {{plane.data(), 1}, {alpha.data(), 1}});
    return {plane.begin(), plane.end()};
  }

  /// Label at one pixel from all projected Gaussians in depth order, without cut-offs.
  double exact(const ProjectedView<S>& seen, const std::vector<std::size_t>& order, int x, int y) const {
    double transmittance = 1, sum = 0;
    for (const std::size_t v : order) {
      const SplatRecord<S>& r = seen.record[v];
      const double dx = double(r.mean_x) - x - 0.5, dy = double(r.mean_y) - y - 0.5;
      const double power =
          -0.5 * (double(r.form.a()) * dx * dx + double(r.form.c()) * dy * dy) - double(r.form.b()) * dx * dy;
      const double alpha = std::min(0.99, std::exp2(double(r.log2_opacity)) * std::exp(std::min(power, 0.0)));
      sum += transmittance * alpha * double(label[seen.id[v]]);
      transmittance *= 1 - alpha;
    }
    return sum;
  }
};

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

void splat_points(const GaussianCloud& cloud, const std::vector<float>& labels, const Camera& world, Json& points) {
  const Camera camera = relative_to(world, cloud.origin);
  const DoubleModel wide(cloud, labels);
  std::vector<double> fast, reference;
  const double fast_s = seconds([&] {
    RenderRequest request{.colour = false, .label = {labels.data(), cloud.size(), 1}};
    const RenderedView view = render({}, cloud, world, {}, request);
    fast.assign(view.label.data.begin(), view.label.data.end());
  });
  const double reference_s = seconds([&] { reference = wide.image(camera); });
  const ProjectedView<double> seen = project_view({}, wide.view, view_projector<double>(camera, {}));
  std::vector<std::size_t> order(seen.id.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return seen.depth[a] < seen.depth[b]; });
  std::vector<double> some_fast, some_reference, exact;
  constexpr int kStride = 16;
  const double before = cpu_now_s();
  for (int y = kStride / 2; y < camera.height_px; y += kStride)
    for (int x = kStride / 2; x < camera.width_px; x += kStride) {
      const std::size_t p = std::size_t(y) * std::size_t(camera.width_px) + std::size_t(x);
      exact.push_back(wide.exact(seen, order, x, y));
      some_fast.push_back(fast[p]);
      some_reference.push_back(reference[p]);
    }
  const double exact_s = (cpu_now_s() - before) * double(fast.size()) / double(exact.size());
  points.push_back(point("cuts", "float, cut", fast_s, largest_difference(some_fast, exact)));
  points.push_back(point("cuts", "double, cut", reference_s, largest_difference(some_reference, exact)));
  points.push_back(point("cuts", "double, none (every 16th pixel)", exact_s, 0));
  points.push_back(point("rounding", "float against double, both cut", fast_s, largest_difference(fast, reference)));
}

/// Features at `queries` from all boundary points, in double.
std::vector<double> all_neighbours(const BoundarySet& boundary, const std::vector<float>& queries, double width) {
  std::vector<double> out(queries.size());
  const std::size_t n = boundary.row.size();
  std::vector<double> d2(n);
  for (std::size_t q = 0; q < queries.size() / 3; ++q) {
    for (std::size_t b = 0; b < n; ++b) {
      d2[b] = 0;
      for (std::size_t a = 0; a < 3; ++a)
        d2[b] += std::pow(double(queries[q * 3 + a]) - double(boundary.position[b * 3 + a]), 2);
    }
    const double least = *std::min_element(d2.begin(), d2.end());
    double total = 0;
    for (std::size_t b = 0; b < n; ++b) {
      const double weight = std::exp((least - d2[b]) / (2 * width * width));
      total += weight;
      for (std::size_t a = 0; a < 3; ++a) out[q * 3 + a] += weight * double(boundary.colour[b * 3 + a]);
    }
    for (std::size_t a = 0; a < 3; ++a) out[q * 3 + a] /= total;
  }
  return out;
}

void rbf_points(const BoundarySet& boundary, Json& points) {
  constexpr std::size_t kQueries = 20000;
  if (boundary.size() == 0) return;
  const double width = rbf_width({}, {}, boundary.positions());
  std::vector<float> queries(kQueries * 3);
  for (std::size_t q = 0; q < kQueries; ++q)
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t near = rng_bits(5, RngStream::kTest, q) % boundary.row.size();
      queries[q * 3 + a] =
          boundary.position[near * 3 + a] + float(2 * width * (2 * rng_uniform(6, RngStream::kTest, q * 3 + a) - 1));
    }
  std::vector<double> all;
  const double all_s = seconds([&] { all = all_neighbours(boundary, queries, width); });
  points.push_back(point("neighbours", "all, double", all_s, 0));
  for (const int k : {1, 2, 4, 8, 16, 32}) {
    RbfField field;
    KnnGraph graph;
    const double took = seconds([&] {
      graph = nearest_points({}, boundary.positions(), {queries.data(), std::int64_t(kQueries)}, k);
      rbf_forward({},
                  {{queries.data(), std::int64_t(kQueries)},
                   boundary.positions(),
                   {boundary.colour.data(), boundary.size(), 3},
                   &graph,
                   width},
                  field);
    });
    points.push_back(point("neighbours", std::to_string(k), took,
                           largest_difference({field.feature.begin(), field.feature.end()}, all)));
  }
}

int measure(const std::string& scene_path, const std::string& model_path) {
  const Scene scene = io::read_scene_json(scene_path);
  const io::GaussianPly model = io::read_gaussian_ply(model_path);
  const std::vector<std::size_t> views = training_views(scene);
  Json points = Json::array();
  splat_points(model.cloud, model.labels.label.values(), scene.views.at(views.at(0)).camera, points);
  rbf_points(boundary_set(model.cloud, model.labels.boundary.values()), points);
  std::cout << Json{{"reference",
                     "Largest error. cuts: rendered label, against the rendering equation in double without cut-offs; "
                     "rounding: against the same picture in double; neighbours: interpolated colour, against "
                     "all boundary Gaussians in double."},
                    {"points", points}}
                   .dump(1)
            << "\n";
  return 0;
}

}  // namespace
}  // namespace ngs::bench

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "ngs_numerical scene.json boundary.ply > numerical.json\n";
    return 2;
  }
  return ngs::bench::measure(argv[1], argv[2]);
}
