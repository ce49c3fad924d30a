#include "ngs/ops/splat/evidence.h"

#include <algorithm>
#include <span>

#include "ngs/core/check.h"
#include "ngs/math/row_ranks.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/splat/binned_view.h"
#include "ngs/ops/splat/cloud_view.h"
#include "ngs/ops/splat/prepared/prepared_cloud.h"
#include "ngs/ops/splat/splat_view.h"
#include "ngs/ops/splat/tile_isa.h"
#include "ngs/ops/splat/tile_scratch.h"

namespace ngs {
namespace {

/// The objects that need sums in each tile. Up to kFew objects: all; more: only those with a non-zero mask in the tile,
/// so that background tiles cost no work per object.
class TileObjects {
 public:
  static constexpr std::size_t kFew = 3;

  TileObjects(const Exec& exec, const ViewMasks& masks, const TileLists& lists)
      : begin_(std::size_t(lists.tiles()) + 1) {
    const std::size_t count = masks.target.size(), tiles = std::size_t(lists.tiles());
    std::vector<std::uint8_t> present(tiles * count, 1);
    for_each_task(exec, count > kFew ? std::int64_t(tiles) : 0, [&](std::int64_t t) {
      const int x0 = int(t % lists.tiles_x) * kTilePx, y0 = int(t / lists.tiles_x) * kTilePx;
      for (std::size_t k = 0; k < count; ++k)
        present[std::size_t(t) * count + k] = any_in_tile(masks.target[k], masks.width_px, masks.height_px, x0, y0);
    });
    for (std::size_t t = 0; t < tiles; ++t) {
      for (std::size_t k = 0; k < count; ++k)
        if (present[t * count + k]) object_.push_back(std::uint32_t(k));
      begin_[t + 1] = std::uint32_t(object_.size());
    }
  }
  std::span<const std::uint32_t> of(std::size_t tile) const {
    return std::span(object_).subspan(begin_[tile], begin_[tile + 1] - begin_[tile]);
  }

 private:
  static bool any_in_tile(const std::vector<float>& plane, int w, int h, int x0, int y0) {
    for (int y = y0; y < std::min(y0 + kTilePx, h); ++y) {
      const float* row = plane.data() + std::size_t(y) * std::size_t(w);
      if (std::any_of(row + x0, row + std::min(x0 + kTilePx, w), [](float m) { return m != 0; })) return true;
    }
    return false;
  }

  std::vector<std::uint32_t> object_, begin_;  // concatenated by tile; [tiles + 1]
};

/// Sums of every (Gaussian, tile) pair of one view: [pairs, 2 + 2K] by slot; with more than TileObjects::kFew objects
/// by tile, [entries of the tile, 2 + 2 objects of the tile]. `wanted` [N] (null: all) selects Gaussians; only tiles
/// that these touch are rasterised.
class ViewPairs {
 public:
  ViewPairs(const Exec& exec, const GaussianCloud& cloud, const MaskedView& of, const SplatOptions& options,
            const RowNumbers* wanted)
      : binned_(exec, cloud_view(cloud, 0, nullptr), relative_camera(of.camera, cloud), options,
                cull_request_of(wanted)),
        wanted_(wanted),
        columns_(2 + 2 * of.masks.target.size()),
        objects_(exec, of.masks, binned_.lists()) {
    const TileLists& lists = binned_.lists();
    const auto tiles = std::size_t(lists.tiles());
    first_.resize(tiles + 1);
    if (by_tile()) place_.resize(std::size_t(lists.pairs()));
    for (std::size_t t = 0; t < tiles; ++t)
      first_[t + 1] = first_[t] + std::size_t(lists.tile_begin[t + 1] - lists.tile_begin[t]) * columns_of(t);
    std::vector<float>& sums = binned_.sums(first_.back());
    const TileKernels<float> kernels = float_tile_kernels(exec.isa);
    for_each_task(exec, lists.tiles(),
                  [&](std::int64_t tile) { fill(kernels, of, options.compat, tile, sums.data()); });
    sums_ = sums.data();
  }

