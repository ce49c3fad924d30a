#include "ngs/mesh/surface/iso_surface.h"

#include <algorithm>
#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/math/union_find.h"

namespace ngs::mesh {
namespace {

struct Piece {
  double volume = 0, area = 0;
};

void remove_unused_vertices(TriangleMesh& mesh) {
  std::vector<std::uint32_t> number(mesh.vertices.size(), 0);
  for (const auto& face : mesh.faces)
    for (const std::uint32_t v : face) number[v] = 1;
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (!number[v]) continue;
    mesh.vertices[kept] = mesh.vertices[v];
    if (!mesh.colours.empty()) mesh.colours[kept] = mesh.colours[v];
    number[v] = kept++;
  }
  mesh.vertices.resize(kept);
  if (!mesh.colours.empty()) mesh.colours.resize(kept);
  for (auto& face : mesh.faces)
    for (std::uint32_t& v : face) v = number[v];
}

using Place = std::array<int, 3>;

constexpr int kSide = kBlockCells + 1;  // samples of a block along an axis
constexpr double kMargin = 0.02;        // least distance of a vertex from a sample, in cells: no face degenerates

std::size_t sample_index(int x, int y, int z) {
  return (std::size_t(z) * kSide + std::size_t(y)) * kSide + std::size_t(x);
}

/// Corner c of a cell: (c & 1, c >> 1 & 1, c >> 2 & 1). Edge 4 a + k: along axis a from the k-th corner with a 0 there.
struct CellEdge {
  int axis, from;
};
CellEdge cell_edge(int e) {
  const int axis = e / 4, k = e % 4;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  return {axis, (k & 1) << u | (k >> 1) << v};
}
int edge_between(int a, int b) {
  for (int e = 0; e < 12; ++e)
    if (const CellEdge edge = cell_edge(e);
        edge.from == std::min(a, b) && (edge.from | 1 << edge.axis) == std::max(a, b))
      return e;
  return -1;
}

struct Polygon {
  std::vector<int> edges;   // counter-clockwise seen from outside
  bool has_centre = false;  // crosses a face of the cell twice
};

/// The polygons of a cell whose corners `inside` (bits) are inside.
std::vector<Polygon> polygons_of(int inside) {
  const auto is_in = [&](int corner) { return (inside >> corner & 1) != 0; };
  std::array<int, 12> next{};
  next.fill(-1);
  std::array<std::vector<int>, 12> faces;  // of each edge: those with four crossings
  for (int f = 0; f < 6; ++f) {
    const int axis = f / 2, u = (axis + 1) % 3, v = (axis + 2) % 3, side = (f & 1) << axis;
    std::array<int, 4> ring{side, side | 1 << u, side | 1 << u | 1 << v, side | 1 << v};
    if ((f & 1) == 0) std::swap(ring[1], ring[3]);
    std::vector<int> entering, leaving;  // crossings into and out of each run of inside corners, in order
    for (std::size_t k = 0; k < 4; ++k) {
      const int a = ring[k], b = ring[(k + 1) % 4];
      if (!is_in(a) && is_in(b)) {
        const int in = edge_between(a, b);
        std::size_t m = k + 1;
        while (is_in(ring[(m + 1) % 4])) ++m;
        entering.push_back(in);
        leaving.push_back(edge_between(ring[m % 4], ring[(m + 1) % 4]));
      }
    }
    for (std::size_t k = 0; k < entering.size(); ++k) {
      next[std::size_t(entering[k])] = leaving[k];
      if (entering.size() == 2)
        for (const int e : {entering[k], leaving[k]}) faces[std::size_t(e)].push_back(f);
    }
  }
  std::vector<Polygon> polygons;
  std::array<bool, 12> done{};
  for (int first = 0; first < 12; ++first) {
    if (next[std::size_t(first)] < 0 || done[std::size_t(first)]) continue;
    Polygon polygon;
    std::array<int, 6> crossings{};
    for (int e = first; !done[std::size_t(e)]; e = next[std::size_t(e)]) {
      done[std::size_t(e)] = true;
      polygon.edges.push_back(e);
      for (const int f : faces[std::size_t(e)]) polygon.has_centre |= ++crossings[std::size_t(f)] > 2;
    }
    polygons.push_back(std::move(polygon));
  }
  return polygons;
}

const std::array<std::vector<Polygon>, 256>& polygon_table() {
  static const std::array<std::vector<Polygon>, 256> table = [] {
    std::array<std::vector<Polygon>, 256> all;
    for (int inside = 0; inside < 256; ++inside) all[std::size_t(inside)] = polygons_of(inside);
    return all;
  }();
  return table;
}

struct Block {
  Place low{};                      // its first sample
  std::vector<float> value;         // [9, 9, 9]
  std::vector<std::uint16_t> slot;  // 3 · (cell of the lower sample) + axis of the crossed edges it owns, ascending
  std::uint32_t first_vertex = 0;   // of `slot`, in order; then the centres of its polygons
  std::uint32_t centres = 0;
  std::vector<std::array<std::uint32_t, 3>> faces;

