// Scores the mesh of an object against the analytic truth of its recipe.
//
//   ngs_mesh_truth RECIPE SPLAT [--resolution N] [--faces N] [--views N] [--background SPLAT]
//
// SPLAT: object.ply of the recipe's target, or "discs:N": N flat discs on the true surface. stdout, tab separated:
//
//   RECIPE FACES TO_TRUTH_PX FROM_TRUTH_PX NORMAL_DEG WITHIN_PX IOU BORDER NON_MANIFOLD CPU_S
//
// Distances in pixels of the recipe's photos at the distance of the target, where one of VIEWS cameras sees it;
// WITHIN_PX: the share of the seen true surface that is at most a pixel from the mesh.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "ngs/core/error.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/mesh/measures.h"
#include "ngs/mesh/surface/surface_stage.h"
#include "support/mesh_truth.h"

namespace ngs::bench {
namespace {

int run(int argc, char** argv) {
  synth::Recipe recipe = synth::named_recipe(argv[1]);
  recipe.views = 16;
  mesh::MeshOptions options;
  GaussianCloud rest;
  for (int k = 3; k + 1 < argc; k += 2) {
    if (std::strcmp(argv[k], "--background") == 0) rest = io::read_gaussian_ply(argv[k + 1]).cloud;
    const int value = std::atoi(argv[k + 1]);
    if (std::strcmp(argv[k], "--resolution") == 0) options.resolution = value;
    if (std::strcmp(argv[k], "--faces") == 0) options.faces = value;
    if (std::strcmp(argv[k], "--views") == 0) recipe.views = value;
  }
  const synth::AnalyticScene scene = synth::build_scene(recipe);
  const synth::Object& target = scene.objects[std::size_t(scene.target)];
  const bool discs = std::strncmp(argv[2], "discs:", 6) == 0;
  const GaussianCloud cloud =
      discs ? test::splat_of(target, std::atoi(argv[2] + 6)) : io::read_gaussian_ply(argv[2]).cloud;
  Monitor monitor;
  const std::clock_t begin = std::clock();
  const std::vector<FillSurface> planes = mesh::planes_behind({.threads = 2}, cloud, rest, 0);
  const mesh::ObjectMesh object = mesh::mesh_of({.threads = 2}, monitor, cloud, options, planes);
  const double cpu_s = double(std::clock() - begin) / CLOCKS_PER_SEC;
  const double pixel = scene.rig_radius / synth::recipe_camera(recipe).fx;
  const std::vector<Camera> cameras = discs ? std::vector<Camera>{} : synth::build_rig(recipe, scene);
  const test::MeshScore score = test::score_of(object.mesh, scene, scene.target, cameras, pixel);
  const mesh::MeshMeasures measures = mesh::measures_of(object.mesh);
  std::printf("%s\t%zu\t%.3f\t%.3f\t%.1f\t%.3f\t%.3f\t%zu\t%zu\t%.1f\n", argv[1], object.mesh.faces.size(),
              score.to_truth / pixel, score.from_truth / pixel, score.normal_deg, score.seen_within, score.iou,
              measures.border_edges, measures.non_manifold_edges, cpu_s);
  return 0;
}

}  // namespace
}  // namespace ngs::bench

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr,
                 "usage: ngs_mesh_truth RECIPE SPLAT [--resolution N] [--faces N] [--views N] [--background SPLAT]\n");
    return 2;
  }
  try {
    return ngs::bench::run(argc, argv);
  } catch (const ngs::Error& e) {
    std::fprintf(stderr, "ngs_mesh_truth: %s\n", e.what());
    return int(e.code());
  }
}