  std::int64_t chunks() const { return (std::int64_t(binned_.view().id.size()) + kChunk - 1) / kChunk; }
  /// f(row, sums, has_object) for the wanted Gaussians of a chunk with W > 0, in order. row: in the cloud, or in
  /// `wanted`; has_object: whether any object's sums are non-zero.
  template <class F>
  void for_each_seen(std::int64_t chunk, const F& f) const {
    const std::vector<std::uint32_t>& id = binned_.view().id;
    std::vector<double> sum(columns_);
    bool has_object = false;
    const auto end = std::min(id.size(), std::size_t((chunk + 1) * kChunk));
    for (auto v = std::size_t(chunk * kChunk); v < end; ++v) {
      if (!is_wanted(id[v])) continue;
      sum[0] = sum[1] = 0;
      if (has_object) std::fill(sum.begin() + 2, sum.end(), 0.0);
      has_object = by_tile()       ? sum_by_tile(v, sum.data())
                   : columns_ == 4 ? sum_up<4>(v, sum.data())
                                   : sum_up<0>(v, sum.data());
      if (sum[0] > 0) f(wanted_ ? wanted_->number[id[v]] : id[v], sum.data(), has_object);
    }
  }

 private:
  static constexpr std::int64_t kChunk = 1 << 12;
  struct Place {
    std::uint32_t tile, entry;
  };

  /// Gaussians behind the last requested one are culled: the weights of a Gaussian do not depend on those behind it.
  static CullRequest cull_request_of(const RowNumbers* wanted) {
    const std::uint8_t* const flags = wanted ? wanted->chosen.data() : nullptr;
    return {flags, flags};
  }
  bool is_wanted(std::uint32_t gaussian) const { return wanted_ == nullptr || wanted_->has(gaussian); }
  bool any_wanted(const TileWork<float>& work) const {
    return wanted_ == nullptr || std::any_of(work.visible, work.visible + work.entries,
                                             [this](std::uint32_t v) { return is_wanted(binned_.view().id[v]); });
  }

  bool by_tile() const { return columns_ > 2 + 2 * TileObjects::kFew; }
  std::size_t columns_of(std::size_t tile) const { return 2 + 2 * objects_.of(tile).size(); }

  void fill(const TileKernels<float>& kernels, const MaskedView& of, Compat compat, std::int64_t tile, float* sums) {
    static thread_local TileScratch<float> scratch;
    static thread_local std::vector<std::uint32_t> in_order;
    static thread_local std::vector<const float*> target;
    const auto t = std::size_t(tile);
    target.clear();
    for (const std::uint32_t k : objects_.of(t)) target.push_back(of.masks.target[k].data());
    TileWork<float> work = tile_work(binned_.view(), binned_.lists(), tile, of.camera, compat);
    if (!any_wanted(work)) return;
    if (by_tile()) {
      for (std::uint32_t e = 0; e < work.entries; ++e) place_[work.slot[e]] = {std::uint32_t(t), e};
      while (in_order.size() < work.entries) in_order.push_back(std::uint32_t(in_order.size()));
      work.slot = in_order.data();
      sums += first_[t];
    }
    kernels.evidence({work, of.masks.known.empty() ? nullptr : of.masks.known.data(), target.data(), int(target.size()),
                      sums, scratch.values(evidence_scratch(int(target.size()))),
                      of.weight == PixelWeight::kByVisibility});
  }

  /// Adds the pairs of visible Gaussian v to sums that are 0; returns has_object. C: columns; C = 0: any number.
  template <std::size_t C>
  bool sum_up(std::size_t v, double* sum) const {
    const std::size_t columns = C > 0 ? C : columns_;
    add_slots(binned_.lists(), v, sums_, columns, sum);
    return cap_objects(columns, sum);
  }
  bool sum_by_tile(std::size_t v, double* sum) const {
    // A Gaussian's tiles are scattered in the sums.
    constexpr std::size_t kPrefetchSlots = 16;
    const TileLists& lists = binned_.lists();
    const auto begin = std::size_t(lists.slot_begin[v]), end = std::size_t(lists.slot_begin[v + 1]);
    bool has_object = false;
    for (std::size_t slot = begin; slot < end; ++slot) {
      if (slot + kPrefetchSlots < place_.size()) __builtin_prefetch(pair_at(place_[slot + kPrefetchSlots]));
      const float* pair = pair_at(place_[slot]);
      sum[0] += double(pair[0]);
      sum[1] += double(pair[1]);
      for (const std::uint32_t k : objects_.of(place_[slot].tile)) {
        pair += 2;
        has_object = true;
        sum[2 + 2 * k] += double(pair[0]);
        sum[3 + 2 * k] += double(pair[1]);
      }
    }
    return has_object && cap_objects(columns_, sum);
  }
  /// Caps W1 of each object at W; returns whether any object's sums are non-zero.
  static bool cap_objects(std::size_t columns, double* sum) {
    bool has_object = false;
    for (std::size_t c = 2; c < columns; c += 2) {
      has_object |= (sum[c] != 0) | (sum[c + 1] != 0);
      sum[c] = std::min(sum[c], sum[0]);
    }
    return has_object;
  }
  const float* pair_at(const Place& at) const { return sums_ + first_[at.tile] + at.entry * columns_of(at.tile); }

