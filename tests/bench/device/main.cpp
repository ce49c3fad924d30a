// Times every op on the CPU and on the CUDA device and prints one JSON object: seconds per call including copies to and
// from the device, and seconds of each kernel. Exit code 77: no device.
#include <chrono>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "bench_scene.h"
#include "joint_steps.h"
#include "ngs/backend/device_info.h"
#include "ngs/backend/device_profile.h"
#include "ngs/ops/device/cuda_ops.h"
#include "ngs/ops/field/hash_grid.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/ops/splat/evidence.h"

namespace ngs::bench {
namespace {

using Json = nlohmann::ordered_json;
using Body = std::function<void(const Exec&)>;

/// Minimum of five calls, after a warm-up call.
double seconds(const Exec& exec, const Body& body) {
  double best = 1e30;
  for (int round = 0; round < 6; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    body(exec);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    if (round > 0) best = std::min(best, took.count());
  }
  return best;
}

struct Bench {
  Exec cpu, device, atomic;  // `atomic` uses atomic sums
  Json cases = Json::array();

  void run(const std::string& name, const Body& body) { add(name, seconds(cpu, body), device, body); }
  /// For ops with ordered or atomic sums: times both.
  void run_sums(const std::string& name, const Body& body) {
    const double cpu_s = seconds(cpu, body);
    add(name, cpu_s, device, body);
    add(name + ", atomic sums", cpu_s, atomic, body);
  }

 private:
  void add(const std::string& name, double cpu_s, const Exec& exec, const Body& body) {
    Json one{{"name", name}, {"cpu_s", cpu_s}, {"device_s", seconds(exec, body)}, {"kernels", Json::array()}};
    profile_device();
    body(exec);
    for (const KernelTime& k : device_times())
      one["kernels"].push_back({{"name", k.name}, {"launches", k.launches}, {"seconds", k.seconds}});
    cases.push_back(std::move(one));
  }
};

void splat(Bench& bench, std::int64_t gaussians) {
  const BenchScene scene = bench_scene(gaussians, 1152, 864);
  const std::string size = ", " + std::to_string(scene.cloud.size()) + " Gaussians";
  test::Random random(1);
  const auto label = random.uniform_vector<float>(std::size_t(scene.cloud.size()), 0, 1);
  RenderRequest request;
  request.depth = true;
  request.label = {label.data(), scene.cloud.size(), 1};
  bench.run("splat forward" + size, [&](const Exec& exec) { render(exec, scene.cloud, scene.camera, {}, request); });
  ViewGradients gradient;
  gradient.colour = ImageF(scene.camera.width_px, scene.camera.height_px, 3, 0.1f);
  bench.run_sums("splat forward and backward" + size, [&](const Exec& exec) {
    SplatPass pass({});
    CloudGradients out;
    pass.forward(exec, scene.cloud, scene.camera, request);
    pass.backward(exec, gradient, out);
  });
  bench.run("evidence" + size, [&](const Exec& exec) {
    Evidence evidence(scene.cloud.size(), 1);
    add_view_evidence(exec, scene.cloud, {scene.camera, scene.masks}, {}, evidence);
  });
  const ImageF target = render(bench.cpu, scene.cloud, scene.camera, {}, {}).colour;
  ImageF to;
  PhotometricPass<float> pass;
  if (gaussians < 200000)
    bench.run("photometric", [&](const Exec& exec) { pass.evaluate(exec, {}, {target, target}, &to); });
}

void field(Bench& bench) {
  constexpr std::int64_t kQueries = 32768, kBoundary = 20000;
  test::Random random(2);
  const auto x = random.uniform_vector<float>(kBoundary * 3, -1, 1),
             q = random.uniform_vector<float>(kQueries * 3, -1, 1),
             colour = random.uniform_vector<float>(kBoundary * 3, 0, 1);
  const Rows<const float, 3> points{x.data(), kBoundary}, queries{q.data(), kQueries};
  bench.run("knn", [&](const Exec& exec) { nearest_points(exec, points, queries, 8); });
  const KnnGraph graph = nearest_points({}, points, queries, 8);
  RbfField rbf;
  bench.run("rbf", [&](const Exec& exec) {
    rbf_forward(exec, {queries, points, {colour.data(), kBoundary, 3}, &graph, 0.1}, rbf);
  });
  ParamStore store;
  const HashGridConfig hash_config;
  const HashGrid hash(hash_config, hash_box(points, 0.1), add_hash_grid(store, "hash", hash_config, 1));
  const FilmMlpConfig film_config;
  const FilmMlp film(film_config, add_film_mlp(store, "film", film_config, {}), 0.1);
  std::vector<float> encoding;
  bench.run("hash forward", [&](const Exec& exec) { hash.forward(exec, store, queries, encoding); });
  bench.run_sums("hash backward", [&](const Exec& exec) { hash.backward(exec, store, queries, encoding); });
  const FilmMlpInputs in{{encoding.data(), kQueries, 16}, {rbf.feature.data(), kQueries, 3}, queries, 1};
  bench.run("film forward and backward", [&](const Exec& exec) {
    FilmMlpOutput out;
    film.forward(exec, store, in, out);
    FilmMlpGradients grads;
    film.backward(exec, store, in, {out, out.density, out.rgb}, grads);
  });
}

/// Seconds of one step; kernel times are of 4 steps.
void joint(Bench& bench, std::int64_t gaussians) {
  const JointSteps steps(gaussians);
  const auto nothing = [](bool) {};
  const double cpu_s = steps.seconds(bench.cpu, 4, nothing);
  struct How {
    const char* name;
    const Exec& exec;
  };
  for (const auto& [name, exec] : {How{"joint step", bench.device}, How{"joint step, atomic sums", bench.atomic}}) {
    Json one{{"name", name + (", " + std::to_string(steps.gaussians())) + " Gaussians"},
             {"cpu_s", cpu_s},
             {"device_s", steps.seconds(exec, 8, nothing)},
             {"kernels", Json::array()}};
    std::vector<KernelTime> kernels;
    steps.seconds(exec, 4, [&kernels](bool begins) {
      if (begins) profile_device();
      if (!begins) kernels = device_times();
    });
    for (const KernelTime& k : kernels)
      one["kernels"].push_back({{"name", k.name}, {"launches", k.launches}, {"seconds", k.seconds}});
    bench.cases.push_back(std::move(one));
  }
}

}  // namespace
}  // namespace ngs::bench

int main() {
  using namespace ngs;
  const DeviceInfo device = cuda_device();
  if (!device.usable) {
    std::cerr << "skipped: " << device.reason << "\n";
    return 77;
  }
  const int threads = int(std::thread::hardware_concurrency());
  const auto on_device = [&](DeviceSums sums) {
    return Exec{.device = Device::kCuda, .threads = threads, .device_ops = cuda_ops(sums)};
  };
  bench::Bench all{Exec{.threads = threads}, on_device(DeviceSums::kInOrder), on_device(DeviceSums::kAtomic)};
  bench::field(all);
  for (const std::int64_t gaussians : {100000, 1000000}) bench::splat(all, gaussians);
  bench::joint(all, 200000);
  std::cout << bench::Json{{"device", device.name},
                           {"threads", threads},
                           {"copy_bytes_per_s", device_copy_bandwidth(std::size_t(1) << 29)},
                           {"cases", all.cases}}
                   .dump(2)
            << "\n";
}
