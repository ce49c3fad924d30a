// Camera readers against files written by the test.
#include <doctest/doctest.h>

#include <algorithm>

#include "ngs/core/error.h"
#include "ngs/io/capture/capture_source.h"
#include "ngs/io/capture/colmap.h"
#include "ngs/io/capture/transforms_json.h"
#include "support/camera_files.h"
#include "support/error_code.h"
#include "support/temp_dir.h"

namespace ngs::io {
namespace {

using test::PosedCamera, test::no_images;
constexpr double kTolerance = 1e-12;

Bytes bytes_of(const std::string& text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

std::vector<std::string> names_of(const std::vector<PosedCamera>& views) {
  std::vector<std::string> names;
  for (const PosedCamera& view : views) names.push_back(view.camera.name);
  return names;
}

double difference(const Camera& a, const Camera& b) {
  double worst = std::max({std::abs(a.fx - b.fx), std::abs(a.fy - b.fy), std::abs(a.cx - b.cx), std::abs(a.cy - b.cy)});
  for (int i = 0; i < 9; ++i) worst = std::max(worst, std::abs(a.rotation.m[i] - b.rotation.m[i]));
  const Vec3<double> t = a.translation - b.translation;
  return std::max({worst, std::abs(t.x), std::abs(t.y), std::abs(t.z)});
}

void check_same(const Capture& capture, const std::vector<PosedCamera>& wanted) {
  CAPTURE(capture.format);
  REQUIRE(capture.views.size() == wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const Camera &got = capture.views[i].camera, &want = wanted[i].camera;
    CHECK(got.name == want.name);
    CHECK((got.width_px == want.width_px && got.height_px == want.height_px));
    CHECK(difference(got, want) < kTolerance);
  }
}

Capture text_capture(const std::string& cameras, const std::string& images) {
  return parse_colmap_text(cameras, images, "sparse");
}

}  // namespace

TEST_CASE("COLMAP binary, COLMAP text and transforms.json give the same cameras") {
  const auto views = test::random_cameras(5, false);
  const test::ColmapFiles binary = test::colmap_binary(views), text = test::colmap_text(views);
  check_same(parse_colmap_binary(bytes_of(binary.cameras), bytes_of(binary.images), "sparse"), views);
  check_same(text_capture(text.cameras, text.images), views);
  check_same(parse_transforms_json(test::transforms_json(views), no_images()), views);
}

TEST_CASE("cameras.json and LLFF give the same cameras where the principal point is the centre") {
  const auto views = test::random_cameras(5, true);
  const Capture inria = parse_cameras_json(test::cameras_json(views), "cameras.json");
  const std::string npy = test::llff_npy(views);
  const Capture llff = llff_capture(parse_npy(bytes_of(npy), "poses_bounds.npy"), names_of(views), "poses_bounds.npy");
  check_same(inria, views);
  check_same(llff, views);
  CHECK(inria.notes.size() == 1);  // the assumed principal point is noted
  nlohmann::json with_centres = test::cameras_json(views);
  for (nlohmann::json& camera : with_centres) {
    camera["cx"] = 1.5;
    camera["cy"] = 2.5;
  }
  const Capture read = parse_cameras_json(with_centres, "cameras.json");
  CHECK((read.views[0].camera.cx == 1.5 && read.views[0].camera.cy == 2.5));
  CHECK(read.notes.empty());
  CHECK(llff.notes.size() == 1);
}

TEST_CASE("every pixel's ray projects back onto that pixel") {
  const auto views = test::random_cameras(3, false);
  const Capture capture = parse_transforms_json(test::transforms_json(views), no_images());
  for (const SceneView& view : capture.views) {
    const Camera& c = view.camera;
    for (const auto& [x, y] : {std::pair{0.5, 0.5}, {639.5, 0.5}, {100.25, 333.0}}) {
      const Vec3<double> ray = transpose(c.rotation) * Vec3<double>{(x - c.cx) / c.fx, (y - c.cy) / c.fy, 1};
      const Vec3<double> p = c.rotation * (c.centre() + 3.7 * ray) + c.translation;
      CHECK(c.fx * p.x / p.z + c.cx == doctest::Approx(x).epsilon(kTolerance));
      CHECK(c.fy * p.y / p.z + c.cy == doctest::Approx(y).epsilon(kTolerance));
    }
  }
}

TEST_CASE("a camera that looks along world z sees x right and y down in every format") {
  PosedCamera p{{"a.png", 640, 480, 500, 500, 320, 240, {{1, 0, 0, 0, 1, 0, 0, 0, 1}}, {0, 0, 0}}, {1, 0, 0, 0}};
  const auto check = [](const Capture& capture) {
    const Camera& c = capture.views.at(0).camera;
    const Vec3<double> p = c.rotation * Vec3<double>{1, 2, 10} + c.translation;
    CHECK(p.z == doctest::Approx(10));
    CHECK(c.fx * p.x / p.z + c.cx == doctest::Approx(370));
    CHECK(c.fy * p.y / p.z + c.cy == doctest::Approx(340));
  };
  nlohmann::json gl = test::transforms_json({p});
  gl["frames"][0]["transform_matrix"] = {{1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 0}, {0, 0, 0, 1}};
  check(parse_transforms_json(gl, no_images()));
  check(parse_cameras_json(test::cameras_json({p}), "c"));
  check(text_capture("1 SIMPLE_PINHOLE 640 480 500 320 240\n", "1 1 0 0 0 0 0 0 1 a.png\n\n"));
}

TEST_CASE("COLMAP text: comments, CRLF, a byte order mark, an empty second line and a missing last line are accepted") {
  const std::string cameras = "\xEF\xBB\xBF# c\r\n\r\n1 SIMPLE_PINHOLE 640 480 500 320 240\r\n";
  const std::string images =
      "\xEF\xBB\xBF# i\r\n1 1 0 0 0 0 0 1 1 b c.png \r\n\r\n# between\r\n2 1 0 0 0 0 0 2 1 a.png";
  const Capture capture = text_capture(cameras, images);
  REQUIRE(capture.views.size() == 2);
  CHECK(capture.views[0].camera.name == "a.png");
  CHECK(capture.views[1].camera.name == "b c.png");
  CHECK(capture.views[1].camera.translation.z == 1);
}

TEST_CASE("COLMAP text without the second lines of images is read, whatever blanks the names have") {
  const std::string camera = "1 SIMPLE_PINHOLE 640 480 500 320 240\n";
  const std::string image = "1 1 0 0 0 0 0 0 1 a.png\n2 1 0 0 0 0 0 1 1 b c d.png\n3 1 0 0 0 0 0 2 1 c 2 of 3\n";
  const Capture capture = text_capture(camera, image);
  REQUIRE(capture.views.size() == 3);
  CHECK(capture.views[1].camera.name == "b c d.png");
  CHECK(capture.views[2].camera.translation.z == 2);
}

TEST_CASE("camera models: zero distortion is accepted, any other is rejected with the command that undistorts") {
  const std::string image = "1 1 0 0 0 0 0 0 1 a.png\n\n";
  const Capture radial = text_capture("1 SIMPLE_RADIAL 640 480 500 320 240 5e-10\n", image);
  CHECK(radial.views[0].camera.fy == 500);
  CHECK_THROWS_WITH_AS(text_capture("1 SIMPLE_RADIAL 640 480 500 320 240 -3e-8\n", image),
                       doctest::Contains("SIMPLE_RADIAL with distortion -3e-08"), Error);
  const Capture opencv = text_capture("1 OPENCV 640 480 500 501 320 240 0 0 0 0\n", image);
  CHECK(opencv.views[0].camera.fy == 501);
  for (const char* camera :
       {"1 SIMPLE_RADIAL 640 480 500 320 240 -0.01\n", "1 OPENCV 640 480 500 501 320 240 0 0 0 1e-9\n",
        "1 OPENCV 640 480 500 501 320 240 nan 0 0 0\n", "1 OPENCV_FISHEYE 640 480 500 501 320 240 0 0 0 0\n"}) {
    CAPTURE(camera);
    const Error e = test::thrown_by([&] { text_capture(camera, image); });
    CHECK(e.code() == ErrorCode::kBadInput);
    CHECK(e.remedy().find("colmap image_undistorter --image_path IMAGES --input_path sparse --output_path") == 0);
  }
}

TEST_CASE("invalid COLMAP text is rejected with its line") {
  const std::string camera = "1 PINHOLE 640 480 500 500 320 240\n";
  const auto refused = [&](const std::string& cameras, const std::string& images, const char* message) {
    CAPTURE(images);
    CHECK_THROWS_WITH_AS(text_capture(cameras, images), doctest::Contains(message), Error);
  };
  refused(camera, "1 0 0 0 0 0 0 0 1 a.png\n\n", "quaternion of length 0.0");
  refused(camera, "1 2 0 0 0 0 0 0 1 a.png\n\n", "quaternion of length 2.0");
  refused(camera, "1 nan 0 0 0 0 0 0 1 a.png\n\n", "quaternion of length");
  refused(camera, "1 1 0 0 0 0 0 inf 1 a.png\n\n", "non-finite");
  refused(camera, "1 1 0 0 0 0 0 0 7 a.png\n\n", "line 1: camera 7, expected one of cameras.txt");
  refused(camera, "1 1 0 0 0 0 0 zero 1 a.png\n\n", "line 1: \"zero\", expected a pose number");
  refused(camera, "1 1 0 0 0 0 0 0 1\n\n", "without a name");
  refused(camera, "1 1 0 0 0 0 0 0 1 a/../b.png\n\n", "leads out of the image folder");
  refused(camera, "1 1 0 0 0 0 0 0 1 ..\n\n", "leads out of the image folder");
  refused(camera, "1 1 0 0 0 0 0 0 1 a.png\n\n2 1 0 0 0 0 0 0 1 a.png\n\n", "image a.png is listed twice");
  refused(camera, "# nothing\n", "no cameras");
  refused("1 PINHOLE 640 480 500 500 320\n", "", "expected a camera parameter");
  refused("1 PINHOLE 640 480 500 500 320 240 9\n", "", "more than the 4 parameters");
  refused("1 PINHOLE 0 480 500 500 320 240\n", "", "size 0x480 px");
  refused("1 PINHOLE 99999999999 480 500 500 320 240\n", "", "size 99999999999x480 px");
  refused(camera + camera, "", "camera 1 twice");
  for (const char* focal : {"0", "nan"})
    refused("1 PINHOLE 640 480 " + std::string(focal) + " 500 320 240\n", "1 1 0 0 0 0 0 0 1 a.png\n\n",
            "focal length");
}

TEST_CASE("quaternions within 1e-3 of unit length are normalised") {
  const Capture capture = text_capture("1 SIMPLE_PINHOLE 9 9 5 4 4\n", "1 0.7075 0.7075 0 0 0 0 0 1 a.png\n\n");
  CHECK(difference(capture.views[0].camera, {"", 9, 9, 5, 5, 4, 4, {{1, 0, 0, 0, 0, -1, 0, 1, 0}}, {0, 0, 0}}) <
        kTolerance);
}

TEST_CASE("every prefix of a COLMAP binary model is refused") {
  const test::ColmapFiles files = test::colmap_binary(test::random_cameras(2, false));
  for (std::size_t n = 0; n < files.cameras.size(); ++n)
    CHECK_THROWS_AS(parse_colmap_binary(bytes_of(files.cameras).first(n), bytes_of(files.images), "s"), Error);
  for (std::size_t n = 0; n < files.images.size(); ++n)
    CHECK_THROWS_AS(parse_colmap_binary(bytes_of(files.cameras), bytes_of(files.images).first(n), "s"), Error);
}

TEST_CASE("huge counts in COLMAP binary are rejected before memory is allocated") {
  const test::ColmapFiles good = test::colmap_binary(test::random_cameras(1, false), 0);
  for (const std::uint64_t count : {std::uint64_t(2), std::uint64_t(1) << 40, ~std::uint64_t(0)}) {
    test::ByteWriter writer;
    writer.put(count);
    test::ColmapFiles files = good;
    files.cameras.replace(0, 8, writer.bytes);
    CHECK_THROWS_AS(parse_colmap_binary(bytes_of(files.cameras), bytes_of(files.images), "s"), Error);
    files = good;
    files.images.replace(0, 8, writer.bytes);
    CHECK_THROWS_AS(parse_colmap_binary(bytes_of(files.cameras), bytes_of(files.images), "s"), Error);
    files = good;
    files.images.replace(files.images.size() - 8, 8, writer.bytes);  // number of points of the image
    CHECK_THROWS_AS(parse_colmap_binary(bytes_of(files.cameras), bytes_of(files.images), "s"), Error);
  }
}

TEST_CASE("transforms.json: focal length from the angle, size from the image, extension from the disk") {
  nlohmann::json root{{"camera_angle_x", 0.9272952180016122}};  // 2 atan(1/2): f = width
  root["frames"] = {
      {{"file_path", "./train/r_0"}, {"transform_matrix", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 4}, {0, 0, 0, 1}}}}};
  TransformsSource source = no_images();
  CHECK_THROWS_WITH_AS(parse_transforms_json(root, source), doctest::Contains("no w and h and no image"), Error);
  source.images = {[](const std::string& path) { return path == "/data/train/r_0.jpg"; },
                   [](const std::string&) {
                     return ImageSize{800, 600};
                   }};
  const Capture capture = parse_transforms_json(root, source);
  const Camera& c = capture.views[0].camera;
  CHECK(c.name == "r_0.jpg");
  CHECK(capture.views[0].image_path == "/data/train/r_0.jpg");
  CHECK(c.fx == doctest::Approx(800));
  CHECK(c.fy == c.fx);
  CHECK((c.cx == 400 && c.cy == 300));
  CHECK((c.rotation * Vec3<double>{0, 0, 0} + c.translation).z == doctest::Approx(4));  // the origin is in front
  for (const double angle : {0.0, -0.5, 3.2}) {
    root["camera_angle_x"] = angle;
    CHECK_THROWS_WITH_AS(parse_transforms_json(root, source), doctest::Contains("an angle between 0 and pi"), Error);
  }
}

