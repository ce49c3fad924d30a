#include "ngs/edit/select/touched_pieces.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ngs/core/check.h"
#include "ngs/edit/select/clusters.h"
#include "ngs/edit/select/needles.h"
#include "ngs/ops/image/connected_components.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/ops/splat/evidence.h"
#include "ngs/problem/cloud_rows.h"

namespace ngs {
namespace {

constexpr double kTouched = 0.1;       // least fraction of a stroke's weight on the selection
constexpr double kShown = 0.01;        // the same of a mask: less is a speck
constexpr double kReach = 2;           // standard deviations that a Gaussian reaches
constexpr std::size_t kSample = 4096;  // Gaussians in the estimate of the spacing

/// cluster_side() from a sample of the Gaussians, for interactive use.
double side_by_sample(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& member) {
  std::vector<float> all;
  for (std::size_t i = 0; i < member.size(); ++i)
    if (member[i] && cloud.usable[i] && cloud.logit_opacity[i] >= kSolidLogit)
      all.insert(all.end(), &cloud.position[3 * i], &cloud.position[3 * i] + 3);
  const std::size_t count = all.size() / 3;
  if (count < 2) return 0;
  const std::size_t step = (count + kSample - 1) / kSample;
  std::vector<float> sample;
  for (std::size_t i = 0; i < count; i += step) sample.insert(sample.end(), &all[3 * i], &all[3 * i] + 3);
  const KnnGraph graph =
      nearest_points(exec, {all.data(), std::int64_t(count)}, {sample.data(), std::int64_t(sample.size() / 3)}, 2);
  std::vector<float> dist2;
  for (std::size_t q = 0; q < sample.size() / 3; ++q)
    dist2.push_back(graph.dist2[2 * q + 1]);  // the first is the Gaussian itself
  return side_of_spacings(dist2);
}

/// Per piece: 1 if it has at least `share` of the weight of `sums` on all pieces, or the largest.
std::vector<std::uint8_t> pieces_in(const ViewSums& sums, const Clusters& pieces, double share) {
  std::vector<double> weight(pieces.size.size());
  for (std::size_t v = 0; v < sums.size(); ++v)
    if (const std::int32_t piece = pieces.of_row[sums.row[v]]; piece >= 0) weight[std::size_t(piece)] += sums.weight(v);
  std::vector<std::uint8_t> shown(weight.size());
  const double whole = std::accumulate(weight.begin(), weight.end(), 0.0);
  if (!(whole > 0)) return shown;
  shown[std::size_t(std::max_element(weight.begin(), weight.end()) - weight.begin())] = 1;
  for (std::size_t p = 0; p < weight.size(); ++p) shown[p] |= std::uint8_t(weight[p] >= share * whole);
  return shown;
}

/// Per piece: 1 if a stroke touches it, or at least kMinMasks masks show it and a stroke touches any.
std::vector<std::uint8_t> touched_by(std::span<const ViewSums> strokes, std::span<const ViewSums> masks,
                                     const Clusters& pieces) {
  std::vector<std::uint8_t> touched(pieces.size.size());
  for (const ViewSums& stroke : strokes) {
    const std::vector<std::uint8_t> shown = pieces_in(stroke, pieces, kTouched);
    for (std::size_t p = 0; p < shown.size(); ++p) touched[p] |= shown[p];
  }
  if (std::ranges::count(touched, 1) == 0) return touched;
  std::vector<int> count(touched.size());
  for (const ViewSums& mask : masks) {
    const std::vector<std::uint8_t> shown = pieces_in(mask, pieces, kShown);
    for (std::size_t p = 0; p < shown.size(); ++p) count[p] += shown[p];
  }
  for (std::size_t p = 0; p < touched.size(); ++p) touched[p] |= std::uint8_t(count[p] >= kMinMasks);
  return touched;
}

/// Keeps the Gaussians of other pieces that reach a kept one, out[i] = 1: an object may be sparse in places, with large
/// Gaussians farther apart than the grid's cells. Those between pieces are tested against touched pieces only.
void keep_overlapping(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& member,
                      double side, std::vector<std::uint8_t>& kept) {
  std::vector<float> inside, query;
  std::vector<std::size_t> row;
  for (std::size_t i = 0; i < member.size(); ++i) {
    const float* p = &cloud.position[3 * i];
    if (kept[i] && cloud.logit_opacity[i] >= kSolidLogit) inside.insert(inside.end(), p, p + 3);
    if (member[i] && !kept[i] && kReach * largest_scale(cloud, std::int64_t(i)) > side) {
      row.push_back(i);
      query.insert(query.end(), p, p + 3);
    }
  }
  if (inside.empty() || row.empty()) return;
  const KnnGraph nearest = nearest_points(exec, {inside.data(), std::int64_t(inside.size() / 3)},
                                          {query.data(), std::int64_t(query.size() / 3)}, 1);
  for (std::size_t q = 0; q < row.size(); ++q)
    kept[row[q]] = std::sqrt(double(nearest.dist2[q])) <= kReach * largest_scale(cloud, std::int64_t(row[q]));
}

}  // namespace

std::vector<PixelMask> object_strokes(const ViewPrompt& marks) {
  const PixelMask marked = pixels_with(marks, PixelHint::kObject);
  const ConnectedComponents found = connected_components({marked.data(), marks.width_px, marks.height_px});
  std::vector<std::size_t> order(found.size.size()), place(order.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return found.size[a] > found.size[b]; });
  for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = std::min(k, kMaxStrokes - 1);
  std::vector<PixelMask> strokes(std::min(order.size(), kMaxStrokes), PixelMask(marked.size()));
  for (std::size_t p = 0; p < marked.size(); ++p)
    if (marked[p]) strokes[place[std::size_t(found.component[p])]][p] = 1;
  return strokes;
}

