#include "ngs/io/image/mask_names.h"

#include <doctest/doctest.h>

#include "ngs/core/error.h"
#include "support/camera_files.h"
#include "support/error_code.h"
#include "support/temp_dir.h"

namespace ngs::io {
namespace {

using test::TempDir;
using test::views_named;

}  // namespace

TEST_CASE("every naming rule finds its mask and is reported") {
  const struct {
    const char *view, *file, *rule;
  } cases[] = {{"a.jpg", "a.jpg.png", "<name>.png"},
               {"a.png", "a.png", "<name>"},
               {"a.jpg", "a.png", "<stem>.png"},
               {"a.jpg", "a.mask.png", "<stem>.mask.png"},
               {"a.jpg", "a.jpg.mask.png", "<name>.mask.png"},
               {"a.jpg", "a_mask.png", "<stem>_mask.png"},
               {"a.jpg", "a-mask.png", "<stem>-mask.png"},
               {"a.jpg", "mask_a.png", "mask_<stem>.png"},
               {"a.png", "a.jpg.png", "<stem>.jpg.png"},
               {"a.png", "a.jpeg.png", "<stem>.jpeg.png"},
               {"a.HEIC", "a.png", "<stem>.png"},
               {"a.jpg", "a.jpg.PNG", "<name>.png"},
               {"a.jpg", "a.exr", "<stem>.exr"},
               {"a.jpg", "a.JPEG", "<stem>.JPEG"},
               {"cam/a.jpg", "cam/a.png", "<stem>.png"},
               {"cam/a.jpg", "a.jpg.png", "<name>.png"},
               {"cam/a.jpg", "a.tif", "<stem>.tif"},
               {"frame.0001", "frame.0001.png", "<name>.png"},
               {"cam/a.jpg", "cam_a.png", "<folder>_<stem>.png"},
               {"a.jpg", "cup/a.png", "<object>/<stem>.png"},
               {"a.jpg", "masks/a.png", "<stem>.png"}};  // as of an archive that was unpacked in masks/
  for (const auto& c : cases) {
    CAPTURE(c.file);
    const TempDir dir;
    dir.write(c.file, "x");
    std::vector<SceneView> views = views_named({c.view, "other.png"});
    const MaskMatches matches = match_masks(dir.path(), {}, views);
    CHECK(matches.views_by_rule == std::map<std::string, int>{{c.rule, 1}});
    CHECK(matches.unmatched == std::vector<std::string>{"other.png"});
  }
}

TEST_CASE("a second mask of a view is counted, and both files are reported") {
  const TempDir dir;
  for (const char* file : {"a.jpg", "a.png", "b.png", "c.jpg", "c_mask.png", "d.png", "d.exr"}) dir.write(file, "x");
  std::vector<SceneView> views = views_named({"a.jpg", "b.png", "c.jpg", "d.jpg"});
  const MaskMatches matches = match_masks(dir.path(), {}, views);
  CHECK(matches.several == 2);
  CHECK(matches.taken == dir.path() + "/a.jpg");
  CHECK(matches.not_taken == dir.path() + "/a.png");
  CHECK(views[2].mask_path == dir.path() + "/c.jpg");
}

TEST_CASE("masks in the photo folder are distinguished from photos, and images of no view are counted") {
  const TempDir dir;
  for (const char* file : {"a.jpg", "a.jpg.mask.png", "b.jpg", "b_mask.png", "c.png", "sub/b.png"})
    dir.write(file, "x");
  std::vector<SceneView> views = views_named({"a.jpg", "b.jpg"});
  for (SceneView& view : views) view.image_path = dir.path() + "/" + view.camera.name;
  CHECK(photo_folder_holds_masks(dir.path(), views));
  const MaskMatches matches = match_masks(dir.path(), {}, views);
  CHECK(views[0].mask_path == dir.path() + "/a.jpg.mask.png");
  CHECK(views[1].mask_path == dir.path() + "/b_mask.png");
  CHECK(matches.several == 0);
  CHECK(matches.of_no_view == std::vector<std::string>{dir.path() + "/c.png", dir.path() + "/sub/b.png"});
  CHECK_FALSE(photo_folder_holds_masks(dir.path(), views_named({"c.png"})));
}

TEST_CASE("rig files are matched by folder; a file that matches two views is rejected") {
  const TempDir dir;
  const std::vector<std::string> names = {"cam0/0.jpg", "cam0/1.jpg", "cam1/0.jpg", "cam1/1.jpg"};
  for (const char* file : {"cam0/0.png", "cam1/0.png", "1.png"}) dir.write(file, "x");
  std::vector<SceneView> views = views_named(names);
  test::refused([&] { match_masks(dir.path(), {}, views); }, ErrorCode::kInconsistent,
                "1.png: matches both views cam0/1.jpg and cam1/1.jpg", "/cam1/1.png");
  dir.write("cam0/1.png", "x");  // then the file without a folder matches only the other view
  views = views_named(names);
  CHECK(match_masks(dir.path(), {}, views).unmatched.empty());
  for (std::size_t v = 0; v < 3; ++v)
    CHECK(views[v].mask_path == dir.path() + "/" + names[v].substr(0, names[v].size() - 3) + "png");
  CHECK(views[3].mask_path == dir.path() + "/1.png");
}

TEST_CASE("a file that matches a view's full name is not used for another view") {
  const TempDir dir;
  dir.write("0.png", "x");
  std::vector<SceneView> views = views_named({"0.png", "cam/0.png"});
  CHECK(match_masks(dir.path(), {}, views).unmatched == std::vector<std::string>{"cam/0.png"});
}

TEST_CASE("a mask in another case or Unicode form matches if it is the only one, and exact names come first") {
  const TempDir dir;
  dir.write("img_1.PNG", "x");
  dir.write("u\xcc\x88.png", "x");
  dir.write("a.png", "x");
  dir.write("A.png", "x");
  std::vector<SceneView> views = views_named({"IMG_1.jpg", "\xc3\x9c.jpg", "a.jpg", "A.jpg"});
  CHECK(match_masks(dir.path(), {}, views).unmatched.empty());
  CHECK(views[2].mask_path == dir.path() + "/a.png");
  CHECK(views[3].mask_path == dir.path() + "/A.png");
  std::vector<SceneView> ambiguous = views_named({"b.jpg"});
  dir.write("B.png", "x");
  dir.write("B.PNG", "x");
  CHECK(match_masks(dir.path(), {}, ambiguous).unmatched == std::vector<std::string>{"b.jpg"});
}

TEST_CASE("of views with one stem the mask belongs to the one whose whole name it repeats, else it is an error") {
  const TempDir dir;
  dir.write("0.png", "x");
  std::vector<SceneView> views = views_named({"0.jpg", "0.png"});
  CHECK(match_masks(dir.path(), {}, views).unmatched == std::vector<std::string>{"0.jpg"});
  views = views_named({"0.jpg", "0.tif"});
  CHECK_THROWS_AS(match_masks(dir.path(), {}, views), Error);
  dir.write("0.jpg.png", "x");
  dir.write("0.tif.png", "x");
  CHECK(match_masks(dir.path(), {}, views).unmatched.empty());
}

TEST_CASE("a stem in several formats does not match, and neither do prefixes") {
  const TempDir dir;
  dir.write("a.tif", "x");
  dir.write("a.exr", "x");
  dir.write("ab.png", "x");
  std::vector<SceneView> views = views_named({"a.jpg"});
  CHECK(match_masks(dir.path(), {}, views).views_by_rule.empty());
}

TEST_CASE(
    "what all masks have around the stems of their views is found, and of several masks of a view none is taken") {
  const auto matched = [](const std::vector<std::string>& files, const std::vector<std::string>& views) {
    const TempDir dir;
    for (const std::string& file : files) dir.write(file, "x");
    std::vector<SceneView> named = views_named(views);
    return match_masks(dir.path(), {}, named).views_by_rule;
  };
  using Rules = std::map<std::string, int>;
  CHECK(matched({"seg_a_0.png", "seg_b_0.png"}, {"a.jpg", "b.jpg", "c.jpg"}) == Rules{{"seg_<stem>_0", 2}});
  CHECK(matched({"1.png", "02.png", "10.png"}, {"0001.jpg", "0002.jpg", "0010.jpg"}) == Rules{{"<stem>", 3}});
  CHECK(matched({"frame_00001.png", "frame_00002.png"}, {"1.jpg", "2.jpg", "12.jpg"}) == Rules{{"frame_<stem>", 2}});
  CHECK(matched({"a_0.png", "a_1.png", "b_0.png", "b_1.png"}, {"a.jpg", "b.jpg"}).empty());
  CHECK(matched({"00001.png", "00002.png"}, {"v1.jpg", "v2.jpg"}).empty());
  CHECK(matched({"a_seg.png", "b_mask2.png"}, {"a.jpg", "b.jpg"}).empty());
}

TEST_CASE("a mask path in the source takes precedence over the folder") {
  const TempDir dir;
  dir.write("a.png", "x");
  std::vector<SceneView> views = views_named({"a.png"});
  views[0].mask_path = "/own/mask.png";
  CHECK(match_masks(dir.path(), {}, views).views_by_rule.at("mask_path of the source") == 1);
  CHECK(views[0].mask_path == "/own/mask.png");
}

TEST_CASE("all sub-folders become objects, or only the named ones") {
  const TempDir dir;
  for (const char* file : {"cup/a.png", "spoon/a.png", "spoon/b.png", "empty/z.png"}) dir.write(file, "x");
  std::vector<SceneView> views = views_named({"a.jpg", "b.jpg"});
  dir.write(".checkpoints/z.png", "x");
  const MaskMatches matches = match_masks(dir.path(), {}, views);
  CHECK(matches.objects == std::vector<std::string>{"cup", "spoon"});
  CHECK(matches.of_no_view == std::vector<std::string>{dir.path() + "/empty/z.png"});
  CHECK(views[0].mask_path == dir.path() + "/{object}/a.png");
  CHECK(views[1].mask_path == dir.path() + "/{object}/b.png");
  views = views_named({"a.jpg", "b.jpg"});
  const MaskMatches named = match_masks(dir.path(), {"cup"}, views);
  CHECK(named.unmatched == std::vector<std::string>{"b.jpg"});
  CHECK(named.of_no_view.empty());
}

TEST_CASE("masks of a view with different file names per object are rejected") {
  const TempDir dir;
  for (const char* file : {"cup/a.png", "cup/b.png", "spoon/a.png", "spoon/b_mask.png"}) dir.write(file, "x");
  std::vector<SceneView> views = views_named({"a.jpg", "b.jpg"});
  CHECK_THROWS_WITH_AS(match_masks(dir.path(), {}, views), doctest::Contains("spoon/b_mask.png: another object has "),
                       Error);
  views = views_named({"a.jpg", "b.jpg"});
  CHECK(match_masks(dir.path(), {"spoon"}, views).unmatched.empty());
}

TEST_CASE("masks are paired in the order of their numbers, and moved by a shift with the masks of no view") {
  const TempDir dir;
  for (const char* file : {"m2.png", "m10.png", "m0.png"}) dir.write(file, "x");
  std::vector<SceneView> views = views_named({"1.jpg", "10.jpg", "9.jpg"});
  CHECK(pair_masks_in_order(dir.path(), views).views_by_rule.at("in order") == 3);
  CHECK(views[0].mask_path == dir.path() + "/m0.png");
  CHECK(views[2].mask_path == dir.path() + "/m2.png");
  CHECK(views[1].mask_path == dir.path() + "/m10.png");
  views.pop_back();
  CHECK_THROWS_AS(pair_masks_in_order(dir.path(), views), Error);

  const TempDir late;  // numbered from 1, photos from 0
  for (const char* file : {"0001.png", "0002.png", "0003.png"}) late.write(file, "x");
  views = views_named({"0000.png", "0001.png", "0002.png"});
  MaskMatches matches = match_masks(late.path(), {}, views);
  shift_masks(1, views, matches);
  for (int v = 0; v < 3; ++v)
    CHECK(views[std::size_t(v)].mask_path == late.path() + "/000" + std::to_string(v + 1) + ".png");
  CHECK(matches.unmatched.empty());
  CHECK(matches.of_no_view.empty());
  shift_masks(2, views, matches);
  CHECK(matches.unmatched == std::vector<std::string>{"0001.png", "0002.png"});
}

}  // namespace ngs::io
