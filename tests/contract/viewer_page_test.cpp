// The page of ngs-report --viewer: safe, complete, and the same image as ngs-render.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "ngs/io/image/image_file.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "support/process.h"
#include "support/skip.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;

test::ProcessResult run_in(const std::string& folder, std::vector<std::string> argv) {
  if (argv[0].starts_with("ngs-")) argv[0] = std::string(NGS_TOOL_DIR "/") + argv[0];
  return test::run_process({.argv = argv, .folder = folder});
}

void make(const std::string& folder, std::vector<std::string> argv) {
  test::succeeded(run_in(folder, std::move(argv)));
}

/// A capture called `name` with its labelled model split into object and background.
std::string made_run(const test::TempDir& dir, const std::string& name) {
  std::string out = dir.path() + "/" + name;
  fs::create_directories(out);
  test::write_tiny_scene(out);
  make(out, {"ngs-variance", "scene.json", "-o", "boundary.ply", "-q"});
  make(out, {"ngs-joint", "scene.json", "boundary.ply", "--method", "flash", "-o", "labelled.ply", "-q"});
  make(out, {"ngs-extract", "labelled.ply", "--object-ply", "object.ply", "--background-ply", "background.ply", "-q"});
  return out;
}

TEST_CASE("the viewer is one file, escapes names and loads no other file") {
  const test::TempDir dir;
  const std::string out = made_run(dir, "a <script>alert(1)</script> & ' b");
  make(out, {"ngs-report", ".", "-o", "report.html", "--viewer", "sub #1.html", "-q"});
  const std::string viewer = test::read_bytes(out + "/sub #1.html"), page = test::read_bytes(out + "/report.html");
  for (const char* outside : {"http:", "https:", "src=", "<link", "url(", "@import", "import(", "fetch("}) {
    CAPTURE(outside);
    CHECK(viewer.find(outside) == viewer.npos);
  }
  CHECK(viewer.find("default-src 'none'") != viewer.npos);
  CHECK(viewer.find("<script>alert") == viewer.npos);
  CHECK(viewer.find("script&gt;") != viewer.npos);
  CHECK(page.find("<script") == page.npos);
  CHECK(page.find("href=\"./sub%20%231.html\"") != page.npos);
  make(out, {"ngs-report", ".", "-o", "again.html", "--viewer", "again-3d.html", "-q", "-j", "1"});
  CHECK(test::read_bytes(out + "/again-3d.html") == viewer);

  SUBCASE("it has at most the given number of Gaussians, and shows how many are omitted") {
    make(out, {"ngs-report", ".", "-o", "few.html", "--viewer", "few-3d.html", "--viewer-gaussians", "3", "-q"});
    const std::string few = test::read_bytes(out + "/few-3d.html");
    const std::size_t from = few.find("id=splats>") + 10;
    CHECK(few.find("</script>", from) - from == 128);  // 96 bytes
    CHECK(few.find("3 Gaussians, ") != few.npos);
    CHECK(viewer.find("left out") == viewer.npos);
  }
  SUBCASE("it is written by default, linked first, and never over another file") {
    make(out, {"ngs-report", ".", "-o", "again/report.html", "-q"});
    CHECK(test::read_bytes(out + "/again/object.html") == viewer);
    const std::string linked = test::read_bytes(out + "/again/report.html");
    const std::size_t link = linked.find("href=\"./object.html\"");
    CHECK(link < linked.find("<figure"));
    make(out, {"ngs-report", ".", "-o", "other.html", "-q"});
    CHECK(fs::exists(out + "/other-object.html"));
    make(out, {"ngs-report", ".", "-o", "none.html", "--viewer-gaussians", "0", "-q"});
    CHECK(!fs::exists(out + "/none-object.html"));
    dir.write("mine/object.html", "mine");
    test::refused(run_in(out, {"ngs-report", ".", "-o", dir.path() + "/mine/report.html", "-q"}), 2, "exists already");
    CHECK(test::read_bytes(dir.path() + "/mine/object.html") == "mine");
    CHECK(!fs::exists(dir.path() + "/mine/report.html"));
  }
  SUBCASE("a run without an object is rejected with the command that writes one") {
    fs::remove(out + "/object.ply");
    test::refused(run_in(out, {"ngs-report", ".", "-o", "r.html", "--viewer", "v.html", "-q"}), 3,
                  "expected the object for --viewer");
    CHECK(!fs::exists(out + "/v.html"));
  }
}