TEST_CASE("transforms.json: names keep the folders that differ, mask_path is resolved") {
  auto views = test::random_cameras(2, false);
  nlohmann::json root = test::transforms_json(views);
  root["frames"][0]["file_path"] = "../shots/left/1.png";
  root["frames"][1]["file_path"] = "../shots/right/1.png";
  root["frames"][1]["mask_path"] = "masks/r1.png";
  const Capture capture = parse_transforms_json(root, no_images());
  CHECK(capture.views[0].camera.name == "left/1.png");
  CHECK(capture.views[1].camera.name == "right/1.png");
  CHECK(capture.views[1].image_path == "/shots/right/1.png");
  CHECK(capture.views[0].mask_path.empty());
  CHECK(capture.views[1].mask_path == "/data/masks/r1.png");
}

TEST_CASE("applied_transform is kept by default and undone on request") {
  const auto views = test::random_cameras(2, false);
  // nerfstudio's own: x y z -> y x -z, here with a shift and a scale
  const WorldTransform applied{{{0, 1, 0, 1, 0, 0, 0, 0, -1}}, {0.5, -1, 2}, 3};
  std::vector<PosedCamera> moved = views;
  for (PosedCamera& view : moved) apply(applied, view.camera);
  nlohmann::json root = test::transforms_json(moved);
  root["applied_transform"] = {{0, 1, 0, 0.5}, {1, 0, 0, -1}, {0, 0, -1, 2}};
  root["applied_scale"] = 3;
  check_same(parse_transforms_json(root, no_images()), moved);
  check_same(parse_transforms_json(root, no_images(true)), views);
}

