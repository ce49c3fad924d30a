#include "ngs/ops/evidence.h"

#include "ngs/core/check.h"
#include "ngs/ops/cloud_view.h"
#include "ngs/ops/splat_tiles.h"

namespace ngs {
namespace {

using L = PackF;
constexpr int kPacks = kPacksPerTile<L>;

/// The masks of one tile in packs: [known, object 0, object 1, ...], 0 outside the image and where unknown.
std::vector<L> tile_masks(const ViewMasks& masks, const TileFrame& frame) {
  const std::size_t planes = masks.target.size() + 1;
  std::vector<float> lane(planes * kPacks * L::kLanes, 0.f);
  for (int y = 0; y < frame.rows(); ++y)
    for (int x = 0; x < frame.columns(); ++x) {
      const auto pixel = std::size_t(frame.y_px + y) * std::size_t(frame.width_px) + std::size_t(frame.x_px + x);
      if (!masks.known.empty() && !masks.known[pixel]) continue;
      const std::size_t at = std::size_t(y) * kTilePx + std::size_t(x);  // packs are row-major and 8 wide
      lane[at] = 1.f;
      for (std::size_t k = 1; k < planes; ++k) lane[k * kPacks * L::kLanes + at] = masks.target[k - 1][pixel];
    }
  std::vector<L> packs(planes * kPacks);
  for (std::size_t i = 0; i < packs.size(); ++i) load_lanes(&lane[i * L::kLanes], packs[i]);
  return packs;
}

/// Per (Gaussian, tile) pair: [W, n, W1_0, n1_0, W1_1, n1_1, ...].
struct EvidenceSink {
  const TileLists& lists;
  const std::vector<L>& mask;
  Matrix<float> pair;
  std::vector<L> sum;
  std::int64_t entry = 0;

  void begin(std::int64_t e) {
    entry = e;
    std::fill(sum.begin(), sum.end(), L(0.f));
  }
  void add(const Contribution<L>& hit) {
    const L weight = hit.alpha * hit.transmittance, zero(0.f), one(1.f);
    const L reached = select(hit.alpha > zero, mask[std::size_t(hit.pack)], zero);
    sum[0] = fma_lanes(weight, mask[std::size_t(hit.pack)], sum[0]);
    sum[1] += reached;
    for (std::size_t k = 1; 2 * k < sum.size(); ++k) {
      const L m = mask[k * kPacks + std::size_t(hit.pack)];
      sum[2 * k] = fma_lanes(weight, m, sum[2 * k]);
      sum[2 * k + 1] += select(m >= L(0.5f), select(hit.alpha > zero, one, zero), zero);
    }
  }
  void end() {
    float* row = pair.row(lists.slot[std::size_t(entry)]);
    for (std::size_t i = 0; i < sum.size(); ++i) row[i] = sum_lanes(sum[i]);
  }
};

std::uint64_t quantised(double unit) { return std::uint64_t(std::llround(unit * 0x1p32)); }

/// Folds the pairs of visible Gaussian v into its row of the evidence.
void fold_gaussian(const TileLists& lists, const Matrix<float>& pair, std::size_t v, std::size_t gaussian, Evidence& e) {
  std::vector<double> sum(std::size_t(pair.c), 0.0);
  for (std::int64_t slot = lists.slot_begin[v]; slot < lists.slot_begin[v + 1]; ++slot)
    for (int c = 0; c < pair.c; ++c) sum[std::size_t(c)] += double(pair.row(slot)[c]);
  const double weight = sum[0], pixels = sum[1];
  if (!(weight > 0)) return;
  e.weight.add(gaussian, weight);
  e.pixels[gaussian] += std::uint64_t(pixels);
  e.views[gaussian] += 1;
  for (int k = 0; k < e.objects; ++k) {
    const std::size_t cell = gaussian * std::size_t(e.objects) + std::size_t(k);
    const double object_weight = std::min(sum[std::size_t(2 + 2 * k)], weight), object_pixels = sum[std::size_t(3 + 2 * k)];
    const double signal = double(quantised(object_weight / weight)) * 0x1p-32;
    e.object_weight.add(cell, object_weight);
    e.object_pixels[cell] += std::uint64_t(object_pixels);
    e.signal_sum[cell] += quantised(signal);
    e.signal_square_sum.add(cell, signal * signal);
    e.contrast_sum[cell] += quantised(std::abs(2 * object_pixels - pixels) / pixels);
  }
}

}  // namespace

void add_view_evidence(const Exec& exec, const GaussianCloud& cloud, const Camera& camera,
                       const SplatOptions& options, const ViewMasks& masks, Evidence& evidence) {
  if (!masks.available) return;
  NGS_CHECK(masks.width_px == camera.width_px && masks.height_px == camera.height_px, "mask size");
  NGS_CHECK(int(masks.target.size()) == evidence.objects && evidence.gaussians == cloud.size(), "evidence shape");
  const Camera relative = relative_camera(camera, cloud);
  const ProjectedView<float> view = project_view(exec, cloud_view(cloud, 0, nullptr), relative, options);
  const TileLists lists = bin_tiles(exec, view, camera.width_px, camera.height_px);
  const int columns = 2 + 2 * evidence.objects;
  std::vector<float> pair_sums(std::size_t(lists.pairs()) * std::size_t(columns), 0.f);
  const Matrix<float> pair{pair_sums.data(), lists.pairs(), columns};
  for_each_task(exec, lists.tiles(), [&](std::int64_t tile) {
    const TileFrame frame = tile_frame(lists, tile, camera.width_px, camera.height_px);
    const std::vector<L> mask = tile_masks(masks, frame);
    EvidenceSink sink{lists, mask, pair, std::vector<L>(std::size_t(columns), L(0.f))};
    L transmittance[kPacks];
    composite_tile<L>(frame, lists, tile, view.record, options.compat, transmittance, sink);
  });
  for_each_index(exec, std::int64_t(view.id.size()), [&](std::int64_t v) {
    fold_gaussian(lists, pair, std::size_t(v), view.id[std::size_t(v)], evidence);
  });
}

}  // namespace ngs