TEST_CASE("the sheet of ngs-scene check shows every given mask, and marks empty and missing ones") {
  const test::TempDir dir;
  const std::string out = dir.path() + "/a <b> capture";
  fs::create_directories(out);
  test::write_tiny_scene(out);
  const std::size_t masks = test::occurrences(test::read_bytes(out + "/scene.json"), "\"mask\":");
  REQUIRE(masks >= 2);
  const io::RawMask size = io::read_mask_raw(out + "/masks/v1.png", io::Palette::kMask);
  io::write_png(out + "/masks/v1.png", ImageU8(size.width_px, size.height_px, 1));
  make(out, {"ngs-scene", "check", "scene.json", "--sheet", "masks.html", "-q"});
  const std::string page = test::read_bytes(out + "/masks.html");
  CHECK(test::occurrences(page, "<figure>") == masks);
  CHECK(test::occurrences(page, "the mask is empty") == 1);
  CHECK(test::occurrences(page, "<g class=given><path class=casing d=\"M") == masks - 1);
  CHECK(page.find("<h1>a &lt;b&gt; capture</h1>") != page.npos);
  CHECK(page.find("<script") == page.npos);
  CHECK(test::occurrences(page, "src=") == test::occurrences(page, "src=\"data:image/jpeg;base64,"));
}

/// The pixels that differ from the background, the colour of the corner.
std::vector<bool> drawn(const ImageF& image) {
  std::vector<bool> is_drawn;
  for (std::size_t p = 0; p < std::size_t(image.pixels()); ++p) {
    float apart = 0;
    for (std::size_t c = 0; c < 3; ++c) apart = std::max(apart, std::abs(image.data[3 * p + c] - image.data[c]));
    is_drawn.push_back(apart > 0.25f);
  }
  return is_drawn;
}

/// The parameters of the 3D page.
nlohmann::json parameters_of(const std::string& page) {
  const std::size_t begin = page.find("id=parameters>") + 14;
  return nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

/// scene.json with one view: the first camera of the 3D page.
void write_scene_of_viewer(const std::string& out, const nlohmann::json& camera) {
  nlohmann::json scene = nlohmann::json::parse(test::read_bytes(out + "/scene.json"));
  nlohmann::json view = scene["views"][0];
  view["rotation"] = view["translation"] = nlohmann::json::array();
  for (const char* axis : {"right", "down", "forward"}) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      view["rotation"].push_back(camera[axis][k]);
      sum -= camera[axis][k].get<double>() * camera["eye"][k].get<double>();
    }
    view["translation"].push_back(sum);
  }
  view["fx"] = view["fy"] = camera["fx"];
  view["cx"] = 0.5 * view["width"].get<double>();
  view["cy"] = 0.5 * view["height"].get<double>();
  scene["views"] = {view};
  std::ofstream(out + "/first.json") << scene;
}

TEST_CASE("the viewer's first camera looks at the middle of the object, upright, and shows all of it") {
  const test::TempDir dir;
  const std::string out = made_run(dir, "run");
  make(out, {"ngs-report", ".", "-o", "report.html", "-q"});
  const nlohmann::json camera = parameters_of(test::read_bytes(out + "/object.html"));
  const auto vector = [&](const char* name) {
    return Vec3<double>{camera[name][0].get<double>(), camera[name][1].get<double>(), camera[name][2].get<double>()};
  };
  const Vec3<double> eye = vector("eye"), line = vector("centre") - eye;
  const double distance = std::sqrt(dot(line, line));
  CHECK(dot(line, vector("forward")) == doctest::Approx(distance));
  CHECK(std::abs(dot(vector("right"), vector("up"))) < 1e-9);
  CHECK(dot(vector("down"), vector("up")) < 0);
  const GaussianCloud object = io::read_gaussian_ply(out + "/object.ply").cloud;
  const double fx = camera["fx"], half = 0.5 * std::min(camera["width_px"].get<int>(), camera["height_px"].get<int>());
  for (std::size_t i = 0; i < std::size_t(object.size()); ++i) {
    const float* p = &object.position[3 * i];
    const Vec3<double> at = Vec3<double>{double(p[0]), double(p[1]), double(p[2])} - eye;
    const double z = dot(at, vector("forward"));
    REQUIRE(z > 0);
    CHECK(fx * std::hypot(dot(at, vector("right")), dot(at, vector("down"))) / z < half);
  }
}

