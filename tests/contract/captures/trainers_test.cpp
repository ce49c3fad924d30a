// Outputs of trainers, and inputs that contradict each other: what is read, and the next step that is printed.
#include <doctest/doctest.h>

#include <filesystem>

#include "contract/captures/capture.h"
#include "support/skip.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using test::Capture;
using test::change_masks, test::contains, test::move;

}  // namespace

TEST_CASE("of a checkpoint of nerfstudio without a splat, the command that exports it is printed") {
  const Capture capture;
  fs::remove(capture.path("point_cloud.ply"));
  capture.dir.write("c/outputs/c/splatfacto/1/config.yml", "x");
  capture.dir.write("c/outputs/c/splatfacto/1/nerfstudio_models/step-000029999.ckpt", "x");
  test::refused(capture.run({"ngs", "cut", "c", "-o", "out"}), 3,
                "ns-export gaussian-splat --load-config c/outputs/c/splatfacto/1/config.yml");
}

TEST_CASE("a checkpoint, the settings of a trainer, and folders in a capture lead to the splat and the capture") {
  const Capture capture;
  for (const char* name : {"c/ckpts/ckpt_29999_rank0.pt", "c/outputs/c/1/config.yml"}) capture.dir.write(name, "PK");
  test::refused(capture.run({"ngs", "cut", "c/ckpts/ckpt_29999_rank0.pt"}), 3, "a checkpoint of a trainer");
  test::refused(capture.run({"ngs-extract", "c/ckpts/ckpt_29999_rank0.pt", "--largest", "1", "--object-ply", "o.ply"}),
                3, "a checkpoint of a trainer");
  test::refused(capture.run({"ngs", "cut", "c/outputs/c/1/config.yml"}), 3, "settings of a trainer");
  test::refused(capture.run({"ngs", "cut", "c/outputs/c/1"}), 3, "no cameras found, a folder above has some");
  move(capture, "point_cloud.ply", "exports/splat.ply");
  CHECK(contains(capture.run({"ngs", "cut", "c/exports"}).err,
                 "ngs cut c/; for its splat without photos: ngs cut c/exports/splat.ply"));
}

TEST_CASE(
    "for a splat in a world of another scale, the transform below the capture is named if it fits, else the scale") {
  const Capture capture;
  capture.scale(0.5);
  const std::string scaled = test::read_bytes(capture.path("point_cloud.ply"));
  capture.scale(2);  // the cameras as they were
  capture.dir.write("c/point_cloud.ply", scaled);
  test::refused(capture.import(), 4, "it fits if the cameras' world is twice the model's");
  const std::string transform = "c/outputs/c/1/dataparser_transforms.json";
  for (const char* scale : {"0.25", "0.5"}) {
    const std::string words = R"({"transform": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]], "scale": )";
    capture.dir.write(transform, words + scale + "}");
    CHECK(contains(capture.import().err, "import with --world-transform ./" + transform) == (scale[2] == '5'));
  }
  test::succeeded(capture.run({"ngs-scene", "import", "c", "--world-transform", transform, "-o", "s.json", "-w"}));
}

TEST_CASE("what is odd in a splat that does not fit is said before the error") {
  const Capture capture;
  GaussianCloud cloud = test::tiny_scene().cloud;
  for (std::size_t i = 0; i < cloud.logit_opacity.size(); ++i) {
    cloud.position[3 * i] += 50;
    cloud.logit_opacity[i] = 1;
  }
  std::fill_n(cloud.rotation.begin(), cloud.rotation.size() / 5, 0.f);
  capture.dir.write("c/point_cloud.ply", test::strict_ply_bytes(cloud));
  const std::string err = test::refused(capture.run({"ngs", "cut", "c", "-o", "out"}), 4, "cameras and model").err;
  CHECK(contains(err, "opacity is 1 in every row"));
  CHECK(contains(err, "Gaussians have the rotation 0 0 0 0"));
}

TEST_CASE("masks beside the photos that cfg_args names, or beside pictures with masks drawn on them, are read") {
  const Capture capture;
  move(capture, "point_cloud.ply", "../out/m/point_cloud/iteration_7/point_cloud.ply");
  move(capture, "sparse", "../out/m/sparse");
  capture.dir.write("out/m/cfg_args", "Namespace(images='images', source_path='../../c')");
  test::succeeded(capture.run({"ngs-scene", "import", "out/m", "-o", "s.json"}));
  CHECK(capture.views_with("mask") == test::kCaptureViews);
  const Capture overlay;
  fs::copy(overlay.path("masks"), overlay.path("binary"));
  int pixel = 0;
  change_masks(overlay, [&](bool, std::uint8_t, std::size_t) { return std::uint8_t(12 + pixel++ * 37 % 240); });
  move(overlay, "masks", "drawn");
  move(overlay, "drawn", "masks/drawn");
  move(overlay, "binary", "masks/binary");
  CHECK(contains(test::succeeded(overlay.import()).err, "only binary holds masks, not 1 folders of pictures"));
  CHECK(overlay.scene()["objects"].size() == 1);
}

TEST_CASE("a device is refused at once, and an output folder that is a link to nothing is named") {
  if (test::under_wine()) return test::skip("Windows has no such devices and links");
  const Capture capture;
  test::refused(capture.run({"ngs", "cut", "/dev/zero"}), 3, "/dev/zero: cannot be read: a device, expected a file");
  test::refused(capture.run({"ngs-scene", "import", "c", "--model", "/dev/zero", "-o", "s.json"}), 3, "a device");
  fs::create_symlink("absent", capture.dir.path() + "/out");
  test::refused(capture.run({"ngs", "cut", "c", "-o", "out"}), 8, "out: a link to absent, which is not there");
}

TEST_CASE("two and three of six masks that are inverted are named with the command that mends them") {
  const Capture capture;
  const auto invert = [&](const std::string& name) {
    const io::RawMask mask = io::read_mask_raw(capture.path(name), io::Palette::kMask);
    ImageU8 inverted(mask.width_px, mask.height_px, 1);
    for (std::size_t p = 0; p < inverted.data.size(); ++p)
      inverted.data[p] = std::uint8_t(255 - mask.data[p * std::size_t(mask.channels)]);
    fs::remove(capture.path(name));
    io::write_png(capture.path(name), inverted);
  };
  invert("masks/v1.png");
  invert("masks/v4.png");
  const test::ProcessResult result =
      test::succeeded(capture.run({"ngs", "cut", "c", "-o", "out", "--quality", "draft"}));
  CHECK_MESSAGE(contains(result.err, "(v1.png, v4.png inverted)"), result.err);
  CHECK(contains(result.err, "mogrify -negate c/masks/v1.png c/masks/v4.png"));
  invert("masks/v3.png");
  test::refused(capture.run({"ngs", "cut", "c", "-o", "out", "--quality", "draft"}), 4,
                "mogrify -negate c/masks/v1.png c/masks/v3.png c/masks/v4.png");
}

}  // namespace ngs
