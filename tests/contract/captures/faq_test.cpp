// docs/faq.md, "By symptom": each message occurs as printed there, and the answer works.
#include <doctest/doctest.h>

#include "contract/captures/capture.h"
#include "ngs/io/image/image_file.h"
#include "support/mutations.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using test::Capture, test::contains;

struct Symptom {
  const char* text;                             // as in the page
  std::function<void(const Capture&)> make;     // makes the symptom
  int exit = 0;                                 // of import with the symptom
  std::vector<std::string> flags;               // the answer: flags of import,
  std::function<void(const Capture&)> correct;  // or what the user does to the files
};

void for_each_image(const Capture& capture, const std::string& folder,
                    const std::function<std::string(const std::string&)>& rename) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(capture.path(folder)))
    names.push_back(entry.path().filename().string());
  for (const std::string& name : names)
    fs::rename(capture.path(folder + "/" + name), capture.path(folder + "/" + rename(name)));
}

void write_label_maps(const Capture& capture) {
  for (int i = 0; i < test::kCaptureViews; ++i) {
    const std::string path = capture.path("masks/v" + std::to_string(i) + ".png");
    const io::RawMask mask = io::read_mask_raw(path, io::Palette::kColours);
    ImageU8 labels(mask.width_px, mask.height_px, 1);
    for (std::size_t p = 0; p < labels.data.size(); ++p)
      labels.data[p] = mask.data[p * std::size_t(mask.channels)] > 0 ? 200 : 150;  // both above the threshold
    io::write_png(path, labels);
  }
}

std::vector<Symptom> symptoms() {
  return {
      {"its masks cover most of the images and of their borders",
       [](const Capture& c) {
         test::apply_mutation({{"negative", c.path("masks")}});
       },
       4,
       {"--mask-invert"},
       {}},
      {"masks are full", write_label_maps, 4, {"--mask-mode", "label", "--object-id", "200"}, {}},
      {"no photo for 6 of 6 views",
       [](const Capture& c) { fs::rename(c.path("images"), c.path("pictures")); },
       0,
       {"--images", "c/pictures"},
       {}},
      {"has other names",
       [](const Capture& c) { for_each_image(c, "images", [](const std::string& name) { return "x" + name; }); },
       0,
       {},
       [](const Capture& c) { for_each_image(c, "images", [](const std::string& name) { return name.substr(1); }); }},
      {"no mask for 6 of 6 views",  // names with a common affix are read
       [](const Capture& c) {
         for_each_image(c, "masks",
                        [](const std::string& name) { return std::string{char('a' + name[1] - '0')} + ".png"; });
       },
       0,
       {},
       [](const Capture& c) {
         for_each_image(c, "masks",
                        [](const std::string& name) { return "v" + std::to_string(name[0] - 'a') + ".png"; });
       }},
      {"mask of ",
       [](const Capture& c) { io::write_png(c.path("masks/v0.png"), ImageU8(48, 30, 1)); },
       4,
       {},
       [](const Capture& c) {
         fs::copy_file(c.path("masks/v1.png"), c.path("masks/v0.png"), fs::copy_options::overwrite_existing);
       }},
      {"photo of ",
       [](const Capture& c) { io::write_png(c.path("images/v0.png"), ImageU8(36, 48, 3)); },
       4,
       {},
       [](const Capture& c) { fs::remove(c.path("images/v0.png")); }},
      {"several splats, none chosen",
       [](const Capture& c) {
         fs::copy_file(c.path("point_cloud.ply"), c.path("b.ply"));
         fs::rename(c.path("point_cloud.ply"), c.path("a.ply"));
       },
       0,
       {"--model", "c/a.ply"},
       {}},
      {"matches both views",
       [](const Capture& c) {
         std::string images = test::read_bytes(c.path("sparse/0/images.txt"));
         images.replace(images.find("v1.png"), 6, "v0.jpg");
         c.dir.write("c/sparse/0/images.txt", images);
         fs::rename(c.path("images/v1.png"), c.path("images/v0.jpg"));
         fs::rename(c.path("masks/v0.png"), c.path("masks/v0.tif"));
       },
       4,
       {},
       [](const Capture& c) {
         fs::rename(c.path("masks/v0.tif"), c.path("masks/v0.png.png"));
         fs::rename(c.path("masks/v1.png"), c.path("masks/v0.jpg.png"));
       }}};
}

}  // namespace

TEST_CASE("the messages of the table by symptom occur as printed, and its answers remove them") {
  const std::string page = test::read_bytes(NGS_SOURCE_DIR "/docs/faq.md");
  for (const Symptom& symptom : symptoms()) {
    CAPTURE(symptom.text);
    const std::string text(symptom.text);
    const std::string printed = text.substr(0, text.find(" 6 of 6"));  // the page prints "N of N"
    CHECK(contains(page, printed));
    const Capture capture;
    symptom.make(capture);
    test::ProcessResult result = capture.import();
    CHECK_MESSAGE(result.exit_code == symptom.exit, result.err);
    CHECK_MESSAGE(contains(result.err, text), result.err);
    if (symptom.correct) symptom.correct(capture);
    std::vector<std::string> argv{"ngs-scene", "import", "c", "-o", "s.json", "-w"};
    argv.insert(argv.end(), symptom.flags.begin(), symptom.flags.end());
    result = capture.run(argv);
    CHECK_MESSAGE(result.exit_code == 0, result.err);
    CHECK_MESSAGE(!contains(result.err, text), result.err);
  }
}

}  // namespace ngs