/// The picture of object.html with `layers` in its address, and a picture of object.ply by ngs-render there.
struct Seen {
  std::vector<bool> page, render;
  double overlap() const {
    double both = 0, either = 0;
    for (std::size_t p = 0; p < page.size(); ++p) {
      both += page[p] && render[p];
      either += page[p] || render[p];
    }
    REQUIRE(either > 1000);
    return both / either;
  }
};

Seen seen(const test::TempDir& dir, const std::string& out, const std::string& layers) {
  // The window is twelve times as wide and high as the photo, because browsers have a minimum window size.
  dir.write("run/frame.html",
            "<body style=\"margin:0\"><iframe style=\"border:0\" width=576 height=432 src=\"object.html#" + layers +
                "\"></iframe>");
  const test::ProcessResult result =
      run_in(out, {"chromium", "--headless", "--no-sandbox", "--enable-unsafe-swiftshader", "--hide-scrollbars",
                   "--user-data-dir=" + dir.path() + "/profile", "--virtual-time-budget=3000", "--window-size=576,432",
                   "--screenshot=" + out + "/seen.png", "file://" + out + "/frame.html"});
  INFO(result.err);
  REQUIRE(fs::exists(out + "/seen.png"));
  const ImageF page = io::read_image_rgb(out + "/seen.png");
  REQUIRE(page.width_px == 576);
  write_scene_of_viewer(out, parameters_of(test::read_bytes(out + "/object.html")));
  make(out, {"ngs-render", "first.json", "object.ply", "--views", "all", "--layers", "color", "--scale", "12",
             "--background", "0.93,0.92,0.9", "-o", "colour", "-w", "-q"});
  const ImageF rendered = io::read_image_rgb(fs::directory_iterator(out + "/colour")->path().string());
  REQUIRE(page.pixels() == rendered.pixels());
  return {drawn(page), drawn(rendered)};
}

TEST_CASE(
    "the viewer's first image equals the render of ngs-render at the same camera; its mesh covers the same pixels") {
  if (!fs::exists("/usr/bin/chromium")) return test::skip("no /usr/bin/chromium");
  const test::TempDir dir;
  const std::string out = made_run(dir, "run");
  make(out,
       {"ngs-render", "scene.json", "labelled.ply", "--views", "all", "--layers", "mask", "-o", "masks", "-w", "-q"});
  make(out, {"ngs-mesh", "object.ply", "-o", "mesh.glb", "--resolution", "32", "--collider", "hull", "--up", "x",
             "--unit", "0.1", "-q"});
  make(out, {"ngs-report", ".", "-o", "report.html", "--viewer", "object.html", "-q"});
  CHECK(seen(dir, out, "bare").overlap() > 0.95);
  const Seen mesh = seen(dir, out, "bare,mesh");
  CHECK(mesh.overlap() > 0.8);
  const Seen collider = seen(dir, out, "bare,collider");
  CHECK(std::ranges::count(collider.page, true) > std::ranges::count(mesh.page, true));  // the hull's edges
}

TEST_CASE(
    "the viewer offers the mesh of its run, and its colliders if there are any; other files called so are left out") {
  const test::TempDir dir;
  const std::string out = made_run(dir, "run");
  const auto page = [&] {
    make(out, {"ngs-report", ".", "-o", "report.html", "-w", "-q"});
    return test::read_bytes(out + "/object.html");
  };
  CHECK(page().find("id=layer") == std::string::npos);
  make(out, {"ngs-mesh", "object.ply", "-o", "mesh.glb", "--resolution", "32", "-q"});
  const std::string mesh = page();
  CHECK(mesh.find("<option value=mesh>") != mesh.npos);
  CHECK(mesh.find("<option value=collider>") == mesh.npos);
  make(out, {"ngs-mesh", "object.ply", "-o", "mesh.glb", "--resolution", "32", "--collider", "box", "-w", "-q"});
  CHECK(page().find("<option value=collider>") != std::string::npos);
  dir.write("run/mesh.glb", "glTF of another program");
  CHECK(page().find("id=layer") == std::string::npos);
}

}  // namespace
}  // namespace ngs
