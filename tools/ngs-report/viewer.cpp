#include "viewer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "ngs/core/error.h"
#include "ngs/core/version.h"
#include "ngs/io/formats/dot_splat.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "overview.h"
#include "run_figures.h"
#include "shared/page/html.h"
#include "shared/page/mask_sheet.h"
#include "viewer_files.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;

std::string file_of_page(std::string_view path) {
  for (const PageFile& file : page_files())
    if (file.path == path) return std::string(file.bytes);
  return {};
}

/// Log of the weight of a Gaussian on screen: opacity times the area of its largest cross-section.
double log_visible_area(const GaussianCloud& cloud, std::int64_t i) {
  const float* s = &cloud.log_scale[std::size_t(3 * i)];
  const double smallest = std::min({double(s[0]), double(s[1]), double(s[2])});
  return -std::log1p(std::exp(-double(cloud.logit_opacity[std::size_t(i)]))) + double(s[0]) + double(s[1]) +
         double(s[2]) - smallest;
}

/// Keeps the `most` rows with the largest visible area, in their order.
void keep_largest(io::SplatSelection& selection, std::size_t most) {
  if (selection.rows.size() <= most) return;
  std::vector<std::pair<double, std::int64_t>> by_area;  // largest first, then by row
  for (const std::int64_t row : selection.rows) by_area.emplace_back(-log_visible_area(selection.cloud, row), row);
  std::nth_element(by_area.begin(), by_area.begin() + std::ptrdiff_t(most), by_area.end());
  selection.rows.clear();
  for (std::size_t k = 0; k < most; ++k) selection.rows.push_back(by_area[k].second);
  std::ranges::sort(selection.rows);
}

/// Median of the Gaussians along each axis, and the longest extent between the 5 % and 95 % quantiles.
struct Middle {
  Vec3<double> centre;
  double radius = 1;
};

Middle middle_of(const io::SplatSelection& selection) {
  double centre[3], reach = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<float> along;
    for (const std::int64_t row : selection.rows)
      along.push_back(selection.cloud.position[std::size_t(3 * row) + axis]);
    std::ranges::sort(along);
    const std::size_t n = along.size();
    centre[axis] = selection.cloud.origin[axis] + double(along[n / 2]);
    reach = std::max(reach, double(along[n - 1 - n / 20]) - double(along[n / 20]));
  }
  return {{centre[0], centre[1], centre[2]}, reach > 0 ? reach : 1};
}

Json triple(const Vec3<double>& v) { return Json::array({v.x, v.y, v.z}); }

/// Mean up direction of the cameras.
Vec3<double> up_of(const Scene& scene) {
  Vec3<double> up{0, 0, 0};
  for (const SceneView& view : scene.views) up = up - transpose(view.camera.rotation) * Vec3<double>{0, 1, 0};
  const double length = std::sqrt(dot(up, up));
  return length > 1e-6 ? (1 / length) * up : Vec3<double>{0, -1, 0};
}

Camera first_camera(const RunFolder& run, const Middle& middle) {
  if (const ShownView* view = median_view(run); view != nullptr && view->scene_view)
    return run.scene->views[*view->scene_view].camera;
  if (run.scene && !run.scene->views.empty()) return run.scene->views.front().camera;
  Camera camera{.name = {}, .width_px = 800, .height_px = 600, .fx = 800, .fy = 800, .cx = 400, .cy = 300};
  camera.rotation = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  camera.translation = Vec3<double>{0, 0, 2.5 * middle.radius} - middle.centre;
  return camera;
}

/// Parameters of viewer.js: the first camera, in world units and in pixels.
Json viewer_parameters(const RunFolder& run, const io::SplatSelection& selection) {
  const Middle middle = middle_of(selection);
  const Camera camera = first_camera(run, middle);
  const auto axis = [&](const Vec3<double>& v) { return triple(transpose(camera.rotation) * v); };
  return {{"right", axis({1, 0, 0})},
          {"down", axis({0, 1, 0})},
          {"forward", axis({0, 0, 1})},
          {"eye", triple(camera.centre())},
          {"centre", triple(middle.centre)},
          {"up", run.scene ? triple(up_of(*run.scene)) : axis({0, -1, 0})},
          {"fx", camera.fx},
          {"cx", camera.cx},
          {"cy", camera.cy},
          {"width_px", camera.width_px},
          {"height_px", camera.height_px},
          {"filter_px2", run.scene ? run.scene->filter_px2 : 0.3}};
}

/// JSON for a script element, with "<" escaped so that it cannot end the element.
std::string for_script(const Json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', true, Json::error_handler_t::replace))
    text += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return text;
}

}  // namespace

ViewerPage viewer_page(const RunFolder& run, const ViewerOptions& options) {
  const fs::path path = fs::path(run.path) / "object.ply";
  if (!fs::is_regular_file(path))
    throw Error(ErrorCode::kBadInput, path.string() + ": no such file, expected the object for --viewer",
                "write it with ngs-extract --object");
  const io::GaussianPly ply = io::read_gaussian_ply(path.string());
  io::SplatSelection selection = io::select_rows(ply.cloud, {});
  if (selection.rows.empty()) throw Error(ErrorCode::kNothingFound, path.string() + ": no Gaussian to draw");
  const auto all = std::ssize(selection.rows);
  keep_largest(selection, std::size_t(options.gaussians));
  ViewerPage page;
  page.shown = std::ssize(selection.rows), page.left_out = all - page.shown;
  const std::string scene = run.scene ? scene_title(*run.scene) : std::string();
  const std::string title = scene.empty() || scene == run.title ? run.title : scene + ": " + run.title;
  page.html =
      "<!doctype html>\n<html lang=en><head><meta charset=utf-8><meta name=viewport "
      "content=\"width=device-width,initial-scale=1\"><meta http-equiv=Content-Security-Policy "
      "content=\"default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'\"><title>" +
      escaped(title) + " – object</title><style>\n" + file_of_page("/viewer.css") +
      "</style></head>\n<body><header><h1>" + escaped(title) + "</h1><p>" + whole(page.shown) + " Gaussians" +
      (page.left_out > 0 ? ", " + whole(page.left_out) + " of least visible area left out" : std::string()) +
      ". Simplified colours (no view-dependent shading).</p></header>\n" + file_of_page("/viewer.html") +
      "<script type=\"application/json\" id=parameters>" + for_script(viewer_parameters(run, selection)) +
      "</script>\n<script type=\"application/octet-stream\" id=splats>" + base64(io::encode_dot_splat(selection)) +
      "</script>\n<script>\n" + file_of_page("/viewer.js") + "</script>\n<!-- ngs " + kVersion + " --></body></html>\n";
  return page;
}

}  // namespace ngs::cli