  bool is_in(int x, int y, int z) const { return value[sample_index(x, y, z)] < 0; }
};

class Extraction {
 public:
  Extraction(const Exec& exec, const SampleGrid& grid, const BlockValues& values)
      : exec_(exec), grid_(grid), values_(values), block_at_(grid.block_count(), -1) {}

  TriangleMesh run(std::vector<std::uint32_t> pending) {
    while (!pending.empty()) pending = sample(std::move(pending));
    for_each_task(exec_, std::ssize(blocks_), [&](std::int64_t b) { find_crossings(blocks_[std::size_t(b)]); });
    std::uint32_t vertices = 0;
    for (Block& block : blocks_) {
      block.first_vertex = vertices;
      vertices += std::uint32_t(block.slot.size()) + block.centres;
    }
    mesh_.vertices.resize(vertices);
    for_each_task(exec_, std::ssize(blocks_), [&](std::int64_t b) { place_vertices(blocks_[std::size_t(b)]); });
    for_each_task(exec_, std::ssize(blocks_), [&](std::int64_t b) { add_faces(blocks_[std::size_t(b)]); });
    for (const Block& block : blocks_) mesh_.faces.insert(mesh_.faces.end(), block.faces.begin(), block.faces.end());
    return std::move(mesh_);
  }

 private:
  /// Samples new blocks; returns those into which the surface continues.
  std::vector<std::uint32_t> sample(std::vector<std::uint32_t> pending) {
    std::sort(pending.begin(), pending.end());
    pending.erase(std::unique(pending.begin(), pending.end()), pending.end());
    std::erase_if(pending, [&](std::uint32_t b) { return block_at_[b] >= 0; });
    const std::size_t first = blocks_.size();
    blocks_.resize(first + pending.size());
    for (std::size_t k = 0; k < pending.size(); ++k) block_at_[pending[k]] = std::int32_t(first + k);
    for_each_task(exec_, std::ssize(pending), [&](std::int64_t k) {
      const auto number = int(pending[std::size_t(k)]);
      Block& block = blocks_[first + std::size_t(k)];
      block.low = {number % grid_.blocks[0] * kBlockCells, number / grid_.blocks[0] % grid_.blocks[1] * kBlockCells,
                   number / grid_.blocks[0] / grid_.blocks[1] * kBlockCells};
      block.value.resize(std::size_t(kSide) * kSide * kSide);
      values_(block.low, block.value);
      close_border(block);
    });
    std::vector<std::uint32_t> further;
    for (std::size_t b = first; b < blocks_.size(); ++b) add_neighbours(blocks_[b], further);
    return further;
  }

  void close_border(Block& block) const {
    const auto is_border = [&](int axis, int at) {
      const auto a = std::size_t(axis);
      return block.low[a] + at == 0 || block.low[a] + at == grid_.blocks[a] * kBlockCells;
    };
    for (int z = 0; z < kSide; ++z)
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
          float& value = block.value[sample_index(x, y, z)];
          if (is_border(0, x) || is_border(1, y) || is_border(2, z) || std::isnan(value)) value = 1;
        }
  }

