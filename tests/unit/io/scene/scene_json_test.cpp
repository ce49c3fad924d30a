#include "ngs/io/scene/scene_json.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/io/files/json_file.h"
#include "support/error_code.h"
#include "support/temp_dir.h"

namespace ngs::io {
namespace {

using test::TempDir;

Scene two_views(const TempDir& dir) {
  Scene scene;
  scene.model_path = dir.path() + "/model.ply";
  scene.objects = {{"cup", 3}, {"spoon", 9}};
  scene.mask_mode = MaskMode::kLabel;
  scene.missing_mask = MissingMask::kError;
  scene.void_id = 255;
  scene.mask_threshold = 99.5;
  scene.image_scale = 0.3;
  scene.background = Vec3<double>{1.0 / 3, 0, 1};
  scene.antialiased = false;
  scene.compat = Compat::kGsplat;
  scene.world_unit = 0x1p-9;
  scene.renders = RenderedPhotos{0.9625};
  for (const char* name : {"a b.png", "c.jpg"}) {
    const Camera camera{name,           640, 480, 500.1, 1.0 / 3.0, 320.5, 1e-17, {{0, -1, 0, 1, 0, 0, 0, 0, 1}},
                        {0.1, -2e30, 3}};
    scene.views.push_back({camera, dir.path() + "/images/" + name, dir.path() + "/../masks/" + name});
  }
  scene.views[1].split = Split::kHeldOut;
  scene.views[1].image_path.clear();
  return scene;
}

nlohmann::json written(const TempDir& dir) {
  write_scene_json(dir.file("scene.json"), two_views(dir));
  return read_json_file(dir.file("scene.json"));
}

void refused(const nlohmann::json& json, const char* message) {
  CAPTURE(json.dump());
  CHECK_THROWS_WITH_AS(parse_scene_json(json, "", "scene.json"), doctest::Contains(message), Error);
}

}  // namespace

TEST_CASE("the folder of true masks is stored relative to the file and is not part of the scene") {
  const TempDir dir;
  write_scene_json(dir.file("scene.json"), two_views(dir), StoredPaths::kRelative, dir.path() + "/masks_gt");
  CHECK(read_json_file(dir.file("scene.json"))["truth"] == "masks_gt");
  CHECK(truth_of_scene_json(dir.file("scene.json")) == dir.path() + "/masks_gt");
  CHECK(read_scene_json(dir.file("scene.json")).views.size() == 2);
  write_scene_json(dir.file("none.json"), two_views(dir));
  CHECK(truth_of_scene_json(dir.file("none.json")).empty());
}

TEST_CASE("a scene is read back with bit-identical cameras and settings") {
  const TempDir dir;
  const Scene scene = two_views(dir);
  write_scene_json(dir.file("scene.json"), scene);
  const Scene back = read_scene_json(dir.file("scene.json"));
  REQUIRE(back.views.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const Camera &a = scene.views[i].camera, &b = back.views[i].camera;
    CHECK(a.name == b.name);
    CHECK((a.width_px == b.width_px && a.height_px == b.height_px));
    CHECK((a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy));
    CHECK(std::equal(a.rotation.m, a.rotation.m + 9, b.rotation.m));
    CHECK((a.translation.x == b.translation.x && a.translation.y == b.translation.y &&
           a.translation.z == b.translation.z));
    CHECK(scene.views[i].split == back.views[i].split);
  }
  CHECK(back.mask_mode == MaskMode::kLabel);
  CHECK(back.missing_mask == MissingMask::kError);
  CHECK(back.void_id == 255);
  CHECK(back.mask_threshold == 99.5);
  CHECK(back.image_scale == 0.3);
  CHECK(back.antialiased == false);
  CHECK(back.compat == Compat::kGsplat);
  CHECK(back.world_unit == 0x1p-9);
  REQUIRE(back.background.has_value());
  CHECK((back.background->x == 1.0 / 3 && back.background->y == 0 && back.background->z == 1));
  REQUIRE(back.renders.has_value());
  CHECK(back.renders->coverage == 0.9625);
  CHECK(back.objects[1].name == "spoon");
  CHECK(back.objects[1].id == 9);
  CHECK(back.views[1].image_path.empty());
}

TEST_CASE("unknown background and antialiasing are not written to scene.json") {
  const TempDir dir;
  nlohmann::json json = written(dir);
  json.erase("background");
  json.erase("antialiased");
  json.erase("compat");
  json.erase("renders");
  json.erase("world_unit");
  const Scene back = parse_scene_json(json, "", "scene.json");
  CHECK_FALSE(back.background.has_value());
  CHECK_FALSE(back.antialiased.has_value());
  CHECK_FALSE(back.renders.has_value());  // photos
  CHECK(back.compat == Compat::kInria);
  CHECK(back.world_unit == 1);
  CHECK(background_of(back).x == 0.f);
  write_scene_json(dir.file("again.json"), back);
  for (const char* key : {"background", "antialiased", "renders", "world_unit"})
    CHECK_FALSE(read_json_file(dir.file("again.json")).contains(key));
}

TEST_CASE("paths are stored relative to the json file and found from any working directory") {
  const TempDir dir;
  const nlohmann::json json = written(dir);
  CHECK(json["model"] == "model.ply");
  CHECK(json["views"][0]["image"] == "images/a b.png");
  CHECK(json["views"][0]["mask"] == "../masks/a b.png");
  const Scene back = read_scene_json(dir.file("scene.json"));
  CHECK(back.model_path == dir.path() + "/model.ply");
  CHECK(std::filesystem::path(back.views[0].mask_path) ==
        std::filesystem::path(dir.path()).parent_path() / "masks/a b.png");
}

TEST_CASE("a link to a scene is rejected with the file's real path if its files do not exist from the link's folder") {
  const TempDir dir;
  written(dir);
  std::filesystem::create_directories(dir.path() + "/link");
  std::filesystem::create_symlink(dir.path() + "/scene.json", dir.path() + "/link/scene.json");
  CHECK_NOTHROW(read_scene_json(dir.path() + "/link/scene.json"));  // the paths do not exist from the real file either
  dir.write("model.ply", "x");
  const Error e = test::thrown_by([&] { read_scene_json(dir.path() + "/link/scene.json"); });
  const std::string expected = "/link/scene.json: is a link, and " + dir.path() + "/link/model.ply does not exist";
  CHECK(std::string(e.what()).find(expected) == dir.path().size());
  CHECK(e.remedy() == "name the file itself: " + std::filesystem::canonical(dir.path() + "/scene.json").string());
  dir.write("link/model.ply", "x");
  dir.write("link/images/a b.png", "x");
  CHECK_NOTHROW(read_scene_json(dir.path() + "/link/scene.json"));
}

TEST_CASE("a view name with control characters is rejected") {
  const TempDir dir;
  for (const char* name : {"a\nb.png", "a\tb.png", "\x7f.png"}) {
    nlohmann::json json = written(dir);
    json["views"][0]["name"] = name;
    refused(json, "contains a line end or another control character");
  }
  nlohmann::json json = written(dir);
  json["views"][0]["name"] = "a\nb.png";
  refused(json, "scene.json: view name 'a?b.png'");
}

TEST_CASE("absolute paths in a scene are kept") {
  const TempDir dir;
  nlohmann::json json = written(dir);
  json["model"] = "/data/model.ply";
  CHECK(parse_scene_json(json, "/somewhere", "scene.json").model_path == "/data/model.ply");
}

TEST_CASE("views are sorted by name whatever their order in the file") {
  const TempDir dir;
  nlohmann::json json = written(dir);
  std::swap(json["views"][0], json["views"][1]);
  CHECK(parse_scene_json(json, "", "scene.json").views[0].camera.name == "a b.png");
}

TEST_CASE("every invalid field of a scene is rejected with its location") {
  const TempDir dir;
  const nlohmann::json good = written(dir);
  const auto with = [&](const char* pointer, const nlohmann::json& value) {
    nlohmann::json broken = good;
    broken[nlohmann::json::json_pointer(pointer)] = value;
    return broken;
  };
  refused(with("/ngs_scene", 2), "scene version 2, expected 1");
  refused(with("/extra", 1), "unknown key \"extra\"");
  refused(with("/views/1/fov", 1), "views[1]: unknown key \"fov\"");
  refused(with("/masks/mode", "colour"), "masks.mode: \"colour\", expected one of binary label soft bands");
  refused(with("/views/0/width", 0), "views[0].width: 0, expected an integer");
  refused(with("/views/0/width", 1e9), "views[0].width");
  refused(with("/views/0/width", 1.5), "views[0].width: 1.5");
  refused(with("/views/0/fx", "500"), "views[0].fx: \"500\", expected a finite number");
  refused(with("/views/0/fx", -1), "focal length");
  refused(with("/views/0/rotation", {1, 0, 0}), "views[0].rotation");
  refused(with("/views/0/rotation", {1, 0, 0, 0, 1, 0, 0, 0, -1}), "not a rotation matrix");
  refused(with("/views/0/rotation", {2, 0, 0, 0, 2, 0, 0, 0, 2}), "not a rotation matrix");
  refused(with("/views/1/name", "a b.png"), "view a b.png twice");
  refused(with("/views", nlohmann::json::array()), "no views");
  refused(with("/objects", nlohmann::json::array()), "no objects");
  refused(with("/objects/0/name", "../x"), "object name \"../x\"");
  refused(with("/objects/1/id", 3), "object id 3 twice");
  refused(with("/masks/mode", "binary"), "2 objects in one mask per view");
  refused(with("/masks/invert", true), "inverted label maps");
  refused(with("/masks/void_id", 9), "id 9 is both void and object \"spoon\"");
  refused(with("/masks/void_id", 65536), "masks.void_id: 65536");
  nlohmann::json bands = with("/masks/mode", "bands");
  bands["objects"].erase(1);
  refused(bands, "void id 255, expected 0..65535 with label maps, none with other masks");
  refused(with("/image_scale", 0), "image_scale");
  refused(with("/background", {0, 0.5, 1.5}), "background 1.5");
  refused(with("/background", {0, 0}), "background");
  refused(with("/renders", true), "renders");
  refused(with("/renders/coverage", 1.5), "renders.coverage: 1.5, expected a share in [0, 1]");
  refused(with("/renders/note", "photos"), "renders.note: \"photos\", expected \"renders of the model, no photos\"");
  refused(with("/renders/of", "a"), "of");
  refused(with("/antialiased", 1), "antialiased");
  refused(with("/compat", "nerfstudio"), "one of inria gsplat");
  refused(with("/background", "white"), "background");
  refused(with("/model", std::string("a\0b", 3)), "without NUL characters");
  refused(nlohmann::json::array(), "array, expected an object");
}

TEST_CASE("every prefix of a scene.json is refused as bad input") {
  const TempDir dir;
  write_scene_json(dir.file("scene.json"), two_views(dir));
  const std::string text = test::read_bytes(dir.file("scene.json"));
  for (std::size_t n = 0; n + 2 < text.size(); ++n) {  // the last newline is not needed
    CAPTURE(n);
    CHECK_THROWS_AS(parse_scene_json(parse_json(text.substr(0, n), "s"), "", "s"), Error);
  }
}

TEST_CASE("duplicate keys and numbers beyond double are refused") {
  CHECK_THROWS_WITH_AS(parse_json(R"({"a": 1, "b": {"a": 2}, "a": 3})", "s"), doctest::Contains("key 'a' occurs twice"),
                       Error);
  CHECK_NOTHROW(parse_json(R"({"a": 1, "b": {"a": 2}})", "s"));
  CHECK_THROWS_AS(parse_json(R"({"a": 1e999})", "s"), Error);
  CHECK_THROWS_AS(parse_json(R"({"a": NaN})", "s"), Error);
}

}  // namespace ngs::io
