#pragma once
// Forward and backward pass of one view, templated on the storage scalar and a table of tile kernels. Internal to ops:
// splat.cpp uses the float kernels of the machine, tests also one-lane kernels of double and Dual<double>.
#include <memory>
#include <optional>

#include "ngs/core/prefetch.h"
#include "ngs/ops/splat/binned_view.h"
#include "ngs/ops/splat/tile_scratch.h"

namespace ngs {

template <class S>
class SplatEngine {
 public:
  SplatEngine(const TileKernels<S>& kernels, const SplatOptions& options, const CloudView<S>& cloud,
              const Camera& camera, const ChannelPlan<S>& plan)
      : kernels_(kernels), options_(options), cloud_(cloud), camera_(camera), plan_(plan) {}

  /// Applies to later calls of prepare(). The arrays in `request` must outlive these.
  void cull(const CullRequest& request) { cull_ = request; }
  /// Writes channel c to out[c] and 1 - T_final to out[count()].
  void forward(const Exec& exec, const std::vector<Plane<S>>& out) {
    prepare(exec);
    composite(exec, out);
  }
  /// forward() is prepare(), which projects and bins, then composite().
  void prepare(const Exec& exec) {
    binned_.reset();
    binned_.emplace(exec, cloud_, camera_, options_, cull_);
    gather_channels(exec);
  }
  /// Replaces the channels; projection and tile lists stay.
  void set_channels(const Exec& exec, const ChannelPlan<S>& plan) {
    plan_ = plan;
    gather_channels(exec);
  }
  void composite(const Exec& exec, const std::vector<Plane<S>>& out) const {
    for_each_task(exec, lists().tiles(), [&](std::int64_t tile) {
      S* scratch = thread_scratch().values(std::size_t(plan_.count() * kTilePixels));
      kernels_.forward({work(tile), channels(), background_.data(), out.data(), scratch});
    });
  }

  /// grad[c]: ∂L/∂(out[c] of forward), grad[count()]: ∂L/∂alpha. moves[c]: whether channel c's gradient
  /// reaches alpha, and through it the geometry.
  void backward(const Exec& exec, const std::vector<Plane<const S>>& grad, const std::vector<std::uint8_t>& moves,
                const CloudGradientView<S>& out) {
    const int columns = kPairGeometry + plan_.count();
    const std::unique_ptr<S[]> pair_grad = zeros(exec, lists().pairs() * columns);
    const Matrix<const S> pairs{pair_grad.get(), lists().pairs(), columns};
    for_each_task(exec, lists().tiles(), [&](std::int64_t tile) {
      TileScratch<S>& memory = thread_scratch();
      S* scratch = memory.values(backward_scratch(plan_.count()));
      kernels_.backward({work(tile), channels(), background_.data(), grad.data(), moves.data(), pair_grad.get(),
                         scratch, &memory.tape});
    });
    clear(exec, out);
    const Column rest = out.sh_rest ? rest_column() : Column{};  // bands held: not read
    const GaussianBackward<S> gaussian{view_projector<S>(camera_, options_), cloud_, plan_, pairs, out};
    for_each_index(exec, std::int64_t(view().id.size()), [&](std::int64_t row) {
      const auto v = std::size_t(row);
      const std::int64_t begin = lists().slot_begin[v], end = lists().slot_begin[v + 1];
      prefetch(v, Column{cloud_.position, 3}, Column{cloud_.rotation, 4}, Column{cloud_.log_scale, 3}, rest);
      if (begin < end) gaussian.gather(view().id[v], channels().row(std::uint32_t(v)), begin, end);
    });
  }

  const ProjectedView<S>& view() const { return binned_->view(); }
  const TileLists& lists() const { return binned_->lists(); }
  BinnedView<S>& binned() { return *binned_; }
  TileWork<S> work(std::int64_t tile) const { return tile_work(view(), lists(), tile, camera_, options_.compat); }

 private:
  void gather_channels(const Exec& exec) {
    const int count = plan_.count();
    background_.assign(std::size_t(count), S(0));
    if (plan_.colour) {
      background_[0] = plan_.background.x;
      background_[1] = plan_.background.y;
      background_[2] = plan_.background.z;
    }
    const ViewProjector<S> projector = view_projector<S>(camera_, options_);
    channel_.resize(view().id.size() * std::size_t(count));
    for_each_index(exec, std::int64_t(view().id.size()), [&](std::int64_t v) {
      if (plan_.colour) prefetch(std::size_t(v), Column{cloud_.position, 3}, Column{cloud_.sh_dc, 3}, rest_column());
      if (lists().slot_begin[std::size_t(v)] == lists().slot_begin[std::size_t(v) + 1]) return;  // in no tile
      plan_.fill(projector, cloud_, view().id[std::size_t(v)], view().depth[std::size_t(v)],
                 channel_.data() + v * count);
    });
  }

  /// Neighbours in a view are far apart in the cloud: fetches columns of the projected row kRowsAhead behind `v`.
  template <class... Columns>
  [[gnu::always_inline]] void prefetch(std::size_t v, const Columns&... columns) const {
    constexpr std::size_t kRowsAhead = 12;
    const std::size_t ahead = v + kRowsAhead;
    if (ahead >= view().id.size() || lists().slot_begin[ahead] == lists().slot_begin[ahead + 1]) return;
    const std::size_t i = view().id[ahead];
    (prefetch_values(columns.data + i * std::size_t(columns.width), columns.width), ...);
  }
  /// A column to fetch; width 0: none.
  struct Column {
    const S* data;
    int width;
  };
  Column rest_column() const { return {cloud_.sh_rest, cloud_.sh_degree > 0 ? cloud_.rest_stride * 3 : 0}; }

  ChannelValues<S> channels() const { return {channel_.data(), plan_.count()}; }
  /// [n] zeros, written in parallel so that the threads share the page faults.
  static std::unique_ptr<S[]> zeros(const Exec& exec, std::int64_t n) {
    constexpr std::int64_t kChunk = 1 << 14;
    std::unique_ptr<S[]> memory = std::make_unique_for_overwrite<S[]>(std::size_t(n));
    for_each_index(exec, (n + kChunk - 1) / kChunk, [&](std::int64_t chunk) {
      std::fill(memory.get() + chunk * kChunk, memory.get() + std::min(n, (chunk + 1) * kChunk), S(0));
    });
    return memory;
  }
  static TileScratch<S>& thread_scratch() {
    static thread_local TileScratch<S> scratch;
    return scratch;
  }

  void clear(const Exec& exec, const CloudGradientView<S>& out) const {
    const int labels = plan_.labels();
    for_each_index(exec, out.gradient_row ? out.rows : cloud_.size, [&](std::int64_t i) {
      const auto zero = [i](S* column, int width) {
        if (column) std::fill_n(column + i * width, width, S(0));
      };
      zero(out.position, 3);
      zero(out.rotation, 4);
      zero(out.log_scale, 3);
      zero(out.logit_opacity, 1);
      zero(out.sh_dc, 3);
      zero(out.sh_rest, cloud_.rest_stride * 3);
      zero(out.label, labels);
      zero(out.mean_px, 2);
      if (out.visible) out.visible[i] = 0;
    });
  }

  TileKernels<S> kernels_;
  SplatOptions options_;
  CloudView<S> cloud_;
  Camera camera_;
  ChannelPlan<S> plan_;
  CullRequest cull_;
  std::optional<BinnedView<S>> binned_;
  std::vector<S> background_, channel_;  // [C], [V, C]
};

}  // namespace ngs
