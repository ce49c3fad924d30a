// Layouts, names and columns that people have, and masks that do not fit: what is read, and what is said.
#include <doctest/doctest.h>

#include <array>
#include <filesystem>

#include "contract/captures/capture.h"
#include "ngs/io/image/image_file.h"
#include "support/skip.h"
#include "support/splat_shapes.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using test::Capture;
using test::change_masks, test::check_complete, test::contains, test::move;

}  // namespace

TEST_CASE("a capture is found three folders below, as in an archive that was unpacked twice") {
  const Capture capture;
  for (const char* name : {"sparse", "images", "masks", "point_cloud.ply"})
    move(capture, name, std::string("a/scene/scene/") + name);
  capture.dir.write("c/__MACOSX/scene/._point_cloud.ply", "x");
  check_complete(capture);
}

TEST_CASE("cameras in dense/0, photos in input/ and a trainer's output two folders below are found") {
  const Capture capture;
  move(capture, "sparse", "dense/0/sparse");
  move(capture, "images", "input");
  move(capture, "point_cloud.ply", "output/1a2b/point_cloud/iteration_30000/point_cloud.ply");
  check_complete(capture);
}

TEST_CASE("photos in images/train and images/test are read as those of one capture") {
  const Capture capture;
  for (int i = 0; i < test::kCaptureViews; ++i) {
    const std::string name = "/v" + std::to_string(i) + ".png";
    move(capture, "images" + name, std::string("images/") + (i % 3 == 0 ? "test" : "train") + name);
  }
  check_complete(capture);
}

TEST_CASE("the files that macOS adds to archives are no masks, photos or splats") {
  const Capture capture;
  for (const char* name : {"masks/._v0.png", "images/._v0.png", "._point_cloud.ply", "masks/__MACOSX/v0.png"})
    capture.dir.write(std::string("c/") + name, "x");
  const test::ProcessResult result = test::succeeded(capture.import());
  CHECK(!contains(result.err, "._"));
}

TEST_CASE("pictures of the object on one colour are masks, pictures of everything are refused") {
  const Capture capture;
  CHECK(capture.import().exit_code == 0);
  for (const std::array<std::uint8_t, 3> ground : {std::array<std::uint8_t, 3>{}, {255, 255, 255}, {0, 177, 64}}) {
    const Capture on_ground;
    int pixel = 0;
    change_masks(on_ground, [&](bool is_object, std::uint8_t, std::size_t c) {
      return is_object ? std::uint8_t(12 + pixel++ * 37 % 230) : ground[c];
    });
    const test::ProcessResult result = test::succeeded(on_ground.import());
    CHECK(contains(result.err, "a picture on one colour, read as object where it has another"));
  }
  const Capture overlay;
  int pixel = 0;  // photos have more colours than those of the tiny scene
  change_masks(overlay, [&](bool is_object, std::uint8_t, std::size_t c) {
    const int photo = 12 + pixel++ * 37 % 240;
    return std::uint8_t(is_object && c == 1 ? photo / 2 + 127 : photo);
  });
  test::refused(overlay.import(), 3, "a picture of many colours, expected a mask");
}

TEST_CASE("one file with the masks of all photos is named, with the command that takes it apart") {
  const struct {
    const char *file, *command;
  } cases[] = {{"masks/masks.mp4", "ffmpeg -i "}, {"masks.npz", "numpy.load"}, {"masks.tiff", "convert "}};
  for (const auto& c : cases) {
    CAPTURE(c.file);
    const Capture capture;
    fs::remove_all(capture.path("masks"));
    capture.dir.write(std::string("c/") + c.file, "x");
    test::ProcessResult result = capture.run({"ngs", "cut", "c", "-o", "out"});
    CAPTURE(result.err);
    CHECK(result.exit_code == 4);
    CHECK(contains(result.err, std::string("c/") + c.file));
    CHECK(contains(result.err, c.command));
    CHECK(contains(result.err, "--masks masks-png --masks-in-order"));
    result = capture.run({"ngs-scene", "import", "c", "--masks", std::string("c/") + c.file, "-o", "s.json", "-w"});
    CHECK(contains(result.err, c.command));
  }
}

