#include "ngs/mesh/simplify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <string>
#include <vector>

#include "ngs/core/error.h"

namespace ngs::mesh {
namespace {

using Vec = Vec3<double>;
using FaceRows = std::array<std::uint32_t, 3>;

constexpr double kLeastCosine = 0.2;    // minimum cosine between the normals of a face before and after a collapse
constexpr double kPull = 1e-4;          // weight of the distance to the vertex itself, against that to its planes
constexpr double kDeterminant = 1e-10;  // minimum determinant of a quadric / trace cubed, for a unique minimum

/// The sum of squared distances to planes: x'Ax + 2 b'x + c.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, bx = 0, by = 0, bz = 0, c = 0;

  void add_plane(Vec n, double offset, double weight) {
    xx += weight * n.x * n.x;
    xy += weight * n.x * n.y;
    xz += weight * n.x * n.z;
    yy += weight * n.y * n.y;
    yz += weight * n.y * n.z;
    zz += weight * n.z * n.z;
    bx += weight * offset * n.x;
    by += weight * offset * n.y;
    bz += weight * offset * n.z;
    c += weight * offset * offset;
  }
  void add_point(Vec p, double weight) {
    add_plane({1, 0, 0}, -p.x, weight);
    add_plane({0, 1, 0}, -p.y, weight);
    add_plane({0, 0, 1}, -p.z, weight);
  }
  Quadric operator+(const Quadric& o) const {
    return {xx + o.xx, xy + o.xy, xz + o.xz, yy + o.yy, yz + o.yz, zz + o.zz, bx + o.bx, by + o.by, bz + o.bz, c + o.c};
  }
  double at(Vec p) const {
    const Vec a{xx * p.x + xy * p.y + xz * p.z, xy * p.x + yy * p.y + yz * p.z, xz * p.x + yz * p.y + zz * p.z};
    return dot(p, a) + 2 * dot(Vec{bx, by, bz}, p) + c;
  }
  /// The minimum, by Cramer's rule; false if it is not defined well.
  bool minimum(Vec& p) const {
    const Vec r0{xx, xy, xz}, r1{xy, yy, yz}, r2{xz, yz, zz};
    const Vec c0 = cross(r1, r2), c1 = cross(r2, r0), c2 = cross(r0, r1);
    const double determinant = dot(r0, c0), trace = xx + yy + zz;
    if (!(determinant > kDeterminant * trace * trace * trace)) return false;
    p = (-1 / determinant) * (bx * c0 + by * c1 + bz * c2);
    return true;
  }
};

struct Candidate {
  double error;
  std::uint32_t a, b;                  // a < b
  std::uint32_t version_a, version_b;  // when it was made; later ones replace it
  Vec place;

  bool operator<(const Candidate& o) const {  // of a queue whose top is the largest
    if (error != o.error) return error > o.error;
    return a != o.a ? a > o.a : b > o.b;
  }
};

class Simplification {
 public:
  explicit Simplification(const TriangleMesh& mesh)
      : face_(mesh.faces),
        faces_(mesh.faces.size()),
        quadric_(mesh.vertices.size()),
        of_(mesh.vertices.size()),
        version_(mesh.vertices.size()),
        mark_(mesh.vertices.size()) {
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) at_.push_back(mesh.at(v));
    for (std::uint32_t f = 0; f < face_.size(); ++f) add_face(f);
  }

  void run(std::size_t most_faces) {
    for (const FaceRows& face : face_)
      for (std::size_t k = 0; k < 3; ++k)
        if (face[k] < face[(k + 1) % 3]) push(face[k], face[(k + 1) % 3]);
    while (faces_ > most_faces && !queue_.empty()) {
      const Candidate edge = queue_.top();
      queue_.pop();
      if (edge.version_a == version_[edge.a] && edge.version_b == version_[edge.b] && may_collapse(edge))
        collapse(edge);
    }
  }

  TriangleMesh result() const {
    TriangleMesh mesh;
    std::vector<std::uint32_t> number(at_.size());
    for (std::size_t v = 0; v < at_.size(); ++v) {
      if (of_[v].empty()) continue;
      number[v] = std::uint32_t(mesh.vertices.size());
      mesh.vertices.push_back({float(at_[v].x), float(at_[v].y), float(at_[v].z)});
    }
    for (const FaceRows& f : face_)
      if (f[0] != f[1]) mesh.faces.push_back({number[f[0]], number[f[1]], number[f[2]]});
    return mesh;
  }

 private:
  void add_face(std::uint32_t f) {
    const FaceRows& v = face_[f];
    const Vec twice = cross(at_[v[1]] - at_[v[0]], at_[v[2]] - at_[v[0]]);
    const double area = 0.5 * length(twice);
    const Vec normal = unit(twice);
    Quadric plane;
    plane.add_plane(normal, -dot(normal, at_[v[0]]), area);
    for (const std::uint32_t k : v) {
      Quadric own = plane;
      own.add_point(at_[k], kPull * area);
      quadric_[k] = quadric_[k] + own;
      of_[k].push_back(f);
    }
  }

