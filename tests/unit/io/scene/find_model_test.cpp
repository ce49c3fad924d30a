// Search for the splat in a capture's folder.
#include "ngs/io/scene/find_model.h"

#include <doctest/doctest.h>

#include "support/ply_text.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

using test::contains;
using test::TempDir;

std::string splat(int n = 3) { return test::ply_bytes({test::inria_columns(n, 0)}, io::PlyFormat::kBinaryLittle); }

std::string point_cloud() {
  test::PlyColumns points;
  for (const char* name : {"x", "y", "z"}) points.properties.push_back({name, io::PlyType::kFloat32});
  for (const char* name : {"red", "green", "blue"}) points.properties.push_back({name, io::PlyType::kUint8});
  points.rows = {{0, 0, 0, 1, 2, 3}};
  return test::ply_bytes({points}, io::PlyFormat::kAscii);
}

}  // namespace

TEST_CASE("the only splat among point clouds is the model, whatever the file names") {
  for (const char* points : {"sparse_pc.ply", "init.ply", "fused.ply", "point_cloud.ply", "a.ply"})
    for (const char* model : {"splat.ply", "Scan.PLY", "z.splat"}) {
      CAPTURE(points);
      CAPTURE(model);
      const TempDir dir;
      dir.write(points, point_cloud());
      dir.write(model, splat());
      CHECK(io::find_model(dir.path()).path == dir.file(model));
    }
}

TEST_CASE("with several splats none is chosen, and the error lists each with its kind") {
  const TempDir dir;
  dir.write("export_10000.ply", splat(3));
  dir.write("export_30000.ply", splat(5));
  dir.write("sparse_pc.ply", point_cloud());
  const io::ModelSearch found = io::find_model(dir.path());
  CHECK(found.path.empty());
  CHECK(contains(found.problem, "export_10000.ply (a splat of 3 Gaussians), "));
  CHECK(contains(found.problem, "export_30000.ply (a splat of 5 Gaussians)"));
  CHECK(!contains(found.problem, "sparse_pc.ply"));
}

TEST_CASE("without a splat the error lists the files with their kinds") {
  const TempDir dir;
  CHECK(contains(io::find_model(dir.path()).problem, "no splat found"));
  dir.write("fused.ply", point_cloud());
  const io::ModelSearch found = io::find_model(dir.path());
  CHECK(found.path.empty());
  CHECK(contains(found.problem, "fused.ply (a point cloud of 1 points)"));
}

TEST_CASE("a splat up to two folders below is found if the capture's folder has none, but not in result folders") {
  const TempDir dir;
  dir.write("sparse_pc.ply", point_cloud());
  dir.write("exports/splat/splat.ply", splat());
  dir.write("capture-cut/object.ply", splat());
  dir.write("capture-cut/.ngs-cut", "");
  dir.write("out/object.ply", splat());
  dir.write("out/scene.json", "{}");
  CHECK(io::find_model(dir.path()).path == dir.file("exports/splat/splat.ply"));
  dir.write("exports/old/splat.ply", splat());
  CHECK(contains(io::find_model(dir.path()).problem, "exports/old/splat.ply (a splat"));
}

TEST_CASE("a splat with a standard name is the model, and other splats in its folder are listed as unused") {
  const TempDir dir;
  dir.write("other.ply", splat(7));
  dir.write("point_cloud.ply", splat(3));
  const io::ModelSearch found = io::find_model(dir.path());
  CHECK(found.path == dir.file("point_cloud.ply"));
  CHECK(contains(found.unused, "point_cloud.ply is the model, not "));
  CHECK(contains(found.unused, "other.ply (a splat of 7 Gaussians)"));
}

TEST_CASE("the newest iteration of a training is the model, and the older ones are listed as unused") {
  const TempDir dir;
  dir.write("point_cloud/iteration_7000/point_cloud.ply", splat(3));
  dir.write("point_cloud/iteration_30000/point_cloud.ply", splat(5));
  const io::ModelSearch found = io::find_model(dir.path());
  CHECK(found.path == dir.file("point_cloud/iteration_30000/point_cloud.ply"));
  CHECK(contains(found.unused, "iteration_7000/point_cloud.ply (a splat of 3 Gaussians)"));
}

TEST_CASE("the newest iteration of a trainer's output one or two folders below is the model") {
  for (const std::string output : {"output/", "output/1a2b/"}) {
    const TempDir dir;
    dir.write(output + "point_cloud/iteration_7000/point_cloud.ply", splat(3));
    dir.write(output + "point_cloud/iteration_30000/point_cloud.ply", splat(5));
    dir.write("._other.ply", splat(2));
    CHECK(io::find_model(dir.path()).path == dir.file(output + "point_cloud/iteration_30000/point_cloud.ply"));
  }
}

TEST_CASE("settings of a trainer that state antialiasing are found next to its model and above, no farther") {
  const TempDir dir;
  const std::string model = "run/point_cloud/iteration_7/point_cloud.ply";
  dir.write(model, splat());
  dir.write("cfg_args", "Namespace(antialiasing=True)");
  dir.write("run/cfg_args", "Namespace(antialiasing=False, sh_degree=3)");
  CHECK(io::antialiasing_settings(dir.file(model)).empty());
  dir.write("run/cfg_args", "Namespace(antialiasing=True, sh_degree=3)");
  CHECK(io::antialiasing_settings(dir.file(model)) == dir.file("run/cfg_args"));
  dir.write("gsplat/cfg.yml", "antialiased: true\n");
  CHECK(io::antialiasing_settings(dir.file("gsplat/ply/point_cloud_6999.ply")) == dir.file("gsplat/cfg.yml"));
}

TEST_CASE("a truncated splat is still chosen as the model, so that its reader reports the error") {
  const TempDir dir;
  dir.write("model.ply", splat().substr(0, 60));
  CHECK(io::find_model(dir.path()).path == dir.file("model.ply"));
}

}  // namespace ngs