  void add_neighbours(const Block& block, std::vector<std::uint32_t>& further) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {0, kBlockCells}) {
        int inside = 0;
        for (int j = 0; j < kSide; ++j)
          for (int k = 0; k < kSide; ++k) {
            Place at{};
            at[axis] = side;
            at[(axis + 1) % 3] = j;
            at[(axis + 2) % 3] = k;
            inside += block.is_in(at[0], at[1], at[2]);
          }
        if (inside == 0 || inside == kSide * kSide) continue;  // never at the border of the grid
        Place low = block.low;
        low[axis] += side == 0 ? -kBlockCells : kBlockCells;
        further.push_back(number_of(low));
      }
  }

  std::uint32_t number_of(Place at) const {
    return std::uint32_t(at[0] / kBlockCells +
                         grid_.blocks[0] * (at[1] / kBlockCells + grid_.blocks[1] * (at[2] / kBlockCells)));
  }

  static int corners_inside(const Block& block, int x, int y, int z) {
    int inside = 0;
    for (int c = 0; c < 8; ++c) inside |= int(block.is_in(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2))) << c;
    return inside;
  }

  template <class Visit>
  static void for_each_cell(const Visit& visit) {
    for (int z = 0; z < kBlockCells; ++z)
      for (int y = 0; y < kBlockCells; ++y)
        for (int x = 0; x < kBlockCells; ++x) visit(x, y, z);
  }

  static std::uint16_t slot_of(int x, int y, int z, int axis) {
    return std::uint16_t(3 * ((z * kBlockCells + y) * kBlockCells + x) + axis);
  }

  static void find_crossings(Block& block) {
    for_each_cell([&](int x, int y, int z) {
      const bool is_in = block.is_in(x, y, z);
      for (int axis = 0; axis < 3; ++axis)
        if (block.is_in(x + (axis == 0), y + (axis == 1), z + (axis == 2)) != is_in)
          block.slot.push_back(slot_of(x, y, z, axis));
      for (const Polygon& polygon : polygon_table()[std::size_t(corners_inside(block, x, y, z))])
        block.centres += polygon.has_centre;
    });
  }

  void place_vertices(const Block& block) {
    for (std::size_t k = 0; k < block.slot.size(); ++k) {
      const int axis = block.slot[k] % 3, cell = block.slot[k] / 3;
      const int x = cell % kBlockCells, y = cell / kBlockCells % kBlockCells, z = cell / kBlockCells / kBlockCells;
      const auto a = double(block.value[sample_index(x, y, z)]);
      const auto b = double(block.value[sample_index(x + (axis == 0), y + (axis == 1), z + (axis == 2))]);
      const double t = std::clamp(a / (a - b), kMargin, 1 - kMargin);
      Vec3<double> at = grid_.at(block.low[0] + x, block.low[1] + y, block.low[2] + z);
      (axis == 0 ? at.x : axis == 1 ? at.y : at.z) += t * grid_.cell;
      mesh_.vertices[block.first_vertex + k] = {float(at.x), float(at.y), float(at.z)};
    }
  }

  /// The vertex on a crossed edge of the grid, which the block of its lower end owns.
  std::uint32_t vertex_on(Place at, int axis) const {
    const Block& owner = blocks_[std::size_t(block_at_[number_of(at)])];
    const std::uint16_t slot = slot_of(at[0] % kBlockCells, at[1] % kBlockCells, at[2] % kBlockCells, axis);
    const auto found = std::lower_bound(owner.slot.begin(), owner.slot.end(), slot);
    NGS_CHECK(found != owner.slot.end() && *found == slot, "neighbouring blocks have the same samples");
    return owner.first_vertex + std::uint32_t(found - owner.slot.begin());
  }

  void add_faces(Block& block) {
    std::uint32_t centre = block.first_vertex + std::uint32_t(block.slot.size());
    for_each_cell([&](int x, int y, int z) {
      for (const Polygon& polygon : polygon_table()[std::size_t(corners_inside(block, x, y, z))]) {
        std::vector<std::uint32_t> ring;
        for (const int e : polygon.edges) {
          const CellEdge edge = cell_edge(e);
          ring.push_back(vertex_on({block.low[0] + x + (edge.from & 1), block.low[1] + y + (edge.from >> 1 & 1),
                                    block.low[2] + z + (edge.from >> 2)},
                                   edge.axis));
        }
        if (!polygon.has_centre) {
          for (std::size_t k = 1; k + 1 < ring.size(); ++k) block.faces.push_back({ring[0], ring[k], ring[k + 1]});
          continue;
        }
        Vec3<float> sum{0, 0, 0};
        for (const std::uint32_t v : ring) sum = sum + mesh_.vertices[v];
        mesh_.vertices[centre] = 1.f / float(ring.size()) * sum;
        for (std::size_t k = 0; k < ring.size(); ++k)
          block.faces.push_back({centre, ring[k], ring[(k + 1) % ring.size()]});
        ++centre;
      }
    });
  }

  const Exec& exec_;
  const SampleGrid& grid_;
  const BlockValues& values_;
  std::vector<std::int32_t> block_at_;  // [blocks of the grid] index of the sampled block, or -1
  std::vector<Block> blocks_;
  TriangleMesh mesh_;
};

}  // namespace

PieceCounts keep_pieces(double least_share, TriangleMesh& mesh) {
  UnionFind sets(mesh.vertices.size());
  for (const auto& [a, b, c] : mesh.faces) {
    sets.join(a, b);
    sets.join(b, c);
  }
  std::vector<Piece> piece(mesh.vertices.size());  // at the root of each set
  for (const auto& face : mesh.faces) {
    const Vec3<double> a = mesh.at(face[0]), b = mesh.at(face[1]), c = mesh.at(face[2]);
    Piece& of = piece[sets.root(face[0])];
    of.volume += dot(a, cross(b, c)) / 6;
    of.area += length(cross(b - a, c - a)) / 2;
  }
  double largest = 0;
  for (const Piece& p : piece)
    if (p.volume > 0) largest = std::max(largest, p.area);
  PieceCounts counts;
  for (const Piece& p : piece) {
    if (!(p.area > 0)) continue;
    ++(p.volume <= 0 ? counts.cavities : p.area < least_share * largest ? counts.crumbs : counts.kept);
  }
  std::erase_if(mesh.faces, [&](const auto& face) {
    const Piece& of = piece[sets.root(face[0])];
    return of.volume <= 0 || of.area < least_share * largest;
  });
  remove_unused_vertices(mesh);
  return counts;
}

TriangleMesh iso_surface(const Exec& exec, const SampleGrid& grid, const std::vector<std::uint32_t>& seeds,
                         const BlockValues& values) {
  return Extraction(exec, grid, values).run(seeds);
}

}  // namespace ngs::mesh
