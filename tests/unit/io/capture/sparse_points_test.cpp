#include "ngs/io/capture/sparse_points.h"

#include <doctest/doctest.h>

#include <cstring>
#include <limits>

#include "ngs/core/error.h"
#include "ngs/io/capture/colmap.h"
#include "ngs/io/files/atomic_file.h"
#include "support/camera_files.h"
#include "support/cameras.h"
#include "support/temp_dir.h"

namespace ngs::io {
namespace {

std::vector<SparsePoint> some_points() {
  std::vector<SparsePoint> points(3);
  points[0] = {{0.1, -2.5, 1e-3}, {0, 128, 255}, {{0, 1.25, 2.5}, {1, 3.0, 4.0}}};
  points[1].position = {1.0 / 3, 2, 3};
  points[2] = {{-4, 5, 6}, {1, 2, 3}, {{1, 10.5, 0.125}}};
  return points;
}

std::string binary(const std::vector<SparsePoint>& points) {
  std::string bytes;
  const auto put = [&](const auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(std::uint64_t(points.size()));
  for (const SparsePoint& p : points) {
    put(std::uint64_t(7));
    put(p.position.x);
    put(p.position.y);
    put(p.position.z);
    for (const std::uint8_t c : p.rgb) put(c);
    put(0.5);
    put(std::uint64_t(p.track.size()));
    for (std::size_t k = 0; k < p.track.size(); ++k) put(std::uint64_t(1));
  }
  return bytes;
}

void check_same(const std::vector<SparsePoint>& got, const std::vector<SparsePoint>& want) {
  REQUIRE(got.size() == want.size());
  for (std::size_t i = 0; i < got.size(); ++i) {
    CHECK(got[i].position.x == want[i].position.x);
    CHECK(got[i].position.y == want[i].position.y);
    CHECK(got[i].position.z == want[i].position.z);
    CHECK(std::memcmp(got[i].rgb, want[i].rgb, 3) == 0);
  }
}

}  // namespace

TEST_CASE("a written COLMAP text model is read back bit for bit") {
  const test::TempDir dir;
  test::Random random(3);
  std::vector<Camera> cameras{test::camera_around(random, 3), test::camera_around(random, 4),
                              test::camera_around(random, 5, 60, 50)};
  cameras[0].name = "a b.png";
  cameras[1].name = "c.png";
  cameras[2].name = "d.png";
  write_colmap_text(dir.path() + "/sparse/0", cameras, some_points());
  check_same(read_points(dir.path() + "/sparse/0/points3D.txt"), some_points());
  const Capture capture = read_colmap(dir.path() + "/sparse/0");
  REQUIRE(capture.views.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    const Camera& got = capture.views[i].camera;
    CHECK(got.name == cameras[i].name);
    CHECK(got.width_px == cameras[i].width_px);
    CHECK(got.fx == cameras[i].fx);
    CHECK(got.cy == cameras[i].cy);
    CHECK(got.translation.z == cameras[i].translation.z);
    for (int k = 0; k < 9; ++k) CHECK(got.rotation.m[k] == doctest::Approx(cameras[i].rotation.m[k]).epsilon(1e-14));
  }
}

TEST_CASE("read_points detects binary, text and PLY from the content") {
  const test::TempDir dir;
  const std::string path = dir.path() + "/points";
  write_file(path, binary(some_points()));
  check_same(read_points(path), some_points());
  write_file(path, "\xEF\xBB\xBF# comment\n\n1 1 2 3 4 5 6 0.1 1 2\r\n");
  check_same(read_points(path), {SparsePoint{{1, 2, 3}, {4, 5, 6}, {}}});
  write_file(path,
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty double y\nproperty float z\n"
             "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n1 2 3 4 5 6\n");
  check_same(read_points(path), {SparsePoint{{1, 2, 3}, {4, 5, 6}, {}}});
  write_file(path, "");
  CHECK(read_points(path).empty());
  write_file(path, binary({}));
  CHECK(read_points(path).empty());
}

TEST_CASE("read_points rejects truncated files, too large counts and non-numeric text") {
  const test::TempDir dir;
  const std::string path = dir.path() + "/points", whole = binary(some_points());
  for (std::size_t length = 8; length < whole.size(); ++length) {
    write_file(path, whole.substr(0, length));
    CHECK_THROWS_AS(read_points(path), Error);
  }
  std::string absurd = whole;
  absurd[5] = 1;  // 2^40 points
  std::vector<SparsePoint> infinite = some_points();
  infinite[1].position.y = std::numeric_limits<double>::infinity();
  for (const std::string& bad :
       {absurd, binary(infinite), std::string("1 1 2 x 4 5 6 0.1\n"), std::string("1 1 2 3 4 5 6\n"),
        std::string("1 1 2 3 4 5 256 0.1\n"), std::string("1 nan 2 3 4 5 6 0.1\n"),
        std::string("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n")}) {
    write_file(path, bad);
    CHECK_THROWS_AS(read_points(path), Error);
  }
}

TEST_CASE("the text model is read if the binary one is of an earlier run: empty, or with fewer photos") {
  const test::TempDir dir;
  const auto write = [&](const test::ColmapFiles& files, const std::string& extension) {
    dir.write("cameras" + extension, files.cameras);
    dir.write("images" + extension, files.images);
  };
  write(test::colmap_text(test::random_cameras(3, false)), ".txt");
  write(test::colmap_binary(test::random_cameras(2, false)), ".bin");
  const auto count = [](std::size_t least) {
    return [=](const Capture& capture) { return capture.views.size() >= least ? capture.views.size() : 0; };
  };
  CHECK(read_colmap(dir.path(), Distortion::kRefused, count(4)).format == "COLMAP binary");
  CHECK(read_colmap(dir.path(), Distortion::kRefused, count(3)).format == "COLMAP text");
  write(test::colmap_binary({}), ".bin");
  const Capture text = read_colmap(dir.path());
  CHECK(text.format == "COLMAP text");
  REQUIRE(text.notes.size() == 1);
  CHECK(text.notes[0].find("the text one is used (" + dir.path() + "/images.bin: no cameras") != std::string::npos);
  write({"x", "x"}, ".txt");
  CHECK_THROWS_AS(read_colmap(dir.path()), Error);
}

}  // namespace ngs::io
