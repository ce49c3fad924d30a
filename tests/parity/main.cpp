// Runs map-type kernels on the CPU and on a CUDA device with the same inputs and compares. Exit code 77 =
// skipped: no device. The device may fuse products, so results agree to rounding, not bit for bit.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "ngs/backend/for_each_cuda.h"
#include "ngs/ops/hash_grid.h"
#include "ngs/ops/knn.h"
#include "ngs/ops/rbf_kernels.h"
#include "ngs/ops/volume_kernels.h"
#include "support/random.h"

namespace ngs {
namespace {

constexpr int kSkipped = 77;
int failures = 0;

/// A copy of `host` on the device for the life of the object.
template <class T>
class OnDevice {
 public:
  explicit OnDevice(const std::vector<T>& host)
      : host_(host), data_(device_allocate(host.size() * sizeof(T))) {
    copy_to_device(data_, host.data(), host.size() * sizeof(T));
  }
  ~OnDevice() { device_free(data_); }
  OnDevice(const OnDevice&) = delete;
  OnDevice& operator=(const OnDevice&) = delete;
  T* data() const { return static_cast<T*>(data_); }
  std::vector<T> back() const {
    std::vector<T> result(host_.size());
    copy_to_host(result.data(), data_, result.size() * sizeof(T));
    return result;
  }
  bool unchanged() const { return back() == host_; }

