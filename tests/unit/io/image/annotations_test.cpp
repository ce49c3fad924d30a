#include "ngs/io/image/annotations.h"

#include <doctest/doctest.h>

#include "ngs/io/files/atomic_file.h"
#include "support/camera_files.h"
#include "support/error_code.h"
#include "support/temp_dir.h"

namespace ngs::io {
namespace {

using test::views_named;

std::vector<float> pixels(const std::string& path, const std::string& view, const std::string& object) {
  return read_annotations(path, view, {{object, 0}})[0].data;
}

/// COCO for a.png of 3 x 2 pixels.
std::string coco(const std::string& segmentation) {
  return R"({"images": [{"id": 7, "file_name": "photos/a.jpg", "width": 3, "height": 2}], "categories": [{"id": 1,
    "name": "cup"}, {"id": 2, "name": "plate"}], "annotations": [{"image_id": 7, "category_id": 1, "segmentation": )" +
         segmentation + "}]}";
}

}  // namespace

TEST_CASE("polygons, plain and packed run lengths of COCO give the same mask") {
  const test::TempDir dir;
  const std::string path = dir.path() + "/all.json";
  const std::vector<float> right{0, 1, 0, 0, 1, 0};
  // Packed: each run plus 48, all below 16, as the fourth run would be relative to the second.
  for (const char* shape : {"[[1, 0, 2, 0, 2, 2, 1, 2]]", R"({"size": [2, 3], "counts": [2, 2, 2]})",
                            R"({"size": [2, 3], "counts": "222"})"}) {
    CAPTURE(shape);
    write_file(path, coco(shape));
    std::vector<SceneView> views = views_named({"a.png", "b.png"});
    const AnnotationMatches found = match_annotations({path}, views);
    CHECK(found.views == 1);
    CHECK(found.labels == std::vector<std::string>{"cup"});
    CHECK(views[0].mask_path == path);
    CHECK(views[1].mask_path.empty());
    CHECK(pixels(path, "a.png", "cup") == right);
    CHECK(pixels(path, "a.png", "plate") == std::vector<float>(6));
  }
  for (const char* broken : {R"({"size": [2, 3], "counts": [2, 5]})", R"({"size": [2, 3], "counts": [-1]})",
                             R"({"size": [9, 3], "counts": [2]})", R"({"size": [2, 3], "counts": "2 2"})", "3",
                             R"({"size": [2, 3], "counts": "22Poooooooooooooooooooo2"})",  // a run of 100 bits
                             R"({"size": [2, 3], "counts": [9223372036854775807, 9223372036854775807, 8]})",
                             R"({"size": [2, 3], "counts": [2.5, 3.5]})"}) {
    CAPTURE(broken);
    write_file(path, coco(broken));
    CHECK(test::code_of([&] { pixels(path, "a.png", "cup"); }) == ErrorCode::kBadInput);
  }
}

TEST_CASE("an id map has all masks of a view whatever their categories, smaller ones over larger ones") {
  const test::TempDir dir;
  const std::string path = dir.path() + "/all.json";
  write_file(path,
             R"({"images": [{"id": 7, "file_name": "a.png", "width": 3, "height": 2}, {"id": 8, "file_name": "b.png",
    "width": 3, "height": 2}], "annotations": [
    {"image_id": 7, "category_id": 1, "segmentation": {"size": [2, 3], "counts": [1, 1, 4]}},
    {"image_id": 7, "category_id": 1, "segmentation": {"size": [2, 3], "counts": [0, 4, 2]}},
    {"image_id": 8, "category_id": 1, "segmentation": {"size": [2, 3], "counts": [0, 6]}},
    {"image_id": 7, "category_id": 5, "segmentation": {"size": [2, 3], "counts": [6]}},
    {"image_id": 7, "category_id": 1, "segmentation": {"size": [2, 3], "counts": [4, 2]}}]})");
  CHECK(read_id_map(path, "a.png").data == std::vector<std::uint16_t>{1, 1, 2, 3, 1, 2});
  CHECK(read_id_map(path, "b.png").data == std::vector<std::uint16_t>(6, 1));
  CHECK(test::code_of([&] { read_id_map(path, "c.png"); }) == ErrorCode::kInconsistent);
  write_file(path, coco(R"({"size": [2, 3], "counts": [2, 5]})"));
  CHECK(test::code_of([&] { read_id_map(path, "a.png"); }) == ErrorCode::kBadInput);
}

TEST_CASE("a file of labelme belongs to the photo of its name, and its shapes are filled") {
  const test::TempDir dir;
  const std::string path = dir.path() + "/a.json";
  write_file(path, R"({"imageWidth": 4, "imageHeight": 2, "shapes": [
    {"label": "cup", "shape_type": "polygon", "points": [[0, 0], [2, 0], [2, 2], [0, 2]]},
    {"label": "cup", "shape_type": "rectangle", "points": [[3, 0], [4, 1]]},
    {"label": "plate", "shape_type": "circle", "points": [[2.5, 0.5], [2.9, 0.5]]},
    {"label": "cup", "shape_type": "point", "points": [[2, 1]]}]})");
  std::vector<SceneView> views = views_named({"b.png", "a.jpg", "aa.jpg"});
  const AnnotationMatches found = match_annotations({path}, views);
  CHECK(found.views == 1);
  CHECK(found.labels == std::vector<std::string>{"cup", "plate"});
  CHECK(views[1].mask_path == path);
  CHECK(pixels(path, "a.jpg", "cup") == std::vector<float>{1, 1, 0, 1, 1, 1, 0, 0});
  CHECK(pixels(path, "a.jpg", "plate") == std::vector<float>{0, 0, 1, 0, 0, 0, 0, 0});
  write_file(path, R"({"imageWidth": 4, "imageHeight": 2, "shapes": [{"label": "cup", "shape_type": "mask",
    "points": [[0, 0], [2, 0]]}]})");
  CHECK(test::code_of([&] { pixels(path, "a.jpg", "cup"); }) == ErrorCode::kBadInput);
}

}  // namespace ngs::io