TEST_CASE("an archive of masks, one mask for all photos, and two folders of masks end ngs cut with the next step") {
  const auto cut = [](const Capture& capture, int code, const std::vector<std::string>& parts) {
    const test::ProcessResult result = capture.run({"ngs", "cut", "c", "-o", "out"});
    CAPTURE(result.err);
    CHECK(result.exit_code == code);
    for (const std::string& part : parts) CHECK_MESSAGE(contains(result.err, part), part);
  };
  const Capture archive;
  fs::remove_all(archive.path("masks"));
  archive.dir.write("c/masks.zip", "x");
  cut(archive, 4, {"c/masks.zip", "unpack it: unzip c/masks.zip -d c/masks"});
  const Capture one;
  const std::string bytes = test::read_bytes(one.path("masks/v3.png"));
  for (const char* name : {"masks/mask.png", "mask.png"}) {
    fs::remove_all(one.path("masks"));
    one.dir.write(std::string("c/") + name, bytes);
    const std::string command = std::string("convert c/") + name;
    cut(one, 4, {"1 images fit no view", command, "-transparent black v0.png; then --strokes v0.png"});
  }
  const Capture two;
  move(two, "masks", "SegmentationClass");
  fs::copy(two.path("SegmentationClass"), two.path("SegmentationObject"));
  cut(two, 4, {"several mask folders (SegmentationClass SegmentationObject)", "choose one with --masks DIR"});
  const Capture none;
  fs::remove_all(none.path("masks"));
  none.dir.write("c/masks/.DS_Store", "x");
  cut(none, 0, {});
}

TEST_CASE("photos of images_4 alone are read, and of the photos' own folder the one above is named") {
  const Capture capture;
  move(capture, "images", "images_4");
  check_complete(capture);
  const test::ProcessResult result = test::refused(capture.run({"ngs", "cut", "c/images_4", "-o", "out"}), 3,
                                                   "c/images_4: no cameras found, a folder above has some");
  CHECK(contains(result.err, "ngs cut c/"));
  move(capture, "images_4", "images/cam0");
  check_complete(capture);
  CHECK(capture.run({"ngs", "cut", "c/sparse/0/images.txt", "-o", "out", "--dry-run"}).exit_code == 0);
}

TEST_CASE(
    "masks one level deeper are used if the name of their folder suggests masks, else named if they look like masks") {
  for (const char* folder : {"data/masks", "images/masks", "data/run/sam"}) {
    CAPTURE(folder);
    const Capture deeper;
    move(deeper, "masks", folder);
    deeper.dir.write("c/out/.ngs-cut", "x");
    fs::copy(deeper.path(folder), deeper.path("out/masks"));
    check_complete(deeper);
  }
  const Capture looks;
  move(looks, "masks", "labels");
  fs::copy(looks.path("images"), looks.path("images_2"));
  const test::ProcessResult result = looks.import();
  CHECK(contains(result.err, "c/labels: its pictures are called like photos and look like masks, not read"));
  CHECK(contains(result.err, "--masks ./c/labels"));
  CHECK(!contains(result.err, "images_2: its"));
  const Capture several;
  move(several, "masks", "data/masks");
  fs::copy(several.path("data/masks"), several.path("data/segmentation"));
  CHECK(several.run({"ngs", "cut", "c", "-o", "out"}).exit_code == 4);
}

