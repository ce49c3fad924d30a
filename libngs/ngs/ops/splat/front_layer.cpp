#include "ngs/ops/splat/front_layer.h"

#include <optional>

#include "ngs/core/check.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/splat/binned_view.h"
#include "ngs/ops/splat/cloud_view.h"
#include "ngs/ops/splat/splat_tiles.h"
#include "ngs/ops/splat/splat_view.h"

namespace ngs {
namespace {

using L = PackF;
constexpr int kPacks = kPacksPerTile<L>;

/// Loads a plane of the image into the tile's packs; 0 outside the image.
template <class T>
void tile_plane(const TileFrame& frame, const std::vector<T>& image, L* packs) {
  float lane[kTilePixels] = {};
  for (int y = 0; y < frame.rows(); ++y)
    for (int x = 0; x < frame.columns(); ++x) lane[place_in_packs<L>(x, y)] = float(image[frame.pixel(x, y)]);
  for (int i = 0; i < kPacks; ++i) load_lanes(lane + i * L::kLanes, packs[i]);
}

/// Common part of both sinks: the current Gaussian, whether it is a candidate, and its weight in front.
struct FrontBase {
  static constexpr bool kTakesEmpty = true;
  const BinnedView<float>& binned;
  TileWork<float> work;
  const std::vector<std::uint8_t>& candidate;
  L limit[kPacks];
  std::size_t v = 0;
  bool is_candidate = false;
  float depth = 0;

  void enter(std::uint32_t entry) {
    v = work.visible[entry];
    is_candidate = candidate[binned.view().id[v]] != 0;
    depth = binned.view().depth[v];
  }
  L front_weight(const Contribution<L>& hit) const {
    return select(L(depth) < limit[hit.pack], hit.alpha * hit.transmittance, L(0.f));
  }
};

/// Whether a pixel of the tile has a surface; without one nothing is in front.
bool has_surface(const L* limit) {
  bool some = false;
  for (int i = 0; i < kPacks; ++i) some |= any(limit[i] > L(0.f));
  return some;
}

struct LayerSink : FrontBase {
  const std::uint32_t* number;  // [N] row of `value` per Gaussian; null: there are no columns
  Matrix<const float> value;
  std::vector<L> sum;  // [C + 1, packs]

  void begin(std::uint32_t entry) { enter(entry); }
  void begin_column(int) {}
  void add(int, const Contribution<L>& hit) {
    if (!is_candidate) return;
    const L weight = front_weight(hit);
    const float* row = number ? value.row(number[binned.view().id[v]]) : nullptr;
    for (int c = 0; c < value.c; ++c) {
      L& s = sum[std::size_t(c * kPacks + hit.pack)];
      s = fma_lanes(weight, L(row[c]), s);
    }
    sum[std::size_t(value.c * kPacks + hit.pack)] += weight;
  }
  void end_column(int) {}
  void end() {}
};

struct SumSink : FrontBase {
  Matrix<float> pair;  // [pairs, 2]
  L marked[kPacks];
  L front = L(0.f), of_marked = L(0.f), all_front = L(0.f), all_marked = L(0.f);  // of a column, of the tile
  std::uint32_t entry = 0;

  void begin(std::uint32_t e) {
    enter(entry = e);
    all_front = all_marked = L(0.f);
  }
  void begin_column(int) { front = of_marked = L(0.f); }
  void add(int, const Contribution<L>& hit) {
    if (!is_candidate) return;
    const L weight = front_weight(hit);
    front += weight;
    of_marked = fma_lanes(weight, marked[hit.pack], of_marked);
  }
  void end_column(int) {
    all_front += front;
    all_marked += of_marked;
  }
  void end() {
    if (!is_candidate) return;
    float* row = pair.row(work.slot[entry]);
    row[0] = sum_lanes(all_front);
    row[1] = sum_lanes(all_marked);
  }
};

void store_tile(const TileFrame& frame, const std::vector<L>& sum, ImageF& out) {
  float lane[kTilePixels];
  for (int c = 0; c < out.channels; ++c) {
    for (int i = 0; i < kPacks; ++i) store_lanes(lane + i * L::kLanes, sum[std::size_t(c * kPacks + i)]);
    for (int y = 0; y < frame.rows(); ++y)
      for (int x = 0; x < frame.columns(); ++x)
        out.at(frame.x_px + x, frame.y_px + y, c) = lane[place_in_packs<L>(x, y)];
  }
}

}  // namespace

struct FrontView::State {
  Exec exec;
  Camera camera;
  Compat compat;
  std::int64_t gaussians;
  const ImageF& limit;
  std::optional<BinnedView<float>> binned = {};
  std::unique_ptr<DeviceFrontView> on_device = nullptr;  // instead of `binned`

