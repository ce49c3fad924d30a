#include "objects_page.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "ngs/io/image/image_file.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/image/photo.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/scene/view_names.h"
#include "shared/page/html.h"
#include "shared/page/mask_sheet.h"

namespace ngs::ngs_tool {
namespace {

constexpr int kCard_px = 320, kRoom_px = 800;
constexpr std::size_t kRooms = 3;

/// A colour per id; consecutive ids have clearly different hues.
Vec3<double> colour_of(std::size_t id) {
  constexpr double kGoldenRatio = 0.6180339887498949, kTurn = 6.283185307179586;
  const double hue = kTurn * kGoldenRatio * double(id);
  const auto channel = [&](double shift) { return 0.55 + 0.4 * std::cos(hue + shift); };
  return {channel(0), channel(kTurn / 3), channel(2 * kTurn / 3)};
}

std::string css_colour(std::size_t id) {
  const Vec3<double> c = colour_of(id);
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", unsigned(255 * c.x), unsigned(255 * c.y), unsigned(255 * c.z));
  return text;
}

ImageF photo_of(const Scene& scene, std::size_t view) {
  ImageF photo = io::load_photo(scene, view);
  const Camera& camera = scene.views[view].camera;
  return photo.empty() ? ImageF(camera.width_px, camera.height_px, 3, 0.7f) : photo;
}

ImageF at_most(const ImageF& picture, int width_px) {
  if (picture.width_px <= width_px) return picture;
  const double scale = double(width_px) / picture.width_px;
  return io::resize_area(picture, width_px, std::max(1, int(std::lround(scale * picture.height_px))));
}

std::string room_figure(const Scene& scene, std::size_t view, const ImageU16& ids) {
  ImageF picture = photo_of(scene, view);
  constexpr float kTint = 0.6f;
  for (std::size_t p = 0; p < ids.data.size(); ++p) {
    const Vec3<double> c = colour_of(ids.data[p]);
    const double tint[3] = {c.x, c.y, c.z};
    for (std::size_t k = 0; k < 3 && ids.data[p] != 0; ++k) {
      float& value = picture.data[3 * p + k];
      value += kTint * (float(tint[k]) - value);
    }
  }
  const ImageU8 small = to_bytes(at_most(picture, kRoom_px));
  const std::string& name = scene.views[view].camera.name;
  return "<figure>" + cli::outlined_picture(small, {}, {0, 0, small.width_px, small.height_px}, "Objects in " + name) +
         "<figcaption>" + cli::escaped(name) + "</figcaption></figure>\n";
}

struct Place {
  std::size_t view = 0;
  std::int64_t pixels = 0;
};

ForegroundBox box_of(const ImageU16& ids, std::uint16_t id) {
  ForegroundBox box;
  for (int y = 0; y < ids.height_px; ++y)
    for (int x = 0; x < ids.width_px; ++x)
      if (ids.at(x, y) == id) box.add(x, y);
  return box;
}

std::string picture_of(const ImageF& photo, const std::string& view, const ImageU16& ids, std::uint16_t id) {
  const ForegroundBox box = box_of(ids, id);
  const int margin = 8 + (box.x1 - box.x0 + box.y1 - box.y0) / 8;
  const PixelWindow win = window_about(box, margin, ids.width_px, ids.height_px);
  ImageF crop(win.w, win.h, 3);
  crop.data = cropped(photo.data, ids.width_px, 3, win);
  std::vector<std::uint8_t> mask;
  for (const std::uint16_t value : cropped(ids.data, ids.width_px, 1, win)) mask.push_back(value == id);
  return cli::outlined_picture(to_bytes(at_most(crop, kCard_px)),
                               {{"given", {mask.data(), win.w, win.h}, css_colour(id)}}, {0, 0, win.w, win.h},
                               "Object " + std::to_string(id) + " in " + view);
}

std::string caption_of(const Json& object) {
  std::string text = "<b>" + cli::escaped(object.at("name").get<std::string>()) + "</b> " +
                     cli::with_separators(object.at("gaussians")) + " Gaussians, " +
                     std::to_string(object.at("views").size()) + " views, confidence " +
                     cli::decimal(object.at("confidence"), 2);
  if (object.contains("part_of"))
    text += ", <em>part of " + cli::escaped(object.at("part_of").get<std::string>()) + " in " +
            cli::decimal(100 * object.at("part_share").get<double>(), 0) + "\u202f% of the views</em>";
  return text;
}

std::string doubtful_table(const Json& doubtful) {
  cli::Table table{"", {"Gaussians", "Views", "Confidence"}, {}};
  for (const Json& object : doubtful)
    table.rows.push_back({cli::with_separators(object.at("gaussians")), std::to_string(object.at("views").size()),
                          cli::decimal(object.at("confidence"), 2)});
  return table.html();
}

}  // namespace

std::string objects_page(const Scene& scene, const Json& objects, const std::string& masks) {
  const std::vector<std::string> names = output_names(scene.views);
  const auto ids_of = [&](std::size_t view) {
    const std::string path = masks + "/" + names[view] + ".png";
    return std::filesystem::exists(path) ? io::read_label_map(path, scene.views[view].camera, scene.image_scale)
                                         : ImageU16();
  };
  std::map<std::uint16_t, Place> best;
  std::map<std::uint16_t, std::string> picture;
  std::string rooms;
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    const ImageU16 ids = ids_of(v);
    std::map<std::uint16_t, std::int64_t> count;
    for (const std::uint16_t id : ids.data) ++count[id];
    for (const auto& [id, pixels] : count)
      if (pixels > best[id].pixels) best[id] = {v, pixels};
    const std::size_t step = std::max<std::size_t>(1, scene.views.size() / kRooms);
    if (!ids.empty() && v % step == 0 && v / step < kRooms) rooms += room_figure(scene, v, ids);
  }
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    if (std::ranges::none_of(best, [&](const auto& of) { return of.first > 0 && of.second.view == v; })) continue;
    const ImageU16 ids = ids_of(v);
    const ImageF photo = photo_of(scene, v);
    for (const auto& [id, place] : best)
      if (id > 0 && place.view == v) picture[id] = picture_of(photo, scene.views[v].camera.name, ids, id);
  }
  std::vector<Json> ordered = objects.at("objects");
  std::ranges::stable_sort(ordered, {}, [](const Json& o) { return o.at("confidence").get<double>(); });
  std::string cards;
  for (const Json& object : ordered) {
    const auto id = object.at("id").get<std::uint16_t>();
    cards += "<figure>" + picture[id] + "<figcaption>" + caption_of(object) + "</figcaption></figure>\n";
  }
  const std::string known = cli::scene_title(scene), title = known.empty() ? "Scene" : known;
  const Json& doubtful = objects.at("doubtful");
  return cli::page_start(title + " – objects", title,
                         std::to_string(ordered.size()) + " objects. Cards: least certain first.") +
         "<div class=\"sheet wide\">" + rooms + "</div>" +
         cli::section("objects", "Objects", "<div class=\"sheet small\">" + cards + "</div>") +
         (doubtful.empty() ? ""
                           : cli::section("doubtful", "Not cut out: too small, seen too rarely, or uncertain",
                                          doubtful_table(doubtful))) +
         cli::page_end();
}

}  // namespace ngs::ngs_tool
