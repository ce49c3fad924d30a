// The background colour of a model: import estimates it, later tools read it from scene.json.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>

#include "ngs/core/rng.h"
#include "ngs/io/image/image_file.h"
#include "ngs/math/vec.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/problem/cloud_rows.h"
#include "support/process.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"
#include "support/tool_fixture.h"

// The tiny scene's ball without the wall: an object without background, as in product shots and NeRF's synthetic
// scenes.
namespace ngs::test {
namespace {

constexpr int kSize = 2;  // factor over the tiny photos, so that the outline has enough pixels

/// The rows of the ball, and the first `more` rows of the wall.
GaussianCloud ball_of(const TinyScene& tiny, std::size_t more) {
  std::vector<std::int64_t> rows(std::size_t(std::ranges::count(tiny.is_object, 1.f)) + more);
  std::iota(rows.begin(), rows.end(), 0);
  return gather_rows({}, tiny.cloud, rows);
}

void write_text(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

std::uint8_t level(float value) { return std::uint8_t(std::lround(255 * std::clamp(value, 0.f, 1.f))); }

/// Writes into `folder`: model.ply (the ball with slightly wrong colours), text/*.txt (COLMAP), masks/vI.png, and
/// images/vI.png (the ball over `behind`, RGB).
void write_ball_scene(const std::string& folder, Vec3<float> behind) {
  const TinyScene tiny = tiny_scene();
  write_tiny_scene(folder);
  const GaussianCloud ball = ball_of(tiny, 0);
  for (const Camera& small : tiny.cameras) {
    const Camera camera = resized(small, kSize * small.width_px, kSize * small.height_px);
    const RenderedView view = render({}, ball, camera, {}, {.label = {}, .background = behind});
    ImageU8 photo(camera.width_px, camera.height_px, 3), mask(camera.width_px, camera.height_px, 1);
    for (std::size_t i = 0; i < photo.data.size(); ++i) photo.data[i] = level(view.colour.data[i]);
    for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = view.alpha.data[i] > 0.5f ? 255 : 0;
    io::write_png(folder + "/images/" + camera.name, photo);
    io::write_png(folder + "/masks/" + camera.name, mask);
  }
  GaussianCloud model = ball;
  for (std::size_t i = 0; i < model.log_scale.size(); ++i)
    model.log_scale[i] += float(0.8 * (rng_uniform(9, RngStream::kTest, i) - 0.3));
  write_text(folder + "/model.ply", strict_ply_bytes(model));
  std::filesystem::remove(folder + "/scene.json");
}

/// The same with transparent photos whose hidden colours (alpha 0) are those of a room, and a model with blobs that are
/// visible over any `behind` except one of their colour.
void write_cut_out_ball_scene(const std::string& folder, Vec3<float> behind) {
  const TinyScene tiny = tiny_scene();
  write_tiny_scene(folder);
  const GaussianCloud ball = ball_of(tiny, 0);
  for (const Camera& camera : tiny.cameras) {
    const RenderedView alone = render({}, ball, camera, {}, {}), room = render({}, tiny.cloud, camera, {}, {});
    ImageU8 photo(camera.width_px, camera.height_px, 4);
    for (std::size_t p = 0; p < alone.alpha.data.size(); ++p) {
      const bool object = alone.alpha.data[p] > 0.5f;
      for (std::size_t c = 0; c < 3; ++c) photo.data[4 * p + c] = level(room.colour.data[3 * p + c]);
      photo.data[4 * p + 3] = object ? 255 : 0;
    }
    io::write_png(folder + "/images/" + camera.name, photo);
  }
  GaussianCloud model = ball_of(tiny, 40);  // the blobs take the place of the wall's first rows
  const float colour[3] = {behind.x, behind.y, behind.z};
  for (std::size_t i = std::size_t(ball.size()); i < std::size_t(model.size()); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      model.sh_dc[3 * i + c] = (colour[c] - 0.5f) / 0.28209479f;
      std::fill_n(model.sh_rest.begin() + std::ptrdiff_t(9 * i), 9, 0.f);
    }
  write_text(folder + "/model.ply", strict_ply_bytes(model));
  std::filesystem::remove(folder + "/scene.json");
}

}  // namespace
}  // namespace ngs::test

namespace ngs {
namespace {

using nlohmann::json;

json read(const std::string& path) { return json::parse(std::ifstream(path)); }

test::ProcessResult run(const test::Words& words) { return test::succeeded(test::run_tool(words)); }

test::ProcessResult import(const std::string& dir, const test::Words& further = {}) {
  const test::Words words = test::split("ngs-scene import " + dir + "/text --ply " + dir + "/model.ply --images " +
                                        dir + "/images --masks " + dir + "/masks --hold-out every:3:1 -w");
  return run(test::joined(test::joined(words, {"-o", dir + "/scene.json"}), further));
}

/// Mean boundary IoU of all views, labelled by ngs-joint with the options `further`.
double boundary_iou(const std::string& dir, const test::Words& further) {
  run(test::joined({"ngs-joint", dir + "/scene.json", dir + "/boundary.ply", "-o", dir + "/l.ply", "-w"}, further));
  run({"ngs-render", dir + "/scene.json", dir + "/l.ply", "--layers", "mask", "-o", dir + "/rendered", "-w"});
  run({"ngs-eval", dir + "/rendered", dir + "/masks", "-o", dir + "/metrics.json", "-w"});
  return read(dir + "/metrics.json").at("mean").at("biou").get<double>();
}

double colour_db(const std::string& dir, const test::Words& further) {
  const test::Words render{"ngs-render", dir + "/scene.json", dir + "/model.ply", "--layers", "color", "-w"};
  run(test::joined(test::joined(render, {"-o", dir + "/colour"}), further));
  run({"ngs-eval", dir + "/colour", dir + "/images", "--image-metrics", "-o", dir + "/photos.json", "-w"});
  return read(dir + "/photos.json").at("mean").at("psnr_db").get<double>();
}

}  // namespace

TEST_CASE(
    "ngs-joint labels an object on white no worse than its masks alone, because import finds the white background") {
  const test::TempDir dir;
  test::write_ball_scene(dir.path(), {1, 1, 1});
  import(dir.path());
  CHECK(read(dir.path() + "/scene.json").at("background") == json({1.0, 1.0, 1.0}));
  run({"ngs-variance", dir.path() + "/scene.json", "-o", dir.path() + "/boundary.ply"});
  const double flash = boundary_iou(dir.path(), {"--method", "flash"}), found = boundary_iou(dir.path(), {}),
               black = boundary_iou(dir.path(), {"--background", "black"});
  MESSAGE("flash ", flash, " found ", found, " black ", black);
  CHECK(found >= flash - 0.002);
  CHECK(black < found - 0.02);
  const double over_found = colour_db(dir.path(), {}), over_black = colour_db(dir.path(), {"--background", "0,0,0"});
  CHECK(over_found > over_black + 10);
}

TEST_CASE("a --background that differs from the scene's is used, with a warning") {
  const test::TempDir dir;
  test::write_ball_scene(dir.path(), {0.6f, 0, 0.4f});
  import(dir.path());
  const json found = read(dir.path() + "/scene.json").at("background");
  CHECK(std::abs(found[0].get<double>() - 0.6) < 0.01);
  CHECK(std::abs(found[1].get<double>()) < 0.01);
  CHECK(std::abs(found[2].get<double>() - 0.4) < 0.01);
  const test::ProcessResult render = run({"ngs-render", dir.path() + "/scene.json", dir.path() + "/model.ply",
                                          "--layers", "color", "--background", "white", "-o", dir.path() + "/r"});
  CHECK(render.err.find("is not the scene's") != std::string::npos);
  import(dir.path(), {"--background", "white"});
  CHECK(read(dir.path() + "/scene.json").at("background") == json({1.0, 1.0, 1.0}));
}

TEST_CASE("transparent photos are composited over the background that the model was fitted with") {
  for (const double level : {0.0, 1.0}) {
    CAPTURE(level);
    const test::TempDir dir;
    test::write_cut_out_ball_scene(dir.path(), {float(level), float(level), float(level)});
    const test::ProcessResult result = import(dir.path());
    CHECK(result.err.find("photos are transparent") != std::string::npos);
    CHECK(read(dir.path() + "/scene.json").at("background") == json({level, level, level}));
  }
}

}  // namespace ngs
