#include "ngs/io/image/annotations.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "ngs/core/error.h"
#include "ngs/core/folded_name.h"
#include "ngs/io/capture/pose.h"
#include "ngs/io/files/json_file.h"
#include "ngs/scene/view_names.h"

namespace ngs::io {
namespace {

using nlohmann::json;

struct Point {
  double x = 0, y = 0;
};
using Polygon = std::vector<Point>;

bool is_labelme(const json& root) { return root.is_object() && root.contains("shapes"); }
bool is_coco(const json& root) { return root.is_object() && root.contains("images") && root.contains("annotations"); }

ImageF empty_plane(const JsonReader& of, const char* width, const char* height) {
  return {int(of.integer(width, 1, kMaxSide)), int(of.integer(height, 1, kMaxSide)), 1};
}

/// Sets the pixels whose centres are inside, by the even-odd rule.
void fill_polygon(const Polygon& polygon, ImageF& plane) {
  for (int y = 0; y < plane.height_px; ++y) {
    std::vector<double> crossings;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double at = y + 0.5;
      if ((a.y <= at) != (b.y <= at)) crossings.push_back(a.x + (at - a.y) / (b.y - a.y) * (b.x - a.x));
    }
    std::ranges::sort(crossings);
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      const double last = std::min(crossings[i + 1] - 0.5, plane.width_px - 1.0);
      for (double x = std::max(0.0, std::ceil(crossings[i] - 0.5)); x <= last; ++x) plane.at(int(x), y) = 1;
    }
  }
}

/// From x, y, x, y, ...
Polygon polygon_of(const json& flat, const std::string& where) {
  Polygon polygon;
  const std::vector<double> xy = JsonReader(json{{"polygon", flat}}, where).matrix("polygon", flat.size(), 0);
  for (std::size_t i = 0; i + 1 < xy.size(); i += 2) polygon.push_back({xy[i], xy[i + 1]});
  return polygon;
}

/// Run lengths of COCO in text: 5 bits a character with a sign, relative to the run before the last one.
std::vector<std::int64_t> unpacked_runs(const std::string& text, const JsonReader& of) {
  constexpr int kFirst = 48, kBits = 5, kMore = 32, kSign = 16, kMaxShift = 35;
  std::vector<std::int64_t> runs;
  std::int64_t run = 0;
  int shift = 0;
  for (const char c : text) {
    const int code = int(static_cast<unsigned char>(c)) - kFirst;
    if (code < 0 || code >= 2 * kMore || shift > kMaxShift) of.fail("counts", "run lengths of COCO");
    run |= std::int64_t(code % kMore) << shift;
    shift += kBits;
    if (code >= kMore) continue;
    if (code & kSign) run -= std::int64_t(1) << shift;
    runs.push_back(runs.size() > 2 ? run + runs[runs.size() - 2] : run);
    run = shift = 0;
  }
  return runs;
}

constexpr const char* kRuns = "run lengths of the image's pixels in all";

/// Column by column, background first.
void fill_runs(const JsonReader& of, ImageF& plane) {
  const std::vector<double> size = of.matrix("size", 2, 0);
  if (size[0] != plane.height_px || size[1] != plane.width_px) of.fail("size", "height and width of the image");
  std::vector<std::int64_t> runs;
  if (of.at("counts").is_string())
    runs = unpacked_runs(of.text("counts"), of);
  else
    for (const double run : of.matrix("counts", of.array("counts").size(), 0)) {
      if (!(run >= 0 && run <= double(plane.pixels())) || run != std::floor(run)) of.fail("counts", kRuns);
      runs.push_back(std::int64_t(run));
    }
  std::int64_t at = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i] < 0 || runs[i] > plane.pixels() - at) of.fail("counts", kRuns);
    for (const std::int64_t end = at + runs[i]; at < end; ++at)
      if (i % 2 == 1) plane.at(int(at / plane.height_px), int(at % plane.height_px)) = 1;
  }
}

void fill_shape(const JsonReader& shape, ImageF& plane) {
  const std::string type = shape.text_or("shape_type", "polygon");
  const std::size_t count = shape.array("points").size();
  if (type == "point" || type == "line" || type == "linestrip") return;
  const std::vector<double> xy = shape.matrix("points", count, 2);
  Polygon polygon;
  for (std::size_t i = 0; i < count; ++i) polygon.push_back({xy[2 * i], xy[2 * i + 1]});
  if (type == "rectangle" && count == 2) {
    polygon = {polygon[0], {polygon[1].x, polygon[0].y}, polygon[1], {polygon[0].x, polygon[1].y}};
  } else if (type == "circle" && count == 2) {
    constexpr int kCorners = 128;
    const Point centre = polygon[0], rim = polygon[1];
    polygon.clear();
    for (int i = 0; i < kCorners; ++i) {
      const double turn = 2 * 3.14159265358979323846 * i / kCorners;
      const double dx = rim.x - centre.x, dy = rim.y - centre.y;
      polygon.push_back(
          {centre.x + dx * std::cos(turn) - dy * std::sin(turn), centre.y + dx * std::sin(turn) + dy * std::cos(turn)});
    }
  } else if (type != "polygon" && type != "rectangle") {
    shape.fail("shape_type", "polygon, rectangle or circle");
  }
  fill_polygon(polygon, plane);
}

void fill_annotation(const JsonReader& annotation, ImageF& plane) {
  const json& shape = annotation.at("segmentation");
  if (shape.is_object()) return fill_runs(annotation.object("segmentation"), plane);
  for (const json& flat : annotation.array("segmentation")) fill_polygon(polygon_of(flat, annotation.where()), plane);
}

