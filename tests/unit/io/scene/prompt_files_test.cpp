#include "ngs/io/scene/prompt_files.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/scene/painted_picture.h"
#include "support/error_code.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

HandPrompt parsed(const std::string& text) {
  const std::vector<HandPrompt> views = io::parse_prompts_json(io::parse_json(text, "p.json"), "p.json");
  REQUIRE(views.size() == 1);
  return views.front();
}

std::string refusal(const auto& body) {
  const Error e = test::thrown_by(body);
  CHECK((e.code() == ErrorCode::kBadInput || e.code() == ErrorCode::kInconsistent));
  return e.what();
}

/// All pixels have the colour `rest`, black by default, except one.
ImageU8 picture(int channels, std::vector<std::uint8_t> pixel, std::vector<std::uint8_t> rest = {0, 0, 0, 0}) {
  ImageU8 image(4, 3, channels);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x)
      for (int c = 0; c < channels; ++c) image.at(x, y, c) = (x == 1 && y == 2 ? pixel : rest)[std::size_t(c)];
  return image;
}

}  // namespace

TEST_CASE("prompts are read with their defaults; segmenter inputs among them are ignored") {
  const HandPrompt p = parsed(R"({"ngs_prompts":1,"view":"a.png","width":8,"height":6,
    "strokes":[{"object":true,"points":[[1,2],[3.5,4]]},{"object":false,"radius":1.5,"points":[[0,0]]}],
    "boxes":[[1,1,7,5]],"points":[{"object":true,"x":1,"y":1}],"mask":"m.png"})");
  CHECK(p.view == "a.png");
  REQUIRE(p.strokes.size() == 2);
  CHECK(p.strokes[0].object);
  CHECK(p.strokes[0].radius_px == 3);
  CHECK(p.strokes[0].points[1][0] == 3.5);
  CHECK_FALSE(p.strokes[1].object);
  REQUIRE(p.boxes.size() == 1);
  CHECK(p.boxes[0][2] == 7);
}

TEST_CASE("invalid prompts are rejected with the key") {
  const std::string head = R"({"ngs_prompts":1,"width":8,"height":6,)";
  const std::pair<const char*, const char*> cases[] = {
      {R"("strokes":[]})", "neither strokes nor boxes"},
      {R"("strokes":[{"object":true,"points":[]}]})", "points"},
      {R"("strokes":[{"object":1,"points":[[1,1]]}]})", "object"},
      {R"("strokes":[{"object":true,"radius":0,"points":[[1,1]]}]})", "radius"},
      {R"("strokes":[{"object":true,"points":[[1]]}]})", "points"},
      {R"("strokes":[{"object":true,"points":[[1,1]],"colour":3}]})", "colour"},
      {R"("boxes":[[5,1,5,2]]})", "boxes"},
      {R"("boxes":[[1,2,3]]})", "boxes"},
      {R"("boxes":[[1,2,3,4]],"extra":0})", "extra"},
      {R"("boxes":[[8,1,12,5]]})", "8x6 px"},
      {R"("strokes":[{"object":true,"radius":1,"points":[[-3,1],[-2,4]]}]})", "8x6 px"},
  };
  for (const auto& c : cases) {
    CAPTURE(c.first);
    CHECK(refusal([&] { parsed(head + c.first); }).find(c.second) != std::string::npos);
  }
  CHECK(parsed(head + R"("strokes":[{"object":true,"points":[[-2,1]]}]})").strokes.size() ==
        1);  // its disc reaches into the picture
  CHECK(refusal([] { parsed(R"({"ngs_prompts":2,"width":8,"height":6,"boxes":[[1,1,2,2]]})"); }) != "");
  CHECK(refusal([] { parsed(R"({"ngs_prompts":1,"width":0,"height":6,"boxes":[[1,1,2,2]]})"); }) != "");
  CHECK(refusal([] { parsed("[]"); }) != "");
}