  void check(const Candidates& candidate) const {
    NGS_CHECK(std::int64_t(candidate.size()) == gaussians, "one candidate flag per Gaussian");
  }
};

FrontView::FrontView(const Exec& exec, const GaussianCloud& cloud, const ImageF& limit, const Camera& camera,
                     const SplatOptions& options) {
  NGS_CHECK(limit.width_px == camera.width_px && limit.height_px == camera.height_px && limit.channels == 1,
            "one limit per pixel");
  state_ = std::make_unique<State>(State{exec, camera, options.compat, cloud.size(), limit});
  const CloudView<float> columns = cloud_view(cloud, 0, nullptr);
  const Camera relative = relative_camera(camera, cloud);
  if (exec.device_ops)
    state_->on_device =
        exec.device_ops->splat.front_view(view_projector<float>(relative, options), on_host(columns, options), limit);
  else
    state_->binned.emplace(exec, columns, relative, options, CullRequest{.max_depth = &limit});
}
FrontView::~FrontView() = default;

ImageF FrontView::layer(const RowValues& values) const {
  NGS_CHECK(values.value.n == values.of.size(), "one value row per candidate");
  return layer(values.of.chosen, values.of.number.data(), values.value);
}

ImageF FrontView::layer(const Candidates& candidate) const { return layer(candidate, nullptr, {nullptr, 0, 0}); }

ImageF FrontView::layer(const Candidates& candidate, const std::uint32_t* number, Matrix<const float> value) const {
  const State& s = *state_;
  s.check(candidate);
  ImageF out(s.camera.width_px, s.camera.height_px, value.c + 1);
  if (s.on_device) {
    s.on_device->layer(candidate.data(), number, value, out);
    return out;
  }
  const BinnedView<float>& b = *s.binned;
  for_each_task(s.exec, b.lists().tiles(), [&](std::int64_t tile) {
    const TileWork<float> work = tile_work(b.view(), b.lists(), tile, s.camera, s.compat);
    const TileFrame& frame = work.frame;
    LayerSink sink{
        {b, work, candidate, {}}, number, value, std::vector<L>(std::size_t((value.c + 1) * kPacks), L(0.f))};
    tile_plane(frame, s.limit.data, sink.limit);
    if (!has_surface(sink.limit)) return;
    L transmittance[kPacks];
    composite_tile<L>(work, transmittance, sink);
    store_tile(frame, sink.sum, out);
  });
  return out;
}

ViewSums FrontView::sums(const Candidates& candidate, const std::vector<std::uint8_t>& marked) const {
  const State& s = *state_;
  s.check(candidate);
  NGS_CHECK(std::int64_t(marked.size()) == s.limit.pixels(), "one mark per pixel");
  ViewSums sums{1, false, {}, {}};
  if (s.on_device) {
    const ViewSums all = s.on_device->sums(candidate.data(), marked);
    for (std::size_t v = 0; v < all.size(); ++v) {
      const double sum[2] = {all.weight(v), all.object_weight(v, 0)};
      sums.add(all.row[v], sum);
    }
    return sums;
  }
  const BinnedView<float>& b = *s.binned;
  std::vector<float> pairs(std::size_t(b.lists().pairs()) * 2, 0.f);
  const Matrix<float> pair{pairs.data(), b.lists().pairs(), 2};
  for_each_task(s.exec, b.lists().tiles(), [&](std::int64_t tile) {
    const TileWork<float> work = tile_work(b.view(), b.lists(), tile, s.camera, s.compat);
    const TileFrame& frame = work.frame;
    SumSink sink{{b, work, candidate, {}}, pair, {}};
    tile_plane(frame, s.limit.data, sink.limit);
    if (!has_surface(sink.limit)) return;
    tile_plane(frame, marked, sink.marked);
    L transmittance[kPacks];
    composite_tile<L>(work, transmittance, sink);
  });
  for (std::size_t v = 0; v < b.view().id.size(); ++v) {
    if (!candidate[b.view().id[v]]) continue;
    double sum[2] = {};  // in front, and marked
    for (std::int64_t slot = b.lists().slot_begin[v]; slot < b.lists().slot_begin[v + 1]; ++slot) {
      sum[0] += double(pair.row(slot)[0]);
      sum[1] += double(pair.row(slot)[1]);
    }
    if (sum[0] > 0) sums.add(b.view().id[v], sum);
  }
  return sums;
}

}  // namespace ngs