/// 0: another photo; more: the same one by its stem without folders, by its stem, by its name.
int match_of(const std::string& file, const std::string& view) {
  if (file == view) return 3;
  if (folded_name(image_stem(file)) == folded_name(image_stem(view))) return 2;
  return folded_name(image_stem(bare_name(file))) == folded_name(image_stem(bare_name(view))) ? 1 : 0;
}

/// The entry of "images" that is this view's photo; null: none, or several.
const json* image_of(const json& root, const std::string& path, const std::string& view) {
  const json* found = nullptr;
  int best = 0;
  for (const json& image : JsonReader(root, path).array("images")) {
    const int match = match_of(JsonReader(image, path + ": images").text("file_name"), view);
    if (match == 0 || match < best) continue;
    found = match == best ? nullptr : &image;
    best = match;
  }
  return found;
}

/// Names of categories by id; ids without a name are their own names.
std::string category_of(const json& root, const JsonReader& annotation) {
  const json& id = annotation.at("category_id");
  if (root.contains("categories"))
    for (const json& category : root.at("categories"))
      if (category.is_object() && category.value("id", json()) == id) return category.value("name", id.dump());
  return id.dump();
}

/// f(label, shape) for every shape of the photo.
template <class F>
void for_each_shape(const json& root, const std::string& path, const std::string& view, const F& f) {
  if (is_labelme(root)) {
    for (const json& entry : JsonReader(root, path).array("shapes")) {
      const JsonReader shape(entry, path + ": shapes");
      f(shape.text("label"), shape);
    }
    return;
  }
  const json* image = image_of(root, path, view);
  if (image == nullptr) return;
  const json id = image->value("id", json());
  for (const json& entry : JsonReader(root, path).array("annotations")) {
    const JsonReader annotation(entry, path + ": annotations");
    if (annotation.at("image_id") == id) f(category_of(root, annotation), annotation);
  }
}

ImageF plane_of(const json& root, const std::string& path, const std::string& view) {
  if (is_labelme(root)) return empty_plane(JsonReader(root, path), "imageWidth", "imageHeight");
  const json* image = image_of(root, path, view);
  if (image == nullptr)
    throw Error(ErrorCode::kInconsistent, path + ": no image " + view + ", expected it among \"images\"",
                "import the scene again");
  return empty_plane(JsonReader(*image, path + ": images"), "width", "height");
}

bool annotates(const json& root, const std::string& path, const std::string& view) {
  if (is_coco(root)) return image_of(root, path, view) != nullptr;
  const std::string stem = folded_name(image_stem(path.substr(0, path.rfind('.'))));
  return stem.ends_with("/" + folded_name(image_stem(view)));
}

}  // namespace

bool is_annotations(const std::string& path) {
  return lower_case(std::filesystem::path(path).extension().string()) == ".json";
}

AnnotationMatches match_annotations(const std::vector<std::string>& files, std::vector<SceneView>& views) {
  AnnotationMatches matches;
  std::set<std::string> labels;
  for (const std::string& path : files) {
    const json root = read_json_file(path);
    if (!is_labelme(root) && !is_coco(root)) continue;
    for (SceneView& view : views) {
      const std::string& name = view.camera.name;
      if (!view.mask_path.empty() || !annotates(root, path, name)) continue;
      view.mask_path = path;
      ++matches.views;
      for_each_shape(root, path, name, [&](const std::string& label, const JsonReader&) { labels.insert(label); });
    }
  }
  matches.labels.assign(labels.begin(), labels.end());
  return matches;
}

std::vector<ImageF> read_annotations(const std::string& path, const std::string& view,
                                     const std::vector<SceneObject>& objects) {
  const json root = read_json_file(path);
  std::vector<ImageF> planes(objects.size(), plane_of(root, path, view));
  for_each_shape(root, path, view, [&](const std::string& label, const JsonReader& shape) {
    for (std::size_t k = 0; k < objects.size(); ++k)
      if (objects[k].name == label) is_labelme(root) ? fill_shape(shape, planes[k]) : fill_annotation(shape, planes[k]);
  });
  return planes;
}

ImageU16 read_id_map(const std::string& path, const std::string& view) {
  const json root = read_json_file(path);
  const ImageF blank = plane_of(root, path, view);
  std::vector<std::vector<std::uint32_t>> masks;  // the pixels of each
  for_each_shape(root, path, view, [&](const std::string&, const JsonReader& shape) {
    ImageF plane = blank;
    is_labelme(root) ? fill_shape(shape, plane) : fill_annotation(shape, plane);
    masks.emplace_back();
    for (std::size_t p = 0; p < plane.data.size(); ++p)
      if (plane.data[p] > 0) masks.back().push_back(std::uint32_t(p));
    if (masks.back().empty()) masks.pop_back();
  });
  if (masks.size() > 0xffff)
    throw Error(ErrorCode::kBadInput,
                path + ": " + std::to_string(masks.size()) + " masks of " + view + ", expected at most 65535");
  std::ranges::stable_sort(masks, std::greater<>{}, &std::vector<std::uint32_t>::size);
  ImageU16 ids(blank.width_px, blank.height_px, 1);
  for (std::size_t k = 0; k < masks.size(); ++k)
    for (const std::uint32_t p : masks[k]) ids.data[p] = std::uint16_t(k + 1);
  return ids;
}

}  // namespace ngs::io