TEST_CASE("form 2 has several views with clicks and polygons; form 1 is still read") {
  const std::vector<HandPrompt> views = io::parse_prompts_json(io::parse_json(R"({"ngs_prompts":2,"views":[
      {"view":"a.png","width":8,"height":6,"points":[{"object":true,"x":1,"y":2}],
       "polygons":[{"object":false,"points":[[4,1],[7,1],[7,5]]}]},
      {"view":"b.png","width":80,"height":60,"strokes":[{"object":true,"points":[[70,50]]}]}]})",
                                                                              "p.json"),
                                                               "p.json");
  REQUIRE(views.size() == 2);
  REQUIRE(views[0].strokes.size() == 1);
  CHECK(views[0].strokes[0].object);
  CHECK(views[0].strokes[0].points == std::vector<std::array<double, 2>>{{1, 2}});
  REQUIRE(views[0].polygons.size() == 1);
  CHECK_FALSE(views[0].polygons[0].object);
  CHECK(views[0].polygons[0].points.size() == 3);
  CHECK(views[1].view == "b.png");
  CHECK(views[1].width_px == 80);

  const std::pair<const char*, const char*> cases[] = {
      {R"([])", "at least one view"},
      {R"([{"width":8,"height":6}])", "views[0]: no strokes, points, polygons or boxes"},
      {R"([{"width":8,"height":6,"points":[{"object":true,"x":9,"y":2}]}])", "8x6 px"},
      {R"([{"width":8,"height":6,"polygons":[{"object":true,"points":[[1,1],[2,2]]}]}])", "3 to 65536"},
      {R"([{"width":8,"height":6,"polygons":[{"object":true,"points":[[1,1],[2,2],[900,3]]}]}])", "8x6 px"},
      {R"([{"width":8,"height":6,"boxes":[[1,1,2,2]],"mask":"m.png"}])", "mask"},
      {R"([{"width":8,"height":6,"boxes":[[1,1,2,2]]},7])", "views[1]"},
      {R"({"a":1})", "views"},
  };
  for (const auto& c : cases) {
    CAPTURE(c.first);
    const std::string text = std::string(R"({"ngs_prompts":2,"views":)") + c.first + "}";
    const std::string said = refusal([&] { io::parse_prompts_json(io::parse_json(text, "p.json"), "p.json"); });
    CAPTURE(said);
    CHECK(said.find(c.second) != std::string::npos);
  }
}

TEST_CASE("a point far outside the picture is rejected even if another point is inside") {
  const std::string head = R"({"ngs_prompts":1,"width":80,"height":60,"strokes":[{"object":true,"points":)";
  CHECK(parsed(head + "[[40,30],[90,30]]}]}").strokes.size() == 1);  // slightly outside is accepted
  for (const char* points : {"[[40,30],[400,300]]", "[[40,30],[40,-12]]", "[[-20,5],[40,30]]"}) {
    CAPTURE(points);
    CHECK(refusal([&] { parsed(head + points + "}]}"); }).find("80x60 px") != std::string::npos);
  }
}

TEST_CASE("green marks the object and red the background; grey pictures mark one side each") {
  const test::TempDir dir;
  const std::string file = dir.path() + "/s.png";
  const std::size_t marked = 2 * 4 + 1;
  io::write_png(file, picture(3, {20, 200, 20}));
  CHECK(io::read_painted_picture(file, "").painted[marked] == PixelHint::kObject);
  CHECK(io::read_painted_picture(file, "").painted[0] == PixelHint::kLikelyBackground);
  io::write_png(file, picture(3, {200, 20, 200}));
  CHECK(io::read_painted_picture(file, "").painted[marked] == PixelHint::kBackground);
  io::write_png(file, picture(3, {200, 200, 200}));
  CHECK(refusal([&] { io::read_painted_picture(file, ""); }).find("nothing is marked") != std::string::npos);
  io::write_png(file, picture(1, {1}));
  CHECK(refusal([&] { io::read_painted_picture(file, ""); }).find("grey") != std::string::npos);

  io::write_png(file, picture(4, {20, 200, 20, 255}, {20, 200, 20, 0}));  // green under transparency
  CHECK(io::read_painted_picture(file, "").painted[marked] == PixelHint::kObject);
  CHECK(io::read_painted_picture(file, "").painted[0] == PixelHint::kLikelyBackground);
  HandPrompt see_through;
  io::add_scribbles(file, true, see_through);
  CHECK(see_through.painted[marked] == PixelHint::kObject);
  CHECK(see_through.painted[0] == PixelHint::kLikelyBackground);

  io::write_png(file, picture(1, {1}));
  HandPrompt prompt;
  io::add_scribbles(file, true, prompt);
  CHECK(prompt.painted[marked] == PixelHint::kObject);
  io::add_scribbles(file, false, prompt);
  CHECK(prompt.painted[marked] == PixelHint::kBackground);
  io::write_png(file, ImageU8(4, 3, 1));
  CHECK(refusal([&] { io::add_scribbles(file, true, prompt); }).find("all black") != std::string::npos);
  io::write_png(file, ImageU8(5, 3, 1, 255));
  CHECK(refusal([&] { io::add_scribbles(file, true, prompt); }).find("5x3") != std::string::npos);
}

}  // namespace ngs
