#include "ngs/ops/labels/label_system.h"

#include <atomic>
#include <optional>

#include "ngs/core/check.h"
#include "ngs/ops/losses/loss_mask_kernels.h"
#include "ngs/ops/splat/binned_view.h"
#include "ngs/ops/splat/cloud_view.h"
#include "ngs/ops/splat/splat_view.h"
#include "ngs/ops/splat/tile_isa.h"

namespace ngs {
namespace {

/// m and 1 - m of the columns as floats.
struct FloatColumns {
  std::vector<float> m, rest;
  void assign(const std::vector<double>& value) {
    m.resize(value.size());
    rest.resize(value.size());
    for (std::size_t i = 0; i < value.size(); ++i) {
      m[i] = float(value[i]);
      rest[i] = float(1 - value[i]);
    }
  }
  ColumnValues view() const { return {m.data(), rest.data()}; }
};

/// Bytes of a block in the cache; 0 if no column reaches it.
std::int64_t cache_bytes_of(const LabelBlock& block) { return block.entry.empty() ? 0 : block.bytes(); }

/// One view, composited for label sums.
struct OpenView {
  Camera camera;
  std::optional<BinnedView<float>> binned;  // if there are targets
  PixelTargets targets;

  OpenView(const Exec& exec, const LabelProblem& problem, std::size_t index)
      : camera(relative_camera(problem.cameras[index], problem.cloud)), targets(problem.load_targets(index)) {
    if (targets.inside.empty()) return;
    const auto pixels = std::size_t(camera.width_px) * std::size_t(camera.height_px);
    NGS_CHECK(targets.inside.size() == pixels && targets.outside.size() == pixels, "target size");
    binned.emplace(exec, cloud_view(problem.cloud, 0, nullptr), camera, problem.splat);
  }
  bool empty() const { return targets.inside.empty(); }
  const ProjectedView<float>& view() const { return binned->view(); }
  const TileLists& lists() const { return binned->lists(); }
  TargetPlanes planes() const { return {targets.inside.data(), targets.outside.data()}; }
  /// Calls f(tile, its contributions) for every tile.
  template <class F>
  void for_each_recorded(const Exec& exec, Compat compat, const F& f) const {
    const TileKernels<float> kernels = float_tile_kernels(exec.isa);
    for_each_task(exec, lists().tiles(), [&](std::int64_t tile) {
      static thread_local TileScratch<float> scratch;
      const RecordedTile recorded{tile_work(view(), lists(), tile, camera, compat), scratch.tape, kernels.lanes,
                                  scratch.values(kTilePixels)};
      kernels.record(recorded.work, scratch.tape, recorded.transmittance);
      f(std::size_t(tile), recorded);
    });
  }
  /// Calls f(Gaussian, first slot, end slot) for every visible Gaussian; f may write data of that Gaussian only.
  template <class F>
  void for_each_visible(const Exec& exec, const F& f) const {
    for_each_index(exec, std::int64_t(view().id.size()), [&](std::int64_t v) {
      f(view().id[std::size_t(v)], std::size_t(lists().slot_begin[std::size_t(v)]),
        std::size_t(lists().slot_begin[std::size_t(v) + 1]));
    });
  }
};

}  // namespace

struct LabelSystem::State {
  const LabelProblem& problem;
  std::vector<std::int32_t> column_of;
  std::vector<double> label;
  std::int64_t columns = 0;
  std::vector<std::vector<LabelBlock>> block;  // [cached views][tiles with columns]
  std::vector<std::size_t> streamed;           // cameras after the cached ones
  std::vector<std::int64_t> slot_begin;        // [columns + 1] into slots
  mutable std::vector<SlotSums> slots;
  struct Constants {
    double loss = 0, target_sum = 0;
  };
  Constants of_cached, of_streamed;  // views
  Stats stats;
  LabelSums start;