  BinnedView<float> binned_;
  const RowNumbers* wanted_;
  std::size_t columns_;
  TileObjects objects_;
  std::vector<std::size_t> first_;  // [tiles + 1] offset of a tile's sums
  std::vector<Place> place_;        // [pairs] by slot; empty if the sums are by slot
  const float* sums_ = nullptr;
};

/// Merges the parts, ascending by row.
ViewSums merged(const Exec& exec, std::int64_t rows, int objects, const std::vector<ViewSums>& parts) {
  ViewSums all{objects, true, {}, {}};
  const std::size_t columns = all.columns();
  RowRanks ranks(rows);
  std::size_t size = 0;
  for (const ViewSums& part : parts) {
    ranks.add(part.row);
    size += part.size();
  }
  ranks.count();
  all.row.resize(size);
  all.sum.resize(size * columns);
  for_each_task(exec, std::ssize(parts), [&](std::int64_t p) {
    const ViewSums& part = parts[std::size_t(p)];
    for (std::size_t v = 0; v < part.size(); ++v) {
      const std::size_t at = ranks.of(part.row[v]);
      all.row[at] = part.row[v];
      std::copy_n(part.at(v), columns, &all.sum[at * columns]);
    }
  });
  return all;
}

/// A view, and the Gaussians whose sums are wanted; `of` null: all.
struct Query {
  const GaussianCloud& cloud;
  const MaskedView& view;
  const SplatOptions& options;
  const RowNumbers* of = nullptr;
};

void check_shapes(const Query& q) {
  const ViewMasks& masks = q.view.masks;
  NGS_CHECK(masks.width_px == q.view.camera.width_px && masks.height_px == q.view.camera.height_px, "mask size");
  NGS_CHECK(q.of == nullptr || std::int64_t(q.of->number.size()) == q.cloud.size(), "one number per Gaussian");
}

EvidenceCall device_call(const Query& q) {
  return {view_projector<float>(relative_camera(q.view.camera, q.cloud), q.options),
          on_host(cloud_view(q.cloud, 0, nullptr), q.options), q.view.masks,
          q.view.weight == PixelWeight::kByVisibility, q.of ? q.of->chosen.data() : nullptr};
}

/// The same sums from a device, with the interface of ViewPairs.
class DeviceSumsOfView {
 public:
  DeviceSumsOfView(const Exec& exec, const Query& q)
      : sums_(exec.device_ops->splat.evidence(device_call(q))), of_(q.of) {}
  std::int64_t chunks() const { return std::int64_t((sums_.size() + kRows - 1) / kRows); }
  template <class F>
  void for_each_seen(std::int64_t chunk, const F& f) const {
    const std::size_t begin = std::size_t(chunk) * kRows, end = std::min(sums_.size(), begin + kRows);
    for (std::size_t v = begin; v < end; ++v) {
      const std::uint32_t row = sums_.row[v];
      const double *sum = sums_.at(v), *last = sum + sums_.columns();
      f(of_ ? of_->number[row] : row, sum, std::any_of(sum + 2, last, [](double s) { return s != 0; }));
    }
  }

