#include "ngs/ops/splat/cached/cached_view.h"

#include <algorithm>

#include "ngs/core/check.h"
#include "ngs/math/row_ranks.h"
#include "ngs/ops/splat/cloud_view.h"
#include "ngs/ops/splat/tile_isa.h"
#include "ngs/ops/splat/view_planes.h"

namespace ngs {
namespace {

constexpr std::size_t kColumns = 4;       // per (Gaussian, tile) pair: weight, pixels, and both inside the mask
constexpr std::int64_t kChunk = 1 << 12;  // visible Gaussians per task

}  // namespace

struct CachedView::State {
  SplatEngine<float> engine;
  ViewSums sums{1, false, {}, {}};        // of rows()
  std::vector<std::uint32_t> place = {};  // [V] index into `sums`, in the order of the engine's view
  std::vector<float> target = {};         // [H·W] the last mask; empty before the first one
};

CachedView::CachedView(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& options)
    : camera_(camera) {
  NGS_CHECK(!exec.device_ops, "a cached view needs the CPU");
  state_ = std::make_unique<State>(
      State{{float_tile_kernels(exec.isa), options, cloud_view(cloud, options.max_sh_degree, nullptr),
             relative_camera(camera, cloud), channel_plan(RenderRequest{.colour = false, .label = {}})}});
  State& s = *state_;
  s.engine.prepare(exec);
  const std::vector<std::uint32_t>& id = s.engine.view().id;
  RowRanks ranks(cloud.size());
  ranks.add(id);
  ranks.count();
  s.sums.row.resize(id.size());
  s.sums.sum.resize(2 * id.size());
  s.place.resize(id.size());
  for (std::size_t v = 0; v < id.size(); ++v) {
    s.place[v] = std::uint32_t(ranks.of(id[v]));
    s.sums.row[s.place[v]] = id[v];
  }
}

CachedView::~CachedView() = default;

const std::vector<std::uint32_t>& CachedView::rows() const { return state_->sums.row; }

RenderedView CachedView::render(const Exec& exec, const RenderRequest& request) {
  NGS_CHECK(request.include == nullptr, "a cached view renders all Gaussians");
  const ChannelPlan<float> plan = channel_plan(request);
  RenderedView view;
  allocate(camera_, plan, view);
  state_->engine.set_channels(exec, plan);
  state_->engine.composite(exec, planes<float>(plan, view));
  return view;
}

std::vector<std::uint8_t> CachedView::update_mask(const PixelMask& mask) {
  const int w = camera_.width_px, h = camera_.height_px;
  NGS_CHECK(mask.size() == std::size_t(w) * std::size_t(h), "mask size");
  std::vector<float>& target = state_->target;
  const TileLists& lists = state_->engine.lists();
  const bool first = target.empty();
  target.resize(mask.size());
  std::vector<std::uint8_t> tiles(std::size_t(lists.tiles()), std::uint8_t(first));
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const std::size_t p = std::size_t(y) * std::size_t(w) + std::size_t(x);
      if (target[p] == float(mask[p])) continue;
      target[p] = float(mask[p]);
      tiles[std::size_t(y / kTilePx) * std::size_t(lists.tiles_x) + std::size_t(x / kTilePx)] = 1;
    }
  return tiles;
}

std::vector<std::uint8_t> CachedView::in_tiles(const std::vector<std::uint8_t>& tiles) const {
  const TileLists& lists = state_->engine.lists();
  std::vector<std::uint8_t> in(rows().size());
  for (std::size_t t = 0; t < tiles.size(); ++t)
    for (std::int64_t e = lists.tile_begin[t]; tiles[t] && e < lists.tile_begin[t + 1]; ++e)
      in[lists.visible[std::size_t(e)]] = 1;
  return in;
}

const ViewSums& CachedView::weigh(const Exec& exec, const PixelMask& mask) {
  State& s = *state_;
  const TileLists& lists = s.engine.lists();
  const std::vector<std::uint8_t> tiles = update_mask(mask), changed = in_tiles(tiles);
  const TileKernels<float> kernels = float_tile_kernels(exec.isa);
  std::vector<float>& pairs = s.engine.binned().sums(std::size_t(lists.pairs()) * kColumns);  // by slot
  for_each_task(exec, lists.tiles(), [&](std::int64_t tile) {
    static thread_local TileScratch<float> scratch;
    const float* const target = s.target.data();
    if (tiles[std::size_t(tile)])
      kernels.evidence({s.engine.work(tile), nullptr, &target, 1, pairs.data(), scratch.values(evidence_scratch(1))});
  });
  const std::size_t visible = rows().size();
  for_each_task(exec, (std::int64_t(visible) + kChunk - 1) / kChunk, [&](std::int64_t chunk) {
    const std::size_t end = std::min(visible, std::size_t((chunk + 1) * kChunk));
    for (auto v = std::size_t(chunk * kChunk); v < end; ++v) {
      if (!changed[v]) continue;
      double sum[kColumns] = {};
      add_slots(lists, v, pairs.data(), kColumns, sum);
      double* const to = &s.sums.sum[2 * s.place[v]];
      to[0] = sum[0];
      to[1] = std::min(sum[2], sum[0]);
    }
  });
  return s.sums;
}

}  // namespace ngs