TEST_CASE("a world transform moves cameras and points consistently") {
  const WorldTransform world{{{0, -1, 0, 1, 0, 0, 0, 0, 1}}, {1, 2, 3}, 0.25};
  const Camera before = test::random_cameras(1, false)[0].camera;
  Camera after = before;
  apply(world, after);
  const Vec3<double> x{0.3, -0.7, 1.1}, moved = world.scale * (world.rotation * x + world.translation);
  const Vec3<double> p = before.rotation * x + before.translation, q = after.rotation * moved + after.translation;
  CHECK(q.x == doctest::Approx(0.25 * p.x).epsilon(kTolerance));
  CHECK(q.y == doctest::Approx(0.25 * p.y).epsilon(kTolerance));
  CHECK(q.z == doctest::Approx(0.25 * p.z).epsilon(kTolerance));
}

TEST_CASE("invalid transforms.json files are rejected with the location") {
  const nlohmann::json good = test::transforms_json(test::random_cameras(1, false));
  const auto refused = [&](const char* pointer, const nlohmann::json& value, const char* message) {
    nlohmann::json broken = good;
    broken[nlohmann::json::json_pointer(pointer)] = value;
    CAPTURE(pointer);
    CHECK_THROWS_WITH_AS(parse_transforms_json(broken, no_images()), doctest::Contains(message), Error);
  };
  const nlohmann::json eye{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  refused("/frames", 3, "frames: 3, expected an array");
  refused("/frames", nlohmann::json::array(), "no cameras");
  refused("/frames/0", 1, "frames[0]: number, expected an object");
  refused("/frames/0/file_path", 1, "expected a text");
  refused("/frames/0/transform_matrix/0/0", nullptr, "transform_matrix");
  refused("/frames/0/transform_matrix", {1, 2}, "4x4 numbers");
  refused("/frames/0/transform_matrix/3/0", 1, "a last row of 0 0 0 1");
  nlohmann::json other = eye;
  other[0][0] = -1;
  refused("/frames/0/transform_matrix", other, "reflection");
  other = eye;
  for (int i = 0; i < 3; ++i) other[std::size_t(i)][std::size_t(i)] = 2;
  refused("/frames/0/transform_matrix", other, "differs from a rotation by 3.0");
  refused("/k1", 0.1, "lens distortion k1");
  refused("/frames/0/p2", -1e-3, "lens distortion p2");
  refused("/k2", -3e-8, "lens distortion k2 = -3e-08");
  refused("/is_fisheye", true, "is_fisheye, expected a pinhole");
  refused("/frames/0/is_fisheye", true, "is_fisheye, expected a pinhole");
  refused("/camera_model", "OPENCV_FISHEYE", "camera model OPENCV_FISHEYE");
  refused("/frames/0/fl_x", 0, "focal length");
  for (const int width : {0, -48}) refused("/w", width, "expected an integer");
  refused("/w", "48", "expected a finite number");
  refused("/applied_transform", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 5, 0}}, "applied_transform");
}

