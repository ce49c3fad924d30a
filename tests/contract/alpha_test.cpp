// Photos whose alpha channel is the object's mask, with a splat of the whole scene and with one of the object alone.
#include <doctest/doctest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "ngs/io/image/image_file.h"
#include "support/process.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;

/// The tiny scene without masks/, with its masks as the alpha channel of its photos. `is_black`: hidden pixels are
/// black.
struct CutOut {
  test::TempDir dir;
  explicit CutOut(bool is_black) {
    test::write_tiny_scene(dir.file("all"));
    for (const char* part : {"sparse", "images", "model.ply"})
      fs::copy(dir.path() + "/all/" + part, dir.file(std::string("in/") + part), fs::copy_options::recursive);
    for (int v = 0; v < 6; ++v) {
      const std::string name = "v" + std::to_string(v) + ".png";
      const io::RawMask photo = io::read_mask_raw(dir.path() + "/all/images/" + name, io::Palette::kColours);
      const io::RawMask mask = io::read_mask_raw(dir.path() + "/all/masks/" + name, io::Palette::kMask);
      ImageU8 out(photo.width_px, photo.height_px, 4);
      for (std::size_t p = 0; p < mask.data.size(); ++p)
        for (std::size_t c = 0; c < 4; ++c)
          out.data[4 * p + c] = std::uint8_t(c == 3                          ? mask.data[p]
                                             : is_black && mask.data[p] == 0 ? 0
                                                                             : photo.data[3 * p + c]);
      io::write_png(dir.path() + "/in/images/" + name, out);
    }
  }
  std::string mask_of_last_view() const {
    return nlohmann::json::parse(test::read_bytes(dir.path() + "/scene.json")).at("views").at(5).value("mask", "");
  }
  test::ProcessResult run(const test::Words& argv) const { return test::run_tool(argv, dir.path()); }
};

}  // namespace

TEST_CASE("the alpha channel of photos is the mask of a splat of the whole scene") {
  for (const bool is_black : {false, true}) {
    CAPTURE(is_black);
    const CutOut capture(is_black);
    fs::copy(capture.dir.path() + "/in/images", capture.dir.file("copy"));
    for (const std::vector<std::string>& masks :
         {std::vector<std::string>{}, {"--masks", "in/images"}, {"--masks", "copy"}}) {
      CAPTURE(masks);
      const test::Words import = test::split("ngs-scene import in -o scene.json -w");
      const test::ProcessResult result = test::succeeded(capture.run(test::joined(import, masks)));
      CHECK(result.err.find("6 masks: alpha channel used as the mask") != std::string::npos);
      CHECK(capture.mask_of_last_view() == "in/images/v5.png");
    }
    test::succeeded(capture.run({"ngs", "cut", "in", "-o", "out", "--quality", "draft"}));
    CHECK(fs::exists(capture.dir.path() + "/out/object.ply"));
  }
}

TEST_CASE("strokes do not replace masks in the alpha channel, whose photos lack what is hidden") {
  const CutOut capture(true);
  capture.dir.write("p.json", R"({"ngs_prompts": 1, "view": "v0.png", "width": 48, "height": 36,
      "boxes": [[12, 6, 36, 30]]})");
  test::refused(capture.run({"ngs", "cut", "in", "-o", "out", "--strokes", "p.json"}), 4, "alpha channel");
}

TEST_CASE("the alpha channel of photos is no mask for a splat of the object alone, which is named") {
  const CutOut capture(false);
  const auto run = [&](std::vector<std::string> argv) { return test::succeeded(capture.run(std::move(argv))); };
  run({"ngs-scene", "import", "all", "-o", "all.json"});
  run({"ngs-variance", "all.json", "-o", "boundary.ply"});
  run({"ngs-extract", "boundary.ply", "--object-ply", "in/model.ply", "-w"});
  const test::ProcessResult result = run({"ngs-scene", "import", "in", "-o", "scene.json"});
  CHECK(result.err.find("the alpha channel of the photos is not used as masks: the model covers only") !=
        std::string::npos);
  CHECK(capture.mask_of_last_view().empty());
  const test::ProcessResult help_of = run({"ngs", "cut", "in", "-o", "out", "--quality", "draft"});
  const std::string help = help_of.out + help_of.err;
  CHECK(help.find("the alpha channel of the photos is not used") < help.find("paint the object green"));
  capture.dir.write("p.json", R"({"ngs_prompts": 1, "view": "v0.png", "width": 48, "height": 36,
      "boxes": [[12, 6, 36, 30]]})");
  run({"ngs", "cut", "in", "-o", "out", "--quality", "draft", "--strokes", "p.json", "--all-pieces", "--force"});
}

}  // namespace ngs
