// The whole chain on a capture in other units of length: a coin in metres, a town in millimetres.
#include <doctest/doctest.h>

#include "contract/captures/capture.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/ply/gaussian_ply.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using test::Capture;

constexpr double kExact[] = {0x1p-10, 0x1p10};  // positions keep their digits
constexpr double kRounded[] = {1e-3, 1e3};
constexpr int kMaxPixels = 2;  // of all masks, whose rendered value is next to the threshold

/// Number of differing bytes of all PNGs with these names in two folders.
int differing_pixels(const std::string& a, const std::string& b) {
  int count = 0, files = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(a)) {
    if (entry.path().extension() != ".png") continue;
    const io::RawMask one = io::read_mask_raw(entry.path().string(), io::Palette::kColours),
                      other = io::read_mask_raw(b + "/" + entry.path().filename().string(), io::Palette::kColours);
    REQUIRE(one.data.size() == other.data.size());
    for (std::size_t i = 0; i < one.data.size(); ++i) count += one.data[i] != other.data[i];
    ++files;
  }
  CHECK(files > 0);
  return count;
}

/// Rows of the object and labels of the model, as `ngs cut` writes them.
std::vector<float> labels_in(const std::string& out) {
  return io::read_gaussian_ply(out + "/labelled.ply").labels.label.values();
}

}  // namespace

TEST_CASE("a capture of any unit is imported without a flag, and gets the labels and masks of the original") {
  const auto cut = [](const Capture& capture, double factor) {
    CAPTURE(factor);
    if (factor != 1) capture.scale(factor);
    test::succeeded(capture.import());
    CHECK((capture.scene().value("world_unit", 1.0) < 1) == (factor < 0.1));
    CHECK(capture.scene()["compat"] == "inria");
    for (const std::vector<std::string>& argv :
         {std::vector<std::string>{"ngs-variance", "s.json", "-o", "b.ply"},
          {"ngs-joint", "s.json", "b.ply", "--quality", "draft", "-o", "labelled.ply"},
          {"ngs-render", "s.json", "labelled.ply", "--views", "all", "--layers", "mask", "-o", "m"}})
      test::succeeded(capture.run(argv));
    return labels_in(capture.dir.path());
  };
  const Capture plain;
  const std::vector<float> expected = cut(plain, 1);
  for (const bool exact : {true, false})
    for (const double factor : exact ? kExact : kRounded) {
      CAPTURE(factor);
      const Capture scaled;
      const std::vector<float> found = cut(scaled, factor);
      REQUIRE(found.size() == expected.size());
      int different = 0;
      for (std::size_t i = 0; i < found.size(); ++i) different += (found[i] >= 0.5f) != (expected[i] >= 0.5f);
      CHECK(different == 0);
      CHECK(differing_pixels(plain.dir.path() + "/m", scaled.dir.path() + "/m") <= (exact ? 0 : kMaxPixels));
    }
}

}  // namespace ngs
