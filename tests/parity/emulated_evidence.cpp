// Evidence of loops over views on the emulated device: what it copies, and that its sums are the CPU's.
#include <algorithm>

#include "ngs/ops/image/pixel_window.h"
#include "ngs/ops/splat/evidence.h"
#include "parity/traffic.h"
#include "support/joint_case.h"
#include "support/same_evidence.h"

namespace ngs::test {
namespace {

/// Pixels of the window of a view's masks.
std::size_t window_pixels(const ViewMasks& masks) {
  const PixelWindow w = window_of(masks.target, masks.width_px, masks.height_px, 0);
  return std::size_t(w.w) * std::size_t(w.h);
}

/// What the evidence of a loop over views copies to the host.
std::size_t evidence_bytes(const Evidence& e, std::size_t views) {
  std::size_t touched = 0;
  for (std::size_t i = 0; i < e.views.size(); ++i)
    e.object_weights.for_each_in(i, [&](std::size_t, const ObjectSums&) { ++touched; });
  return e.views.size() * (3 * sizeof(std::uint64_t) + sizeof(std::uint32_t)) +
         touched * sizeof(Evidence::DeferredInserts::value_type) + (views + 1) * sizeof(std::int64_t);
}

}  // namespace

TEST_CASE("residency: evidence of many views copies the model once, the masks' windows, and its sums once") {
  const auto c = joint_case(600, 400);
  Emulated device(ThreadOrder::kAscending, DeviceSums::kInOrder, true);
  const auto load = [&](std::size_t v) { return c->masks[v]; };
  const auto evidence_of = [&](const Exec& exec, const std::vector<std::size_t>& views) {
    return accumulate_evidence(exec, test::Quiet(), {c->model, c->scene, views, {}, load});
  };
  const std::vector<std::size_t> one{0}, all{0, 1, 2, 3};
  const Traffic first = traffic_of(device, [&] { evidence_of(device.exec(), one); });
  Evidence got;
  const Traffic four = traffic_of(device, [&] { got = evidence_of(device.exec(), all); });
  const Evidence want = evidence_of({}, all);
  CHECK(same_evidence(got, want));
  print("evidence of one view", first);
  print("evidence of four views", four);
  std::size_t windows = 0;
  for (std::size_t v = 1; v < 4; ++v) {
    CHECK(window_pixels(c->masks[v]) < 48 * 40 / 2);
    windows += window_pixels(c->masks[v]) * sizeof(float);
  }
  CHECK(first.up_bytes == geometry_bytes(c->model) + window_pixels(c->masks[0]) * sizeof(float));
  CHECK(four.up_bytes == first.up_bytes + windows);
  CHECK(first.down_bytes == evidence_bytes(evidence_of({}, one), 1));
  CHECK(four.down_bytes == evidence_bytes(want, 4));
}

TEST_CASE("residency: evidence summed in device memory equals the CPU's, for any number of objects and any view") {
  const auto c = joint_case(300, 200);
  for (const ThreadOrder order : {ThreadOrder::kAscending, ThreadOrder::kDescending, ThreadOrder::kShuffled})
    for (const std::size_t objects : {0, 1, 5})
      for (const std::size_t missing : {0, 2, 9}) {  // view without masks
        std::vector<ViewMasks> masks = c->masks;
        for (std::size_t v = 0; v < masks.size(); ++v) {
          const std::vector<float> ball = masks[v].target[0];
          masks[v].target.assign(objects, ball);
          for (std::size_t k = 1; k < objects; ++k)  // parts of the ball, the last one empty
            for (std::size_t p = 0; p < ball.size(); ++p) masks[v].target[k][p] *= k < 4 && p % (k + 1) == v % 2;
          masks[v].available = v != missing;
        }
        masks[1].known.assign(masks[1].width_px * 40, 1);
        std::fill_n(masks[1].known.begin(), 900, std::uint8_t(0));
        Emulated device(order, DeviceSums::kInOrder, true);
        EvidenceSum got(device.exec(), c->model, int(objects), {}), want({}, c->model, int(objects), {});
        for (std::size_t v = 0; v < masks.size(); ++v)
          for (EvidenceSum* const sum : {&got, &want}) sum->add({c->scene.views[v].camera, masks[v]});
        const Evidence all = want.result();
        CHECK(std::ranges::count(all.views, missing < 4 ? 3u : 4u) > 100);
        CHECK(same_evidence(got.result(), all));
      }
}

TEST_CASE(
    "residency: evidence without a view or a Gaussian is empty; a model that is too large is summed view by view") {
  const auto c = joint_case(30, 20);
  Emulated device(ThreadOrder::kAscending, DeviceSums::kInOrder, true);
  CHECK(same_evidence(EvidenceSum(device.exec(), c->model, 2, {}).result(), Evidence(50, 2)));
  const GaussianCloud none;
  EvidenceSum of_none(device.exec(), none, 1, {});
  of_none.add({c->scene.views[0].camera, c->masks[0]});
  CHECK(same_evidence(of_none.result(), Evidence(0, 1)));
  constexpr int kObjects = 1 << 20;  // 50 Gaussians take 3 GB
  const Traffic many = traffic_of(device, [&] { EvidenceSum(device.exec(), c->model, kObjects, {}).result(); });
  CHECK(many.allocations == 0);
}

}  // namespace ngs::test
