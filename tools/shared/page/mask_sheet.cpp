#include "shared/page/mask_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/core/listed.h"
#include "ngs/core/version.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/image/photo.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/ops/image/outline.h"
#include "ngs/scene/mask_threshold.h"
#include "shared/page/html.h"
#include "shared/page/style.h"

namespace ngs::cli {
namespace {

constexpr float kDarkened = 0.35f, kUnknownGrey = 0.5f;
/// Colours of objects, distinguishable for most colour-blind readers; the ninth object has the first colour again.
constexpr std::array kColours = {"#ff6a2b", "#22d3ff", "#ffe14d", "#ff7ad9",
                                 "#7dff8a", "#b79bff", "#ffffff", "#ff5c5c"};

const char* colour_of(std::size_t object) { return kColours[object % kColours.size()]; }

std::string percent(double share) { return decimal(100 * share, share < 0.1 ? 1 : 0) + "\u202f%"; }

struct SmallMasks {
  int width_px = 0, height_px = 0;
  std::vector<std::vector<std::uint8_t>> objects;  // [K][H·W]
  std::vector<std::uint8_t> known;                 // [H·W]
};

SmallMasks small_masks(const ViewMasks& masks, int width_px, int height_px) {
  SmallMasks small{width_px, height_px, {}, {}};
  const auto source = [&](int x, int y) {
    const auto row = std::size_t(std::int64_t(y) * masks.height_px / height_px);
    return row * std::size_t(masks.width_px) + std::size_t(std::int64_t(x) * masks.width_px / width_px);
  };
  for (const std::vector<float>& target : masks.target) {
    small.objects.emplace_back();
    for (int y = 0; y < height_px; ++y)
      for (int x = 0; x < width_px; ++x) small.objects.back().push_back(mask_is_foreground(target[source(x, y)]));
  }
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x) small.known.push_back(masks.known.empty() || masks.known[source(x, y)] != 0);
  return small;
}

void darken_background(ImageF& photo, const SmallMasks& masks) {
  for (std::size_t p = 0; p < masks.known.size(); ++p) {
    const bool object = std::ranges::any_of(masks.objects, [&](const auto& mask) { return mask[p] != 0; });
    for (std::size_t c = 0; c < 3 && !object; ++c) {
      float& value = photo.data[3 * p + c];
      value = masks.known[p] ? kDarkened * value : kUnknownGrey + 0.15f * (value - kUnknownGrey);
    }
  }
}

std::string caption(const Scene& scene, std::size_t view, const ViewMasks& masks) {
  std::string text = "<b>" + escaped(scene.views[view].camera.name) + "</b>";
  if (scene.views[view].split == Split::kHeldOut) text += " held out";
  for (std::size_t k = 0; k < masks.target.size(); ++k) {
    const auto object = std::ranges::count_if(masks.target[k], [](float value) { return mask_is_foreground(value); });
    const double share = double(object) / double(std::max<std::size_t>(1, masks.target[k].size()));
    const bool odd = object == 0 || object == std::ssize(masks.target[k]);
    if (masks.target.size() > 1 && object == 0) continue;  // an object that is not visible in this view
    text += std::string(k == 0 || text.ends_with("held out") ? " " : ", ") + (odd ? "<em>" : "") +
            (masks.target.size() > 1 ? escaped(scene.objects[k].name) + " " : "") +
            (object == 0 ? "the mask is empty"
             : odd       ? "the whole picture"
                         : percent(share)) +
            (odd ? "</em>" : "");
  }
  return text;
}

std::string figure(const Scene& scene, std::size_t view, int width_px) {
  const ViewMasks masks = io::load_masks(scene, view);
  if (!masks.available) return {};
  const Camera& camera = scene.views[view].camera;
  const int w = std::min(width_px, camera.width_px);
  const int h = std::max(1, int(std::lround(double(camera.height_px) * w / camera.width_px)));
  ImageF photo = io::load_photo(scene, view);
  photo = photo.empty() ? ImageF(w, h, 3, 0.7f) : io::resize_area(photo, w, h);
  const SmallMasks small = small_masks(masks, w, h);
  darken_background(photo, small);
  std::vector<Outline> outlines;
  for (std::size_t k = 0; k < small.objects.size(); ++k)
    outlines.push_back({"given", {small.objects[k].data(), w, h}, colour_of(k)});
  return "<figure>" +
         outlined_picture(to_bytes(photo), outlines, {0, 0, w, h}, "View " + camera.name + " under its given mask") +
         "<figcaption>" + caption(scene, view, masks) + "</figcaption></figure>\n";
}

std::string legend(const Scene& scene) {
  std::string html = "<div class=legend>";
  for (std::size_t k = 0; k < scene.objects.size(); ++k)
    html += std::string("<span><svg aria-hidden=true viewBox=\"0 0 38 16\"><path class=casing d=\"M3 8h32\"/>") +
            "<path style=\"stroke:" + colour_of(k) + "\" d=\"M3 8h32\"/></svg>" + escaped(scene.objects[k].name) +
            "</span>";
  return html + "</div>";
}

std::string list_of(const std::vector<std::string>& names) { return escaped(listed(names, 12)); }

}  // namespace