 private:
  static constexpr std::size_t kRows = 1 << 12;
  ViewSums sums_;
  const RowNumbers* of_;
};

/// Calls start(number of chunks), then body(chunk, rows) from several threads. rows(f) calls f(row, sums, has_object)
/// for the wanted Gaussians of the chunk with W > 0, as ViewPairs::for_each_seen().
template <class Start, class Body>
void for_each_chunk(const Exec& exec, const Query& q, const Start& start, const Body& body) {
  check_shapes(q);
  const auto visit = [&](const auto& sums) {
    start(std::size_t(sums.chunks()));
    for_each_task(exec, sums.chunks(), [&](std::int64_t chunk) {
      body(std::size_t(chunk), [&](const auto& f) { sums.for_each_seen(chunk, f); });
    });
  };
  if (exec.device_ops != nullptr)
    visit(DeviceSumsOfView(exec, q));
  else
    visit(ViewPairs(exec, q.cloud, q.view, q.options, q.of));
}

}  // namespace

ViewSums view_sums(const Exec& exec, const GaussianCloud& cloud, const MaskedView& view, const SplatOptions& options,
                   const RowNumbers* of) {
  ViewSums none{int(view.masks.target.size()), true, {}, {}};
  if (!view.masks.available) return none;
  std::vector<ViewSums> part;
  for_each_chunk(
      exec, {cloud, view, options, of}, [&](std::size_t chunks) { part.assign(chunks, none); },
      [&](std::size_t chunk, const auto& rows) {
        rows([&to = part[chunk]](std::uint32_t gaussian, const double* sum, bool) { to.add(gaussian, sum); });
      });
  return merged(exec, of ? of->size() : cloud.size(), none.objects, part);
}

PackedSums packed_sums(const Exec& exec, const GaussianCloud& cloud, const MaskedView& view,
                       const SplatOptions& options, const RowNumbers* of) {
  const int objects = int(view.masks.target.size());
  PackedSums seen(objects, 0);
  if (!view.masks.available) return seen;
  for_each_chunk(
      exec, {cloud, view, options, of}, [&](std::size_t chunks) { seen = PackedSums(objects, chunks); },
      [&](std::size_t chunk, const auto& rows) {
        rows([&](std::uint32_t gaussian, const double* sum, bool) { seen.add(chunk, gaussian, sum); });
        seen.shrink_to_fit(chunk);
      });
  return seen;
}

std::vector<HeaviestMask> heaviest_masks(const Exec& exec, const GaussianCloud& cloud, const MaskedView& view,
                                         const SplatOptions& options) {
  std::vector<std::vector<HeaviestMask>> part;
  for_each_chunk(
      exec, {cloud, view, options}, [&](std::size_t chunks) { part.resize(chunks); },
      [&](std::size_t chunk, const auto& rows) {
        rows([&, &to = part[chunk]](std::uint32_t gaussian, const double* sum, bool has_object) {
          HeaviestMask heaviest{gaussian, -1, sum[0], sum[1]};
          for (std::size_t k = 0; has_object && k < view.masks.target.size(); ++k) {
            const double of_mask = sum[2 + 2 * k];
            heaviest.of_all += of_mask;
            if (of_mask <= heaviest.of_object) continue;
            heaviest.object = std::int32_t(k);
            heaviest.of_object = of_mask;
          }
          to.push_back(heaviest);
        });
      });
  std::vector<HeaviestMask> all;
  for (const auto& some : part) all.insert(all.end(), some.begin(), some.end());
  return all;
}

void add_view_evidence(const Exec& exec, const GaussianCloud& cloud, const MaskedView& view,
                       const SplatOptions& options, Evidence& evidence) {
  if (!view.masks.available) return;
  NGS_CHECK(int(view.masks.target.size()) == evidence.objects && evidence.gaussians == cloud.size(), "evidence shape");
  std::vector<Evidence::DeferredInserts> deferred_inserts;
  for_each_chunk(
      exec, {cloud, view, options}, [&](std::size_t chunks) { deferred_inserts.resize(chunks); },
      [&](std::size_t chunk, const auto& rows) {
        rows([&](std::uint32_t gaussian, const double* sum, bool has_object) {
          has_object ? evidence.add(gaussian, sum, deferred_inserts[chunk])
                     : evidence.add_background(gaussian, sum[0], sum[1]);
        });
      });
  for (const Evidence::DeferredInserts& of : deferred_inserts) evidence.object_weights.add(of);
}

EvidenceSum::EvidenceSum(const Exec& exec, const GaussianCloud& cloud, int objects, SplatOptions options)
    : exec_(exec), cloud_(cloud), options_(std::move(options)), sum_(cloud.size(), objects) {
  constexpr double kMaxDeviceBytes = 2.0 * (1 << 30), kRowBytes = 28, kCellBytes = sizeof(ObjectSums) + 4;
  if (exec.device_ops && double(cloud.size()) * (kRowBytes + kCellBytes * objects) <= kMaxDeviceBytes)
    on_device_ = exec.device_ops->splat.evidence_sum(cloud.size(), objects);
}

EvidenceSum::~EvidenceSum() = default;

void EvidenceSum::add(const MaskedView& view) {
  if (!on_device_) return add_view_evidence(exec_, cloud_, view, options_, sum_);
  if (!view.masks.available) return;
  const Query query{cloud_, view, options_};
  check_shapes(query);
  NGS_CHECK(int(view.masks.target.size()) == sum_.objects, "evidence shape");
  on_device_->add(device_call(query));
}

Evidence EvidenceSum::result() {
  if (on_device_) {
    on_device_->download(sum_);
    on_device_.reset();
  }
  return std::move(sum_);
}

}  // namespace ngs
