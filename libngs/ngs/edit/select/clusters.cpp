#include "ngs/edit/select/clusters.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "ngs/core/check.h"
#include "ngs/math/cell_grid.h"
#include "ngs/math/median.h"
#include "ngs/math/union_find.h"
#include "ngs/ops/neighbours/knn.h"

namespace ngs {
namespace {

bool is_solid(const GaussianCloud& cloud, std::size_t i) { return cloud.logit_opacity[i] >= kSolidLogit; }

std::vector<float> solid_positions(const GaussianCloud& cloud, const std::vector<std::uint8_t>& member) {
  std::vector<float> positions;
  for (std::size_t i = 0; i < member.size(); ++i)
    if (member[i] && cloud.usable[i] && is_solid(cloud, i))
      positions.insert(positions.end(), &cloud.position[3 * i], &cloud.position[3 * i] + 3);
  return positions;
}

/// The median per axis, which is robust to outliers.
Vec3<double> middle_of(const std::vector<float>& positions) {
  double middle[3] = {};
  for (std::size_t axis = 0; axis < 3 && !positions.empty(); ++axis) {
    std::vector<double> values;
    for (std::size_t at = axis; at < positions.size(); at += 3) values.push_back(positions[at]);
    middle[axis] = upper_median(std::move(values));
  }
  return {middle[0], middle[1], middle[2]};
}

/// Occupied cells, ascending, and the cluster of each.
struct Occupied {
  std::vector<std::uint64_t> cell;
  std::vector<std::int32_t> cluster;

  explicit Occupied(const CellGrid& grid, const std::vector<float>& positions) {
    for (std::size_t at = 0; at < positions.size(); at += 3) cell.push_back(grid.of(&positions[at]));
    std::sort(cell.begin(), cell.end());
    cell.erase(std::unique(cell.begin(), cell.end()), cell.end());
    join();
  }

  /// Index of a cell; -1: not occupied.
  std::int64_t index(std::uint64_t key) const {
    const auto at = std::lower_bound(cell.begin(), cell.end(), key);
    return at != cell.end() && *at == key ? at - cell.begin() : -1;
  }

  /// The smallest number, so the largest cluster, in the cell or an adjacent one; -1: none.
  std::int32_t adjacent_cluster(std::uint64_t key) const {
    std::int32_t found = -1;
    CellGrid::for_neighbours(key, [&](std::uint64_t next) {
      const std::int64_t at = index(next);
      if (at >= 0 && (found < 0 || cluster[std::size_t(at)] < found)) found = cluster[std::size_t(at)];
    });
    return found;
  }

 private:
  /// Numbers clusters in order of their first cells.
  void join() {
    UnionFind sets(cell.size());
    for (std::size_t i = 0; i < cell.size(); ++i)
      CellGrid::for_neighbours(cell[i], [&](std::uint64_t next) {
        if (next > cell[i]) return;  // that pair is joined from the other cell
        if (const std::int64_t at = index(next); at >= 0) sets.join(std::uint32_t(i), std::uint32_t(at));
      });
    cluster.resize(cell.size());
    std::int32_t next = 0;
    for (std::size_t i = 0; i < cell.size(); ++i) {
      const std::uint32_t root = sets.root(std::uint32_t(i));
      cluster[i] = root == i ? next++ : cluster[root];
    }
  }
};

/// Renumbers clusters by their number of solid Gaussians, largest first.
void order_by_size(Occupied& cells, const CellGrid& grid, const std::vector<float>& positions) {
  std::vector<std::int64_t> size;
  for (const std::int32_t c : cells.cluster) size.resize(std::max(size.size(), std::size_t(c) + 1));
  for (std::size_t at = 0; at < positions.size(); at += 3)
    ++size[std::size_t(cells.cluster[std::size_t(cells.index(grid.of(&positions[at])))])];
  std::vector<std::int32_t> order(size.size()), place(size.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int32_t a, std::int32_t b) { return size[std::size_t(a)] > size[std::size_t(b)]; });
  for (std::size_t k = 0; k < order.size(); ++k) place[std::size_t(order[k])] = std::int32_t(k);
  for (std::int32_t& c : cells.cluster) c = place[std::size_t(c)];
}

/// The sort key of a usable Gaussian. All its values are finite, except that the opacity logit may be infinite.
auto key_of(const GaussianCloud& cloud, std::size_t i) {
  const float *p = &cloud.position[3 * i], *s = &cloud.log_scale[3 * i];
  return std::tuple(p[2], p[1], p[0], cloud.logit_opacity[i], s[0], s[1], s[2]);
}

}  // namespace

double cluster_side(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& member) {
  const std::vector<float> positions = solid_positions(cloud, member);
  KnnGraph graph = nearest_others(exec, {positions.data(), std::int64_t(positions.size() / 3)}, 1);
  if (graph.dist2.empty()) return 0;
  return side_of_spacings(graph.dist2);
}

double side_of_spacings(const std::vector<float>& dist2) {
  constexpr double kSpacings = 4, kQuantile = 0.9;
  return kSpacings * std::sqrt(quantile({dist2.begin(), dist2.end()}, kQuantile));
}

Clusters cluster_on_grid(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& member,
                         double side) {
  NGS_CHECK(std::int64_t(member.size()) == cloud.size(), "one entry per Gaussian");
  NGS_CHECK(side >= 0, "the side of a cell is not negative");
  Clusters out{std::vector<std::int32_t>(member.size(), -1), {}, side > 0 ? side : cluster_side(exec, cloud, member)};
  if (!(out.side > 0)) out.side = 1;  // one solid Gaussian, or all at one position: any size works
  const std::vector<float> positions = solid_positions(cloud, member);
  const CellGrid grid(middle_of(positions), out.side);
  Occupied cells(grid, positions);
  order_by_size(cells, grid, positions);
  for (std::size_t i = 0; i < member.size(); ++i) {
    if (!member[i] || !cloud.usable[i]) continue;
    const std::uint64_t cell = grid.of(&cloud.position[3 * i]);
    const std::int32_t found =
        is_solid(cloud, i) ? cells.cluster[std::size_t(cells.index(cell))] : cells.adjacent_cluster(cell);
    out.of_row[i] = found;
    if (found < 0) continue;
    out.size.resize(std::max(out.size.size(), std::size_t(found) + 1));
    ++out.size[std::size_t(found)];
  }
  return out;
}

std::vector<std::uint32_t> canonical_rows(const GaussianCloud& cloud) {
  std::vector<std::uint32_t> rows;
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i)
    if (cloud.usable[i]) rows.push_back(std::uint32_t(i));
  std::sort(rows.begin(), rows.end(),
            [&](std::uint32_t a, std::uint32_t b) { return key_of(cloud, a) < key_of(cloud, b); });
  return rows;
}

orbit::SurfacePoints canonical_points(const GaussianCloud& cloud, const std::vector<std::uint8_t>& member) {
  NGS_CHECK(member.empty() || std::int64_t(member.size()) == cloud.size(), "one entry per Gaussian");
  const orbit::SurfacePoints all = orbit::surface_points(cloud);
  constexpr std::uint32_t kNone = std::uint32_t(-1);
  std::vector<std::uint32_t> point_of(std::size_t(cloud.size()), kNone);
  for (std::size_t k = 0; k < all.count(); ++k)
    if (member.empty() || member[all.row[k]]) point_of[all.row[k]] = std::uint32_t(k);
  orbit::SurfacePoints out;
  for (const std::uint32_t row : canonical_rows(cloud))
    if (const std::uint32_t k = point_of[row]; k != kNone) out.add(all, k);
  return out;
}

}  // namespace ngs