TEST_CASE("masks in another format, links without a file, and objects without a mask in some views are named") {
  const auto error_of = [](const std::function<void(const Capture&)>& change) {
    const Capture capture;
    fs::rename(capture.path("masks"), capture.path("old"));
    change(capture);
    fs::remove_all(capture.path("old"));
    const test::ProcessResult result = capture.run({"ngs", "cut", "c", "-o", "out", "--quality", "draft"});
    return std::to_string(result.exit_code) + " " + result.err;
  };
  const std::string cvat = error_of([](const Capture& c) { c.dir.write("c/annotations.xml", "<annotations/>"); });
  CHECK(contains(cvat, "c/annotations.xml: 1 files fit no view"));
  const std::string yolo = error_of([](const Capture& c) { c.dir.write("c/labels/v0.txt", "0 .1 .1 .5 .5"); });
  CHECK(contains(yolo, "c/labels: 1 files fit no view (first: c/labels/v0.txt"));
  const std::string pointer =
      error_of([](const Capture& c) { c.dir.write("c/masks/v0.png", "version https://git-lfs.github.com/spec/v1\n"); });
  CHECK(contains(pointer, "Git LFS pointer, without the data: git lfs pull"));
  const std::string links = error_of([](const Capture& c) {
    fs::create_directory(c.path("masks"));
    fs::create_symlink("absent", c.path("masks/v0.png"));
  });
  CHECK(contains(links, "4 "));
  CHECK(contains(links, "c/masks: 1 links lead to no file (first: c/masks/v0.png)"));
  const std::string deeper = error_of([](const Capture& c) {
    move(c, "old", "masks/run/cup");
    fs::create_directory(c.path("masks/log"));
  });
  CHECK(contains(deeper, "name their folder: --masks c/masks/run/cup"));
  const std::string only = error_of([](const Capture& c) { move(c, "old", "masks/sam2/video/cup"); });
  CHECK(contains(only, "0 "));
  CHECK(contains(only, "c/masks/sam2/video: read for masks, as the only folder there"));
  const std::string file = error_of([](const Capture& c) { c.dir.write("c/masks", "x"); });
  CHECK(contains(file, "4 "));
  CHECK(contains(file, "c/masks: a file, expected a folder of masks"));
  const std::string link = error_of([](const Capture& c) { fs::create_symlink("absent", c.path("masks")); });
  CHECK(contains(link, "c/masks: a link that leads nowhere, expected a folder of masks"));
  const std::string some = error_of([](const Capture& c) {
    fs::create_directory(c.path("masks"));
    fs::copy(c.path("old"), c.path("masks/cup"));
    fs::copy(c.path("old"), c.path("masks/plate"));
    for (const char* name : {"v1.png", "v4.png"}) fs::remove(c.path(std::string("masks/plate/") + name));
  });
  CHECK(contains(some, "0 "));
  CHECK(contains(some, "2 views lack the mask of an object (first: c/masks/plate/v1.png)"));
  const std::string each = error_of([](const Capture& c) {
    for (int i = 0; i < test::kCaptureViews; ++i)
      move(c, "old/v" + std::to_string(i) + ".png",
           "masks/cup" + std::to_string(i % 2) + "/v" + std::to_string(i) + ".png");
  });
  CHECK(contains(each, "4 "));
  CHECK(contains(each, "every view lacks the mask of an object (first: c/masks/cup1/v0.png)"));
  CHECK(contains(each, "if these folders hold parts of the capture, not objects: move all masks into one folder"));
}

TEST_CASE("ngs cut names the views in which the result disagrees with their masks") {
  const Capture capture;
  for (int i = 0; i < test::kCaptureViews; ++i)
    fs::copy_file(capture.path("masks/v" + std::to_string(i) + ".png"), capture.path("right-" + std::to_string(i)));
  const test::ProcessResult result =
      test::succeeded(capture.run({"ngs", "cut", "c", "-o", "out", "--quality", "draft"}));
  CHECK(!contains(result.err, "disagrees"));
  const io::RawMask mask = io::read_mask_raw(capture.path("masks/v0.png"), io::Palette::kMask);
  ImageU8 other(mask.width_px, mask.height_px, 1);  // a small corner
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) other.data[std::size_t(y * mask.width_px + x)] = 255;
  fs::remove(capture.path("masks/v0.png"));
  io::write_png(capture.path("masks/v0.png"), other);
  const test::ProcessResult changed =
      test::succeeded(capture.run({"ngs", "cut", "c", "-o", "other", "--quality", "draft", "--json"}));
  CHECK(contains(changed.err, "the result disagrees with 1 of 6 masks"));
  CHECK(nlohmann::json::parse(changed.out)["result"]["mask_agreement"]["apart"] == nlohmann::json{"v0.png"});
  for (int i = 0; i < test::kCaptureViews; ++i) {  // the left half of the ball, in one view the right half
    const std::string path = capture.path("masks/v" + std::to_string(i) + ".png");
    const io::RawMask ball = io::read_mask_raw(capture.path("right-" + std::to_string(i)), io::Palette::kMask);
    for (int p = 0; p < mask.width_px * mask.height_px; ++p)
      other.data[std::size_t(p)] = (p % mask.width_px < mask.width_px / 2) == (i != 3)
                                       ? std::uint8_t(ball.data[std::size_t(p) * std::size_t(ball.channels)])
                                       : std::uint8_t(0);
    fs::remove(path);
    io::write_png(path, other);
  }
  const test::ProcessResult turned = test::succeeded(
      capture.run({"ngs", "cut", "c", "-o", "turned", "--quality", "draft", "--min-mask-agreement", "-1"}));
  CHECK_MESSAGE(contains(turned.err, "v3.png; they fit with one mistake undone: v3.png: mirrored (mogrify"),
                turned.err);
}