TEST_CASE("invalid cameras.json files are rejected with the location") {
  const nlohmann::json good = test::cameras_json(test::random_cameras(2, true));
  const auto refused = [&](const char* pointer, const nlohmann::json& value, const char* message) {
    nlohmann::json broken = good;
    broken[nlohmann::json::json_pointer(pointer)] = value;
    CHECK_THROWS_WITH_AS(parse_cameras_json(broken, "c"), doctest::Contains(message), Error);
  };
  refused("/1/img_name", "view 0.png", "image view 0.png is listed twice");
  refused("/1/rotation/0", {1, 1}, "[1].rotation");
  refused("/1/rotation", {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, "differs from a rotation");
  refused("/1/position", {1, 2}, "[1].position");
  refused("/0/fx", -3, "focal length");
  CHECK_THROWS_WITH_AS(parse_cameras_json(nlohmann::json::object(), "c"), doctest::Contains("expected a list"), Error);
}

TEST_CASE("npy: both scalars, both byte orders and both element orders give the same matrix") {
  const auto file = [](const std::string& type, bool fortran) {
    test::ByteWriter out;
    out.bytes = test::npy_header(type, fortran, "(2, 3)");
    for (int i = 0; i < 6; ++i) {
      const int value = fortran ? (i % 2) * 3 + i / 2 : i;
      test::ByteWriter scalar;
      if (type[2] == '4')
        scalar.put(float(value) + 0.5f);
      else
        scalar.put(double(value) + 0.5);
      if (type[0] == '>') std::reverse(scalar.bytes.begin(), scalar.bytes.end());
      out.bytes += scalar.bytes;
    }
    return out.bytes;
  };
  for (const char* type : {"<f8", ">f8", "<f4", ">f4"})
    for (const bool fortran : {false, true}) {
      CAPTURE(type);
      const std::string bytes = file(type, fortran);
      const NpyMatrix m = parse_npy(bytes_of(bytes), "a.npy");
      CHECK((m.rows == 2 && m.columns == 3));
      CHECK(m.data == std::vector<double>{0.5, 1.5, 2.5, 3.5, 4.5, 5.5});
    }
}

TEST_CASE("npy: every prefix, other types and shapes beyond the file size are rejected") {
  const std::string good = test::llff_npy(test::random_cameras(1, true));
  for (std::size_t n = 0; n < good.size(); ++n) CHECK_THROWS_AS(parse_npy(bytes_of(good).first(n), "a.npy"), Error);
  for (const auto& c : {std::pair<const char*, const char*>{"<i8", "(1, 1)"},
                        {"|O", "(1, 1)"},
                        {"<f8", "(1,)"},
                        {"<f8", "(1, 1, 1)"},
                        {"<f8", "(-1, 1)"},
                        {"<f8", "(18446744073709551615, 17)"},
                        {"<f8", "(4294967296, 4294967296)"},
                        {"<f8", "(x, 1)"}}) {
    CAPTURE(c.second);
    const std::string bytes = test::npy_header(c.first, false, c.second) + std::string(8, '\0');
    CHECK_THROWS_AS(parse_npy(bytes_of(bytes), "a.npy"), Error);
  }
}

TEST_CASE("LLFF with a wrong number of images is kInconsistent") {
  const auto views = test::random_cameras(2, true);
  const std::string npy = test::llff_npy(views);
  CHECK(test::code_of([&] { llff_capture(parse_npy(bytes_of(npy), "p"), {"a.png"}, "p"); }) ==
        ErrorCode::kInconsistent);
}

TEST_CASE("a COLMAP model is found in its usual folders, binary before text") {
  const test::TempDir dir;
  const auto views = test::random_cameras(1, false);
  const test::ColmapFiles text = test::colmap_text(views), binary = test::colmap_binary(views);
  CHECK(find_colmap_model(dir.path()).empty());
  dir.write("sparse/0/cameras.txt", text.cameras);
  dir.write("sparse/0/images.txt", text.images);
  const std::string model = find_colmap_model(dir.path());
  CHECK(model == dir.path() + "/sparse/0");
  CHECK(read_colmap(model).format == "COLMAP text");
  dir.write("sparse/0/cameras.bin", binary.cameras);
  dir.write("sparse/0/images.bin", binary.images);
  CHECK(read_colmap(model).format == "COLMAP binary");
  CHECK(read_colmap(model).notes.size() == 1);
}

TEST_CASE("without a model 0, the first model in sparse is found") {
  for (const char* folder : {"sparse/1", "colmap/sparse/2"}) {
    const test::TempDir dir;
    for (const std::string name : {"/cameras.txt", "/images.txt"}) dir.write(folder + name, "x");
    CHECK(find_colmap_model(dir.path()) == dir.file(folder));
  }
}

}  // namespace ngs::io
