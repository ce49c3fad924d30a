// Colliders of the objects of analytic scenes.
//
//   ngs_collider_truth RECIPE OBJECT KIND [CELLS [FACES]]
//
// KIND: box, hull or convex:N. The mesh has CELLS cells along its longest side (default 192) and FACES faces (default
// 50000), as those of ngs-mesh. stdout, tab separated:
//
//   RECIPE OBJECT KIND PARTS OUTSIDE_PERCENT MISSING_PERCENT OUTSIDE_DISTANCE_PERCENT CPU_S
//
// Volumes of the mesh's volume; the distance of the longest side of the mesh.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "ngs/core/error.h"
#include "ngs/mesh/collider/collider.h"
#include "ngs/mesh/simplify.h"
#include "support/mesh_truth.h"

namespace ngs::bench {
namespace {

double longest_side(const TriangleMesh& mesh) {
  double longest = 0;
  for (float Vec3<float>::*axis : {&Vec3<float>::x, &Vec3<float>::y, &Vec3<float>::z}) {
    const auto [low, high] = std::ranges::minmax_element(mesh.vertices, {}, axis);
    longest = std::max(longest, double((*high).*axis) - double((*low).*axis));
  }
  return longest;
}

void run(int argc, char** argv) {
  TriangleMesh mesh = test::true_mesh(test::recipe_object(argv[1], argv[2]), argc > 4 ? std::atoi(argv[4]) : 192);
  mesh::simplify(argc > 5 ? std::size_t(std::atoi(argv[5])) : 50000, mesh);
  const std::clock_t begin = std::clock();
  const mesh::Collider collider = mesh::make_collider({.threads = 2}, mesh, mesh::collider_choice(argv[3]));
  const double cpu_s = double(std::clock() - begin) / CLOCKS_PER_SEC;
  std::printf("%s\t%s\t%s\t%zu\t%.2f\t%.2f\t%.2f\t%.1f\n", argv[1], argv[2], argv[3], collider.parts.size(),
              100 * collider.outside_share, 100 * collider.missing_share,
              100 * collider.outside_distance / longest_side(mesh), cpu_s);
}

}  // namespace
}  // namespace ngs::bench

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: ngs_collider_truth RECIPE OBJECT KIND [CELLS [FACES]]\n");
    return 2;
  }
  try {
    ngs::bench::run(argc, argv);
    return 0;
  } catch (const ngs::Error& e) {
    std::fprintf(stderr, "ngs_collider_truth: %s\n", e.what());
    return int(e.code());
  }
}