MaskSheet mask_sheet(const Scene& scene, const MaskSheetOptions& options) {
  MaskSheet sheet;
  std::string figures;
  const double budget = options.budget_mib * 1048576.0;
  for (std::size_t view = 0; view < scene.views.size(); ++view) {
    if (scene.views[view].mask_path.empty()) {
      sheet.without.push_back(scene.views[view].camera.name);
      continue;
    }
    if (sheet.left_out > 0) {
      ++sheet.left_out;
      continue;
    }
    std::string next;
    try {
      next = figure(scene, view, options.width_px);
    } catch (const Error& e) {
      sheet.problems.push_back(e.what());
      continue;
    }
    if (next.empty())
      sheet.without.push_back(scene.views[view].camera.name);
    else if (double(figures.size() + next.size()) > budget)
      ++sheet.left_out;
    else {
      figures += next;
      ++sheet.shown;
    }
  }
  if (figures.empty() && sheet.left_out == 0) return sheet;
  sheet.html = legend(scene) + "<div class=\"sheet small\">" + figures + "</div>";
  if (sheet.left_out > 0)
    sheet.html += "<p class=note>" + with_separators(sheet.left_out) +
                  " more views with masks are not shown, to keep the page small.</p>";
  if (!sheet.without.empty())
    sheet.html += "<p class=note>" + with_separators(std::ssize(sheet.without)) + " of " +
                  with_separators(std::ssize(scene.views)) + " views have no mask: " + list_of(sheet.without) + "</p>";
  return sheet;
}

std::string mask_sheet_page(const Scene& scene, const MaskSheet& sheet) {
  std::string problems;
  for (const std::string& problem : sheet.problems) problems += "<li>" + escaped(problem) + "</li>";
  const std::string known = scene_title(scene), title = known.empty() ? "Scene" : known;
  return page_start(title + " – given masks", title,
                    "The given masks over their photos. Background is dark, unknown pixels are grey.") +
         (sheet.html.empty() ? "<p>No view has a mask that can be shown.</p>" : sheet.html) +
         (problems.empty() ? "" : section("warnings", "Warnings", "<ul class=odd>" + problems + "</ul>")) + page_end();
}

std::string scene_title(const Scene& scene) {
  namespace fs = std::filesystem;
  const auto is_general = [](const std::string& name) {
    for (const char* general :
         {"images", "image", "rgb", "photos", "input", "train", "test", "point_cloud", "iteration_"})
      if (name.starts_with(general)) return true;
    return name.empty() || name == "." || name == ".." || name == "orbit";  // pictures of a splat: its folder
  };
  const std::string photo = scene.views.empty() ? "" : scene.views.front().image_path;
  for (const std::string& file : {photo, scene.model_path}) {
    if (file.empty()) continue;
    std::error_code failed;
    fs::path folder = fs::weakly_canonical(file, failed).parent_path();
    while (folder.has_relative_path() && is_general(folder.filename().string())) folder = folder.parent_path();
    if (!failed && folder.has_relative_path() && folder.filename() != "scene") return folder.filename().string();
  }
  return {};
}

namespace {

std::string path_data(MaskPlane mask) {
  std::string d;
  for (const Loop& loop : outlines(mask)) {
    GridPoint at = loop.back();
    d += "M" + std::to_string(at.x) + " " + std::to_string(at.y);
    for (std::size_t i = 0; i + 1 < loop.size(); ++i) {
      const GridPoint next = loop[i];
      d += next.y == at.y ? "h" + std::to_string(next.x - at.x) : "v" + std::to_string(next.y - at.y);
      at = next;
    }
    d += "z";
  }
  return d;
}

std::string outline_html(const Outline& outline) {
  if (outline.mask.data == nullptr) return {};
  const std::string d = path_data(outline.mask);
  const std::string stroke = outline.colour.empty() ? "" : " style=\"stroke:" + escaped(outline.colour) + "\"";
  return "<g class=" + outline.kind + "><path class=casing d=\"" + d + "\"/><path" + stroke + " d=\"" + d + "\"/></g>";
}

}  // namespace

std::string jpeg_source(const ImageU8& picture, int quality) {
  return "data:image/jpeg;base64," + base64(io::encode_jpeg(picture, quality));
}

std::string outlined_picture(const ImageU8& picture, const std::vector<Outline>& outlines, const PixelWindow& view_box,
                             const std::string& alt) {
  std::string html = "<div class=stack><img alt=\"" + escaped(alt) + "\" width=" + std::to_string(picture.width_px) +
                     " height=" + std::to_string(picture.height_px) + " src=\"" +
                     jpeg_source(picture, picture.width_px < 200 ? 92 : 82) + "\">";
  html += "<svg aria-hidden=true viewBox=\"" + std::to_string(view_box.x0) + " " + std::to_string(view_box.y0) + " " +
          std::to_string(view_box.w) + " " + std::to_string(view_box.h) + "\">";
  for (const Outline& outline : outlines) html += outline_html(outline);
  return html + "</svg></div>";
}

}  // namespace ngs::cli
