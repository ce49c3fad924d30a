#include "ngs/mesh/surface/pieces.h"

#include <algorithm>
#include <vector>

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

}  // namespace ngs::mesh