  State(const LabelProblem& p, std::vector<std::int32_t> columns_of, std::vector<double> labels)
      : problem(p), column_of(std::move(columns_of)), label(std::move(labels)) {
    NGS_CHECK(std::int64_t(column_of.size()) == p.cloud.size() && label.size() == column_of.size(),
              "label system shape");
    for (const std::int32_t c : column_of) columns = std::max(columns, std::int64_t(c) + 1);
  }
  double target_sum() const { return of_cached.target_sum + of_streamed.target_sum; }
  void open_view(const Exec& exec, std::size_t camera, std::int64_t cache_bytes);
  void open_streamed(const Exec& exec);
  /// True if blocks of `bytes` fit the cache. After the first view that does not fit, all later views are streamed too,
  /// so that sums keep the order of the views.
  bool fits(std::int64_t bytes, std::int64_t cache_bytes) const {
    return streamed.empty() && stats.cached_bytes + bytes <= cache_bytes;
  }
  /// Caches `tiles`, which take `bytes`, if they fit; false if not. The tiles of a view that does not fit
  /// may be incomplete.
  bool add_view(std::vector<LabelBlock> tiles, std::int64_t bytes, std::int64_t cache_bytes);
  void number_slots();
  TileLoss stream(const Exec& exec, const OpenView& open, ColumnValues at, LabelSums& out) const;
};

/// Collects the view's blocks and caches them while they fit. Blocks that do not fit are dropped tile by tile: a view
/// may have far more contributions than the cache can hold.
void LabelSystem::State::open_view(const Exec& exec, std::size_t camera, std::int64_t cache_bytes) {
  const OpenView open(exec, problem, camera);
  if (open.empty()) return;
  std::vector<LabelBlock> tiles(std::size_t(open.lists().tiles()));
  const LabelPlaces places{open.view().id.data(), column_of.data(), label.data()};
  std::atomic<std::int64_t> bytes = 0;
  open.for_each_recorded(exec, problem.splat.compat, [&](std::size_t tile, const RecordedTile& recorded) {
    LabelBlock block = collect_block(recorded, places, open.planes(), problem.half_weights);
    bytes += cache_bytes_of(block);
    if (fits(bytes, cache_bytes))
      tiles[tile] = std::move(block);
    else
      tiles[tile].target_sum = block.target_sum;
  });
  if (!add_view(std::move(tiles), bytes, cache_bytes)) {
    streamed.push_back(camera);
    ++stats.streamed_views;
  }
}

/// Without a cache: one traversal gives the constants and the sums at the given labels.
void LabelSystem::State::open_streamed(const Exec& exec) {
  std::vector<double> m(std::size_t(columns), 0.0);
  for (std::size_t i = 0; i < column_of.size(); ++i)
    if (column_of[i] >= 0) m[std::size_t(column_of[i])] = label[i];
  FloatColumns at;
  at.assign(m);
  start.inside.assign(m.size(), 0.0);
  start.outside.assign(m.size(), 0.0);
  double loss = 0;
  for (std::size_t camera = 0; camera < problem.cameras.size(); ++camera) {
    const OpenView open(exec, problem, camera);
    if (open.empty()) continue;
    const TileLoss view = stream(exec, open, at.view(), start);
    loss += view.loss;
    of_streamed.target_sum += view.target_sum;
    streamed.push_back(camera);
    ++stats.streamed_views;
  }
  start.loss = target_sum() > 0 ? loss / target_sum() : 0.0;
}

bool LabelSystem::State::add_view(std::vector<LabelBlock> tiles, std::int64_t bytes, std::int64_t cache_bytes) {
  const bool cached = fits(bytes, cache_bytes);
  Constants& constants = cached ? of_cached : of_streamed;
  for (const LabelBlock& t : tiles) constants.target_sum += t.target_sum;
  if (!cached) return false;
  for (const LabelBlock& t : tiles) constants.loss += t.constant_loss;
  stats.cached_bytes += bytes;
  ++stats.cached_views;
  std::erase_if(tiles, [](const LabelBlock& t) { return t.entry.empty(); });
  block.push_back(std::move(tiles));
  return true;
}

/// Gives the (column, tile) pairs of the cache their slots: column by column, each in order of (view, tile).
void LabelSystem::State::number_slots() {
  slot_begin.assign(std::size_t(columns) + 1, 0);
  for (const auto& view : block)
    for (const LabelBlock& b : view)
      for (const LabelBlock::Entry& e : b.entry) ++slot_begin[e.column + 1];
  for (std::size_t c = 0; c < std::size_t(columns); ++c) slot_begin[c + 1] += slot_begin[c];
  NGS_CHECK(slot_begin.back() < std::int64_t(1) << 32, "slots fit 32 bits");
  std::vector<std::int64_t> next(slot_begin.begin(), slot_begin.end() - 1);
  for (auto& view : block)
    for (LabelBlock& b : view)
      for (LabelBlock::Entry& e : b.entry) e.slot = std::uint32_t(next[e.column]++);
  slots.resize(std::size_t(slot_begin.back()));
}

/// Adds the sums of one streamed view; returns its loss.
TileLoss LabelSystem::State::stream(const Exec& exec, const OpenView& open, ColumnValues at, LabelSums& out) const {
  const std::size_t visible = open.view().id.size();
  std::vector<float> m(visible), rest(visible);
  for (std::size_t v = 0; v < visible; ++v) {
    const std::uint32_t gaussian = open.view().id[v];
    const std::int32_t column = column_of[gaussian];
    m[v] = column >= 0 ? at.m[column] : float(label[gaussian]);
    rest[v] = column >= 0 ? at.rest[column] : float(1 - label[gaussian]);
  }
  std::vector<SlotSums> pair(std::size_t(open.lists().pairs()), SlotSums{0.f, 0.f});
  std::vector<TileLoss> tile_loss(std::size_t(open.lists().tiles()));
  open.for_each_recorded(exec, problem.splat.compat, [&](std::size_t tile, const RecordedTile& recorded) {
    tile_loss[tile] = evaluate_tile(recorded, {m.data(), rest.data()}, open.planes(), pair.data());
  });
  open.for_each_visible(exec, [&](std::uint32_t gaussian, std::size_t first, std::size_t end) {
    const std::int32_t column = column_of[gaussian];
    if (column < 0) return;
    for (std::size_t s = first; s < end; ++s) {
      out.inside[std::size_t(column)] += double(pair[s].inside);
      out.outside[std::size_t(column)] += double(pair[s].outside);
    }
  });
  TileLoss sum;
  for (const TileLoss& t : tile_loss) {
    sum.loss += t.loss;
    sum.target_sum += t.target_sum;
  }
  return sum;
}

PixelTargets pixel_targets(const ViewMasks& masks, int object) {
  PixelTargets t;
  if (!masks.available) return t;
  t.inside = masks.target[std::size_t(object)];
  t.outside.resize(t.inside.size());
  for (std::size_t p = 0; p < t.inside.size(); ++p) {
    const bool known = masks.known.empty() || masks.known[p];
    t.outside[p] = known ? 1 - t.inside[p] : 0.f;
    if (!known) t.inside[p] = 0.f;
  }
  return t;
}

LabelSystem::LabelSystem(std::unique_ptr<State> state) : state_(std::move(state)) {}
LabelSystem::LabelSystem(LabelSystem&&) noexcept = default;
LabelSystem::~LabelSystem() = default;

LabelSystem::LabelSystem(const Exec& exec, const LabelProblem& problem, const std::vector<std::int32_t>& column_of,
                         const std::vector<double>& label, std::int64_t cache_bytes)
    : state_(std::make_unique<State>(problem, column_of, label)) {
  if (cache_bytes == 0) {
    state_->open_streamed(exec);
    state_->number_slots();
    return;
  }
  for (std::size_t camera = 0; camera < problem.cameras.size(); ++camera) state_->open_view(exec, camera, cache_bytes);
  state_->number_slots();
}

LabelSystem LabelSystem::reduced(const Exec& exec, const std::vector<std::int32_t>& new_column,
                                 const std::vector<double>& m, std::int64_t cache_bytes) const {
  const State& s = *state_;
  NGS_CHECK(std::int64_t(new_column.size()) == s.columns && m.size() == new_column.size(), "label columns");
  FloatColumns at;
  at.assign(m);
  std::vector<std::int32_t> column_of = s.column_of;
  std::vector<double> label = s.label;
  for (std::size_t i = 0; i < column_of.size(); ++i)
    if (column_of[i] >= 0) {
      label[i] = m[std::size_t(column_of[i])];
      column_of[i] = new_column[std::size_t(column_of[i])];
    }
  auto out = std::make_unique<State>(s.problem, std::move(column_of), std::move(label));
  out->of_cached = s.of_cached;  // a reduced block adds only the loss that became constant
  for (const auto& view : s.block) {
    std::vector<LabelBlock> tiles(view.size());
    for_each_task(exec, std::int64_t(view.size()), [&](std::int64_t b) {
      tiles[std::size_t(b)] = reduced_block(view[std::size_t(b)], new_column.data(), at.view());
    });
    std::int64_t bytes = 0;
    for (const LabelBlock& t : tiles) bytes += cache_bytes_of(t);
    out->add_view(std::move(tiles), bytes, s.stats.cached_bytes);
  }
  for (const std::size_t camera : s.streamed) out->open_view(exec, camera, cache_bytes);
  out->number_slots();
  return LabelSystem(std::move(out));
}

std::int64_t LabelSystem::columns() const { return state_->columns; }
double LabelSystem::gradient_scale() const {
  return state_->target_sum() > 0 ? (1 - 2 * kMaskEps) / state_->target_sum() : 0.0;
}
const LabelSums& LabelSystem::at_start() const {
  NGS_CHECK(state_->start.inside.size() == std::size_t(state_->columns), "at_start() needs a system without a cache");
  return state_->start;
}
const LabelSystem::Stats& LabelSystem::stats() const { return state_->stats; }

void LabelSystem::evaluate(const Exec& exec, const std::vector<double>& m, LabelSums& out) const {
  const State& s = *state_;
  NGS_CHECK(std::int64_t(m.size()) == s.columns, "label columns");
  FloatColumns at;
  at.assign(m);
  out.inside.assign(m.size(), 0.0);
  out.outside.assign(m.size(), 0.0);
  double loss = s.of_cached.loss;
  std::vector<const LabelBlock*> blocks;
  for (const auto& view : s.block)
    for (const LabelBlock& b : view) blocks.push_back(&b);
  std::vector<double> block_loss(blocks.size());
  for_each_task(exec, std::int64_t(blocks.size()), [&](std::int64_t b) {
    block_loss[std::size_t(b)] = evaluate_block(*blocks[std::size_t(b)], at.view(), s.slots.data());
  });
  for (const double l : block_loss) loss += l;
  for_each_index(exec, s.columns, [&](std::int64_t c) {
    for (std::int64_t i = s.slot_begin[std::size_t(c)]; i < s.slot_begin[std::size_t(c) + 1]; ++i) {
      out.inside[std::size_t(c)] += double(s.slots[std::size_t(i)].inside);
      out.outside[std::size_t(c)] += double(s.slots[std::size_t(i)].outside);
    }
  });
  for (const std::size_t camera : s.streamed)
    loss += s.stream(exec, OpenView(exec, s.problem, camera), at.view(), out).loss;
  out.loss = s.target_sum() > 0 ? loss / s.target_sum() : 0.0;
}

}  // namespace ngs