TEST_CASE("the summary of ngs cut counts the Gaussians of object.ply as written, those of two objects once") {
  const Capture capture;
  for (int i = 0; i < test::kCaptureViews; ++i) {
    const std::string name = "v" + std::to_string(i) + ".png";
    capture.dir.write("c/masks/a/" + name, test::read_bytes(capture.path("masks/" + name)));
    move(capture, "masks/" + name, "masks/b/" + name);
  }
  const test::ProcessResult cut = test::succeeded(capture.run(
      {"ngs", "cut", "c", "-o", "o", "--quality", "draft", "--min-mask-agreement", "-1", "--no-align-views"}));
  const std::string ply = test::read_bytes(capture.dir.path() + "/o/object.ply");
  const std::size_t begin = ply.find("element vertex ") + 15;
  const std::string count = ply.substr(begin, ply.find('\n', begin) - begin);
  CHECK_MESSAGE(contains(cut.err, "object      o/object.ply  " + count + " Gaussians"), cut.err);
}

TEST_CASE("a view without a mask, or with a mask that is empty or full, is named in the summary of ngs cut") {
  const auto fill = [](const Capture& capture, std::uint8_t value) {
    const io::RawMask mask = io::read_mask_raw(capture.path("masks/v3.png"), io::Palette::kMask);
    ImageU8 plain(mask.width_px, mask.height_px, 1);
    std::ranges::fill(plain.data, value);
    fs::remove(capture.path("masks/v3.png"));
    io::write_png(capture.path("masks/v3.png"), plain);
  };
  const std::function<void(const Capture&)> changes[] = {
      [](const Capture& capture) { fs::remove(capture.path("masks/v3.png")); },
      [&](const Capture& capture) { fill(capture, 0); }, [&](const Capture& capture) { fill(capture, 255); }};
  for (const auto& change : changes) {
    const Capture capture;
    change(capture);
    const test::ProcessResult result =
        test::succeeded(capture.run({"ngs", "cut", "c", "-o", "out", "--quality", "draft", "--json"}));
    CHECK(contains(result.err, "no mask is used of 1 views: v3.png"));
    CHECK(nlohmann::json::parse(result.out)["result"]["views_without_mask"] == nlohmann::json{"v3.png"});
  }
}