 private:
  std::vector<T> host_;
  void* data_;
};

void expect(bool ok, const char* what) {
  std::printf("%s: %s\n", what, ok ? "ok" : "FAILED");
  failures += !ok;
}

/// Largest difference relative to the largest value: sums of few terms of one size, so a few ulp.
bool close(const std::vector<float>& got, const std::vector<float>& want) {
  float largest = 0, worst = 0;
  for (std::size_t i = 0; i < want.size(); ++i) {
    if (!std::isfinite(got[i])) return false;
    largest = std::max(largest, std::abs(want[i])), worst = std::max(worst, std::abs(got[i] - want[i]));
  }
  return worst <= 1e-5f * largest;
}

template <class Kernel>
void run_cpu(std::int64_t n, const Kernel& kernel) {
  for (std::int64_t i = 0; i < n; ++i) kernel(i);
}

void rbf_parity() {
  constexpr std::int64_t kQueries = 5000, kPoints = 300;
  test::Random random(1);
  const auto q = random.uniform_vector<float>(kQueries * 3, -1.5, 1.5),
             x = random.uniform_vector<float>(kPoints * 3, -1, 1);
  const auto f = random.uniform_vector<float>(kPoints * 3, 0, 1);
  const KnnGraph graph = nearest_points({}, {x.data(), kPoints}, {q.data(), kQueries}, 8);
  std::vector<float> weight(kQueries * 8), out(kQueries * 3), grad(kPoints * 3);
  const OnDevice<float> dq(q), dx(x), df(f), dw(weight), dout(out), dgrad(grad);
  const OnDevice<std::uint32_t> dindex(graph.index);
  const OnDevice<std::int64_t> drow(graph.row_begin), dedge(graph.edge);
  run_cpu(kQueries, RbfForward<float>{{q.data(), kQueries},
                                      {x.data(), kPoints},
                                      graph.indices(),
                                      {f.data(), kPoints, 3},
                                      4.f,
                                      {weight.data(), kQueries, 8},
                                      {out.data(), kQueries, 3}});
  for_each_index_cuda({}, kQueries,
                      RbfForward<float>{{dq.data(), kQueries},
                                        {dx.data(), kPoints},
                                        {dindex.data(), kQueries, 8},
                                        {df.data(), kPoints, 3},
                                        4.f,
                                        {dw.data(), kQueries, 8},
                                        {dout.data(), kQueries, 3}});
  expect(close(dw.back(), weight), "rbf weights");
  expect(close(dout.back(), out), "rbf features");
  run_cpu(kPoints, RbfBackwardFeature<float>{graph.row_begin.data(),
                                             graph.edge.data(),
                                             {weight.data(), kQueries, 8},
                                             {out.data(), kQueries, 3},
                                             {grad.data(), kPoints, 3}});
  for_each_index_cuda({}, kPoints,
                      RbfBackwardFeature<float>{drow.data(),
                                                dedge.data(),
                                                {dw.data(), kQueries, 8},
                                                {dout.data(), kQueries, 3},
                                                {dgrad.data(), kPoints, 3}});
  expect(close(dgrad.back(), grad), "rbf feature gradient");
  expect(dq.unchanged() && dx.unchanged() && df.unchanged() && dindex.unchanged(),
         "rbf leaves its inputs alone");
}

void hash_parity() {
  constexpr std::int64_t kQueries = 5000;
  const HashGridConfig config;
  test::Random random(2);
  const std::vector<HashLevel> level = hash_levels(config);
  const auto table = random.uniform_vector<float>((level.back().offset + level.back().size) * 2, -1, 1);
  const auto p = random.uniform_vector<float>(kQueries * 3, -0.2, 1.2),
             u = random.uniform_vector<float>(kQueries * 16, -1, 1);
  std::vector<float> out(kQueries * 16), grad(kQueries * 3);
  const OnDevice<float> dtable(table), dp(p), du(u), dout(out), dgrad(grad);
  void* dlevel = device_allocate(level.size() * sizeof(HashLevel));
  copy_to_device(dlevel, level.data(), level.size() * sizeof(HashLevel));
  const HashBox<float> box{{0.5f, 0.5f, 0.5f}, {1, 1, 1}};
  const HashGridView<float> host{level.data(), config.levels, box, true, table.data(), {p.data(), kQueries}};
  const HashGridView<float> device{
      static_cast<const HashLevel*>(dlevel), config.levels, box, true, dtable.data(), {dp.data(), kQueries}};
  run_cpu(kQueries * config.levels, HashForward<float, 2>{host, out.data()});
  for_each_index_cuda({}, kQueries * config.levels, HashForward<float, 2>{device, dout.data()});
  // A point within rounding of a cell face may fall on either side; the blend is continuous there.
  expect(close(dout.back(), out), "hash features");
  run_cpu(kQueries, HashBackwardPosition<float, 2>{host, u.data(), {grad.data(), kQueries}});
  for_each_index_cuda({}, kQueries,
                      HashBackwardPosition<float, 2>{device, du.data(), {dgrad.data(), kQueries}});
  expect(close(dgrad.back(), grad), "hash position gradient");  // smoothstep: continuous across faces
  expect(dtable.unchanged() && dp.unchanged(), "hash grid leaves its inputs alone");
  device_free(dlevel);
}

void volume_parity() {
  constexpr std::int64_t kRays = 2000;
  constexpr int kSamples = 8;
  test::Random random(3);
  const auto density = random.uniform_vector<float>(kRays * kSamples, 0, 8),
             rgb = random.uniform_vector<float>(kRays * kSamples * 3, 0, 1);
  const auto spacing = random.uniform_vector<float>(kRays, 0.01, 0.3),
             u = random.uniform_vector<float>(kRays * 3, -1, 1);
  std::vector<float> colour(kRays * 3), alpha(kRays), depth(kRays), weight(density.size()),
      after(density.size());
  std::vector<float> gd(density.size()), gc(rgb.size());
  const OnDevice<float> dd(density), dc(rgb), ds(spacing), du(u), dcolour(colour), dalpha(alpha),
      ddepth(depth), dweight(weight), dafter(after), dgd(gd), dgc(gc);
  const VolumeRays<float> host{kRays,      kSamples,       density.data(),
                               rgb.data(), spacing.data(), {0.1f, 0.2f, 0.3f}};
  const VolumeRays<float> device{kRays, kSamples, dd.data(), dc.data(), ds.data(), {0.1f, 0.2f, 0.3f}};
  run_cpu(kRays,
          VolumeForward<float>{host, colour.data(), alpha.data(), depth.data(), weight.data(), after.data()});
  for_each_index_cuda({}, kRays,
                      VolumeForward<float>{device, dcolour.data(), dalpha.data(), ddepth.data(),
                                           dweight.data(), dafter.data()});
  expect(close(dcolour.back(), colour) && close(dalpha.back(), alpha) && close(ddepth.back(), depth),
         "volume colour, alpha, depth");
  run_cpu(kRays, VolumeBackward<float>{host, weight.data(), after.data(), u.data(), alpha.data(), nullptr,
                                       gd.data(), gc.data()});
  for_each_index_cuda({}, kRays,
                      VolumeBackward<float>{device, dweight.data(), dafter.data(), du.data(), dalpha.data(),
                                            nullptr, dgd.data(), dgc.data()});
  expect(close(dgd.back(), gd) && close(dgc.back(), gc), "volume gradients");
}

}  // namespace
}  // namespace ngs

int main() {
  if (!ngs::device_present()) {
    std::puts("skipped: no device");
    return ngs::kSkipped;
  }
  ngs::rbf_parity();
  ngs::hash_parity();
  ngs::volume_parity();
  return ngs::failures == 0 ? 0 : 1;
}
