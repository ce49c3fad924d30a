#include "support/recipe_mesh.h"

#include <algorithm>
#include <limits>

#include "ngs/core/check.h"
#include "ngs/mesh/surface/iso_surface.h"

namespace ngs::test {

synth::Object recipe_object(const std::string& recipe, const std::string& object) {
  const synth::AnalyticScene scene = synth::build_scene(synth::named_recipe(recipe));
  const auto found = std::ranges::find(scene.objects, object, &synth::Object::name);
  NGS_CHECK(found != scene.objects.end(), "no such object");
  return *found;
}

double distance(const synth::Object& object, Vec3<double> p) {
  double least = std::numeric_limits<double>::infinity();
  for (const synth::Solid& solid : object.solids) least = std::min(least, synth::signed_distance(solid, p));
  return least;
}

TriangleMesh recipe_mesh(const std::string& recipe, const std::string& name, int cells) {
  const synth::Object object = recipe_object(recipe, name);
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec3<double> low{kFar, kFar, kFar};
  Vec3<double> high{-kFar, -kFar, -kFar};
  for (const auto& [kind, c, to_local, size, rounding, r] : object.solids) {
    low = {std::min(low.x, c.x - r), std::min(low.y, c.y - r), std::min(low.z, c.z - r)};
    high = {std::max(high.x, c.x + r), std::max(high.y, c.y + r), std::max(high.z, c.z + r)};
  }
  mesh::SampleGrid grid;
  const Vec3<double> size = high - low;
  grid.cell = std::max({size.x, size.y, size.z}) / cells;
  grid.low = low - Vec3<double>{2 * grid.cell, 2 * grid.cell, 2 * grid.cell};
  const auto blocks = [&](double length) { return int(length / grid.cell + 4) / mesh::kBlockCells + 1; };
  grid.blocks = {blocks(size.x), blocks(size.y), blocks(size.z)};
  std::vector<std::uint32_t> seeds;
  for (std::uint32_t block = 0; block < grid.block_count(); ++block) seeds.push_back(block);
  return mesh::iso_surface({}, grid, seeds, [&](std::array<int, 3> at, std::vector<float>& values) {
    constexpr int kSide = mesh::kBlockCells + 1;
    values.clear();
    for (int k = 0; k < kSide * kSide * kSide; ++k)
      values.push_back(
          float(distance(object, grid.at(at[0] + k % kSide, at[1] + k / kSide % kSide, at[2] + k / kSide / kSide))));
  });
}

}  // namespace ngs::test