  void push(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    const Quadric sum = quadric_[a] + quadric_[b];
    Candidate edge{0, a, b, version_[a], version_[b], 0.5 * (at_[a] + at_[b])};
    const Vec middle = edge.place, span = at_[a] - at_[b];
    Vec best;
    // A minimum far from the edge belongs to nearly parallel planes.
    if (sum.minimum(best) && dot(best - middle, best - middle) <= dot(span, span)) {
      edge.place = best;
    } else {
      for (const Vec end : {at_[a], at_[b]})
        if (sum.at(end) < sum.at(edge.place)) edge.place = end;
    }
    edge.error = std::max(sum.at(edge.place), 0.0);
    if (std::isfinite(edge.error)) queue_.push(edge);
  }

  static bool has(const FaceRows& f, std::uint32_t v) { return f[0] == v || f[1] == v || f[2] == v; }

  /// Whether the links of both ends meet only in the two vertices opposite of the edge.
  bool keeps_topology(const Candidate& edge) {
    ++stamp_;
    for (const std::uint32_t f : of_[edge.a])
      for (const std::uint32_t v : face_[f]) mark_[v] = stamp_;
    mark_[edge.a] = mark_[edge.b] = 0;
    std::vector<std::uint32_t>& shared = scratch_;
    shared.clear();
    int on_edge = 0;
    for (const std::uint32_t f : of_[edge.b]) {
      on_edge += has(face_[f], edge.a);
      for (const std::uint32_t v : face_[f])
        if (mark_[v] == stamp_) {
          shared.push_back(v);
          mark_[v] = 0;
        }
    }
    if (on_edge != 2 || shared.size() != 2) return false;
    return of_[shared[0]].size() > 3 && of_[shared[1]].size() > 3;
  }

  bool keeps_normals(std::uint32_t moved, std::uint32_t other, Vec place) const {
    for (const std::uint32_t f : of_[moved]) {
      if (has(face_[f], other)) continue;
      std::array<Vec, 3> before, after;
      for (std::size_t k = 0; k < 3; ++k) {
        before[k] = at_[face_[f][k]];
        after[k] = face_[f][k] == moved ? place : before[k];
      }
      const Vec n = cross(before[1] - before[0], before[2] - before[0]);
      const Vec m = cross(after[1] - after[0], after[2] - after[0]);
      if (!(dot(n, m) > kLeastCosine * length(n) * length(m))) return false;
    }
    return true;
  }

  bool may_collapse(const Candidate& edge) {
    return keeps_topology(edge) && keeps_normals(edge.a, edge.b, edge.place) &&
           keeps_normals(edge.b, edge.a, edge.place);
  }

  void collapse(const Candidate& edge) {
    at_[edge.a] = edge.place;
    quadric_[edge.a] = quadric_[edge.a] + quadric_[edge.b];
    ++version_[edge.a];
    ++version_[edge.b];
    for (const std::uint32_t f : of_[edge.b]) {
      FaceRows& face = face_[f];
      if (!has(face, edge.a)) {
        std::replace(face.begin(), face.end(), edge.b, edge.a);
        of_[edge.a].push_back(f);
        continue;
      }
      for (const std::uint32_t v : face)
        if (v != edge.b) std::erase(of_[v], f);
      face = {0, 0, 0};
      --faces_;
    }
    of_[edge.b].clear();
    for (const std::uint32_t f : of_[edge.a])
      for (std::size_t k = 0; k < 3; ++k)  // the ring of `a`: each neighbour follows it in one face
        if (face_[f][k] == edge.a) push(edge.a, face_[f][(k + 1) % 3]);
  }

  std::vector<Vec> at_;
  std::vector<FaceRows> face_;  // removed: three equal vertices
  std::size_t faces_;
  std::vector<Quadric> quadric_;
  std::vector<std::vector<std::uint32_t>> of_;  // faces of each vertex
  std::vector<std::uint32_t> version_, mark_, scratch_;
  std::uint32_t stamp_ = 0;
  std::priority_queue<Candidate> queue_;
};

}  // namespace

void simplify(std::size_t most_faces, TriangleMesh& mesh) {
  for (const FaceRows& face : mesh.faces)
    if (*std::max_element(face.begin(), face.end()) >= mesh.vertices.size())
      throw Error(ErrorCode::kInconsistent,
                  "mesh: a face names a vertex beyond its " + std::to_string(mesh.vertices.size()) +
                      " vertices, expected one of them",
                  "write the mesh again");
  if (mesh.faces.size() <= most_faces) return;
  Simplification state(mesh);
  state.run(most_faces);
  mesh = state.result();
}

}  // namespace ngs::mesh