TEST_CASE(
    "folders without rights, a umask that takes those of the owner, and a pipe without a writer end with a remedy") {
  if (test::under_wine()) return test::skip("Windows has no such rights and pipes");
  const Capture capture;
  const auto run = [&](const std::string& command) {
    test::ProcessSpec spec;  // root can read everything, unless it gives up that right
    spec.argv = {
        "bash", "-c",
        "if [ \"$(id -u)\" = 0 ]; then as='setpriv --bounding-set=-dac_override,-dac_read_search'; fi; " + command,
        NGS_TOOL_DIR};
    spec.folder = capture.dir.path();
    return test::run_process(spec);
  };
  if (run("$as true").exit_code != 0) return test::skip("no setpriv that may give up a right");
  for (const std::string folder : {"c", "c/sparse", "c/sparse/0", "c/images", "c/masks"})
    for (const char* mode : {"000", "644"}) {
      if (folder == "c/sparse" && mode[0] == '6') continue;
      CAPTURE(folder);
      CAPTURE(mode);
      const test::ProcessResult result =
          test::refused(run(std::string("chmod ") + mode + " " + folder +
                            "; $as $0/ngs-scene import c -o s.json -w; code=$?; chmod 755 " + folder + "; exit $code"),
                        3, folder + ": cannot be read: Permission denied");
      CHECK(contains(result.err, "chmod -R u+rX " + folder));
    }
  test::refused(run("chmod 000 c/masks/v2.png; $as $0/ngs cut c -o o2; code=$?; chmod 644 c/masks/v2.png; exit $code"),
                3, "chmod u+r c/masks/v2.png");
  test::refused(run("umask 777; $as $0/ngs cut c -o out"), 8, "umask 022");
  CHECK(!fs::exists(capture.dir.path() + "/out"));
  test::refused(run("mkfifo p.ply; $0/ngs-extract p.ply --largest 1 --object-ply o.ply"), 3,
                "p.ply: cannot be read: a pipe that no program writes to");
  CHECK(contains(run("$0/ngs cut p.ply").err, "a pipe, which is read only once"));
  CHECK(
      run("(sleep 1; cat c/point_cloud.ply > p.ply) & $0/ngs-extract p.ply --largest 1 --object-ply o.ply").exit_code ==
      0);
}

TEST_CASE("the vertical axis in a comment is the upward axis of --drop-below-plane auto") {
  GaussianCloud cloud;  // a plane of normal x, and a thing on it towards x
  for (int row = 0; row < 24; ++row)
    for (int i = 0; i < 24; ++i)
      test::add_gaussian(cloud, {0, 0.1 * i - 1.2, 0.1 * row - 1.2}, {1e-3, 0.05, 0.05}, {}, 4);
  for (int k = 0; k < 60; ++k) test::add_gaussian(cloud, {0.1 + 0.02 * k, 0.02 * (k % 5), 0.02 * (k % 7)}, 0.05, {}, 4);
  const Capture capture;
  std::string bytes = test::strict_ply_bytes(cloud);
  capture.dir.write("plain.ply", bytes);
  capture.dir.write("marked.ply", bytes.insert(bytes.find("element"), "comment Vertical Axis: z\n"));
  const auto cut = [&](const char* model, const char* up) {
    return capture.run({"ngs-extract", model, "--drop-below-plane", "auto", "--up", up, "--object-ply", "o.ply", "-w"});
  };
  CHECK(cut("plain.ply", "auto").exit_code == 0);
  CHECK(cut("plain.ply", "z").exit_code == 5);
  const test::ProcessResult result = cut("marked.ply", "auto");
  CHECK_MESSAGE(result.exit_code == 5, result.err);
}

TEST_CASE("tools work without a folder for temporary files at TMPDIR") {
  const Capture capture;
  test::succeeded(test::run_tool(test::split("ngs cut c -o out --quality draft"), capture.dir.path(),
                                 {{"TMPDIR", capture.path("absent")}}));
}

TEST_CASE("pictures at given cameras are called like the photos, and are made again if the cameras change") {
  const Capture capture;
  fs::remove_all(capture.path("images"));
  fs::remove_all(capture.path("masks"));
  const std::vector<std::string> cut = {"ngs", "cut", "c", "-o", "out"};
  REQUIRE(capture.run(cut).exit_code == 0);
  CHECK(fs::exists(capture.dir.path() + "/out/orbit/images/v0.png"));
  CHECK(!fs::exists(capture.dir.path() + "/out/orbit/images/0000.png"));
  const std::string before = test::read_bytes(capture.dir.path() + "/out/orbit/images/v0.png");
  std::string poses = test::read_bytes(capture.path("sparse/0/images.txt"));
  const std::size_t first = poses.find("v0.png"), second = poses.find("v1.png");
  poses[first + 1] = '1';
  poses[second + 1] = '0';
  capture.dir.write("c/sparse/0/images.txt", poses);
  REQUIRE(capture.run(cut).exit_code == 0);
  CHECK(before != test::read_bytes(capture.dir.path() + "/out/orbit/images/v0.png"));
}

}  // namespace ngs