std::vector<ViewSums> stroke_weights(const Exec& exec, const GaussianCloud& cloud, const Camera& camera,
                                     const ViewPrompt& marks, const SplatOptions& splat) {
  NGS_CHECK(marks.width_px == camera.width_px && marks.height_px == camera.height_px, "marks of the camera's size");
  ViewMasks masks = known_view(camera);
  for (const PixelMask& stroke : object_strokes(marks)) masks.target.emplace_back(stroke.begin(), stroke.end());
  std::vector<ViewSums> strokes;
  if (masks.target.empty()) return strokes;
  const ViewSums sums = view_sums(exec, cloud, {camera, masks}, splat);
  for (std::size_t k = 0; k < masks.target.size(); ++k) strokes.push_back(sums.weights_inside(k));
  return strokes;
}

PieceSelection touched_pieces(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& member,
                              std::span<const ViewSums> strokes, std::span<const ViewSums> masks) {
  NGS_CHECK(std::int64_t(member.size()) == cloud.size(), "one entry per Gaussian");
  PieceSelection out;
  out.object = member;
  for (std::size_t i = 0; i < member.size(); ++i) out.object[i] = member[i] && cloud.usable[i];
  const double side = side_by_sample(exec, cloud, out.object);
  const Clusters pieces = cluster_on_grid(exec, cloud, out.object, side);
  out.pieces = out.kept_pieces = std::int64_t(pieces.size.size());
  const std::vector<std::uint8_t> touched = touched_by(strokes, masks, pieces);
  const auto kept = std::count(touched.begin(), touched.end(), std::uint8_t(1));
  if (kept == 0) return out;
  out.kept_pieces = kept;
  const std::vector<std::uint8_t> all = out.object;
  for (std::size_t i = 0; i < all.size(); ++i)
    out.object[i] = all[i] && pieces.of_row[i] >= 0 && touched[std::size_t(pieces.of_row[i])];
  keep_overlapping(exec, cloud, all, side, out.object);
  for (std::size_t i = 0; i < all.size(); ++i) out.removed += all[i] && !out.object[i];
  for (const std::uint32_t needle : needles_beyond(exec, cloud, out.object, side)) {
    out.object[needle] = 0;
    ++out.needles;
  }
  return out;
}

}  // namespace ngs
