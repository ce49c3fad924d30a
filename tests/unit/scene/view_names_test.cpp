#include "ngs/scene/view_names.h"

#include <doctest/doctest.h>

#include "ngs/core/error.h"

namespace ngs {
namespace {

using Names = std::vector<std::string>;

std::vector<SceneView> views_of(const Names& names) {
  std::vector<SceneView> views(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) views[i].camera.name = names[i];
  return views;
}

TEST_CASE("image_stem removes an image extension but no other dot") {
  const struct {
    const char *name, *stem;
  } cases[] = {{"a.png", "a"},
               {"a.b.JPEG", "a.b"},
               {"frame.0001", "frame.0001"},
               {"cam.0/a", "cam.0/a"},
               {"cam/IMG_1.5.tif", "cam/IMG_1.5"},
               {".png", ".png"},
               {"cam/.png", "cam/.png"},
               {"a.webp", "a"},
               {"", ""}};
  for (const auto& c : cases) {
    CAPTURE(c.name);
    CHECK(image_stem(c.name) == c.stem);
    CHECK(has_image_extension(c.name) == (std::string(c.name) != c.stem));
  }
  CHECK(bare_name("cam/a.png") == "a.png");
  CHECK(bare_name("a.png") == "a.png");
}

TEST_CASE("output_names uses the stem if it is unique, else the path, else the whole name") {
  CHECK(output_names(views_of({"a/0.png", "b/1.jpg", "frame.0001", "frame.0002"})) ==
        Names{"0", "1", "frame.0001", "frame.0002"});
  CHECK(output_names(views_of({"cam0/0.png", "cam0/1.png", "cam1/0.png"})) == Names{"cam0/0", "cam0/1", "cam1/0"});
  CHECK(output_names(views_of({"a.jpg", "a.png", "b.png"})) == Names{"a.jpg", "a.png", "b.png"});
  CHECK(output_names({}).empty());
}

TEST_CASE("a view is found by exact name, by path with any extension, or by output name") {
  using Indices = std::vector<std::size_t>;
  const ViewNames rig(views_of({"cam0/0.png", "cam0/1.png", "cam1/0.png"}));
  CHECK(rig.find("cam1/0.png") == Indices{2});
  CHECK(rig.find("cam1/0") == Indices{2});
  CHECK(rig.find("cam1/0.jpg") == Indices{2});
  CHECK(rig.find("0").empty());
  CHECK(ViewNames(views_of({"images/0.png", "images/1.png"})).find("1") == Indices{1});
  CHECK(ViewNames(views_of({"a.jpg", "a.png"})).find("a") == Indices{0, 1});
  CHECK(ViewNames(views_of({"a.jpg", "a.png"})).find("a.png") == Indices{1});
}

TEST_CASE("a view is found in another case or Unicode form if no name is nearer and only one fits") {
  std::vector<SceneView> views(3);
  views[0].camera.name = "IMG_1.JPG";
  views[1].camera.name = "u\xcc\x88.png";
  views[2].camera.name = "img_2.png";
  const ViewNames names(views);
  CHECK(names.find("img_1.png") == std::vector<std::size_t>{0});
  CHECK(names.find("\xc3\xbc.jpg") == std::vector<std::size_t>{1});
  CHECK(names.find("IMG_2") == std::vector<std::size_t>{2});
  CHECK(names.find("img_3").empty());
}

TEST_CASE("parse_every accepts every:N:K with K < N only, which selects indices K modulo N") {
  const auto every = parse_every("every:4:2");
  REQUIRE(every);
  for (std::size_t i = 0; i < 9; ++i) CHECK(every->selects(i) == (i == 2 || i == 6));
  for (const char* rule : {"every:", "every:0:0", "every:4:4", "every:4", "every:4:2:1", "every:4:-2", "every:4:2 ",
                           "Every:4:2", "every::", "all", ""}) {
    CAPTURE(rule);
    CHECK_FALSE(parse_every(rule));
  }
}

TEST_CASE("every:N:K selects by index; other rules are rejected") {
  CHECK(select_every("every:4:2", 11) == std::vector<std::size_t>{2, 6, 10});
  CHECK(select_every("all", 3) == std::vector<std::size_t>{0, 1, 2});
  CHECK(select_every("every:4:2", 0).empty());
  for (const char* rule : {"every:4:4", "every:0:0", "every:4", "every::", "every:a:1", "every:4:-1", "some", ""}) {
    CAPTURE(rule);
    CHECK_THROWS_AS(select_every(rule, 5), Error);
  }
}

}  // namespace
}  // namespace ngs
