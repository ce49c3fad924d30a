#include "viewer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "ngs/core/error.h"
#include "ngs/core/version.h"
#include "ngs/eval/eval_stage.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "sections.h"
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

/// A ball around the object without outliers, world.
struct Middle {
  Vec3<double> centre;
  double radius = 1;
};

/// Centre: middle of the extent along each axis without the outermost 0.5 % on either side. Radius: contains 99.5 % of
/// the Gaussians.
Middle middle_of(const io::SplatSelection& selection) {
  const std::size_t n = selection.rows.size(), outer = n / 200;
  const auto at = [&](std::int64_t row, std::size_t axis) {
    return selection.cloud.origin[axis] + double(selection.cloud.position[std::size_t(3 * row) + axis]);
  };
  double centre[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> along;
    for (const std::int64_t row : selection.rows) along.push_back(at(row, axis));
    std::ranges::sort(along);
    centre[axis] = 0.5 * (along[outer] + along[n - 1 - outer]);
  }
  std::vector<double> distance;
  for (const std::int64_t row : selection.rows)
    distance.push_back(std::hypot(at(row, 0) - centre[0], at(row, 1) - centre[1], at(row, 2) - centre[2]));
  std::ranges::sort(distance);
  const double radius = distance[n - 1 - outer];
  return {{centre[0], centre[1], centre[2]}, radius > 0 ? radius : 1};
}

Json triple(const Vec3<double>& v) { return Json::array({v.x, v.y, v.z}); }

Vec3<double> up_of(const Scene& scene) {
  Vec3<double> up{0, 0, 0};
  for (const SceneView& view : scene.views) up = up - transpose(view.camera.rotation) * Vec3<double>{0, 1, 0};
  return length(up) > 1e-6 ? unit(up) : Vec3<double>{0, -1, 0};
}

/// A camera of the run, for the intrinsics and the side from which the object is seen.
Camera camera_of_run(const RunFolder& run, const Middle& middle) {
  if (const ShownView* view = median_view(run); view != nullptr && view->scene_view)
    return run.scene->views[*view->scene_view].camera;
  if (run.scene && !run.scene->views.empty()) return run.scene->views.front().camera;
  Camera camera{.name = {}, .width_px = 800, .height_px = 600, .fx = 800, .fy = 800, .cx = 400, .cy = 300};
  camera.rotation = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  camera.translation = Vec3<double>{0, 0, 2.5 * middle.radius} - middle.centre;
  return camera;
}

bool is_direction(const Vec3<double>& v) { return dot(v, v) > 1e-6; }

/// Looks at the middle of the object from the side of `camera`, upright if that is defined.
struct Pose {
  Vec3<double> right, down, forward, eye;
};

Pose pose_towards(const Middle& middle, const Camera& camera, const Vec3<double>& up) {
  const auto axis = [&](const Vec3<double>& v) { return transpose(camera.rotation) * v; };
  const Vec3<double> line = (1 / middle.radius) * (middle.centre - camera.centre());
  Pose pose;
  pose.forward = is_direction(line) ? unit(line) : axis({0, 0, 1});
  constexpr double kSteep = 0.04;  // squared sine: within 12 degrees of the vertical "up" does not define the roll
  Vec3<double> side = cross(-1.0 * up, pose.forward);
  if (dot(side, side) < kSteep) side = cross(axis({0, 1, 0}), pose.forward);
  if (!is_direction(side)) side = axis({1, 0, 0});
  pose.right = unit(side);
  pose.down = cross(pose.forward, pose.right);
  constexpr double kMargin = 1.15;  // free space around the object
  const double half_px = 0.5 * std::min(camera.width_px, camera.height_px), focal_px = camera.fx;
  const double distance = kMargin * middle.radius * std::hypot(focal_px, half_px) / half_px;
  pose.eye = middle.centre - distance * pose.forward;
  return pose;
}

/// Parameters of viewer.js: the first camera, in world units and in pixels.
Json viewer_parameters(const RunFolder& run, const io::SplatSelection& selection) {
  const Middle middle = middle_of(selection);
  const Camera camera = camera_of_run(run, middle);
  const Vec3<double> up = run.scene ? up_of(*run.scene) : -1.0 * (transpose(camera.rotation) * Vec3<double>{0, 1, 0});
  const Pose pose = pose_towards(middle, camera, up);
  return {{"right", triple(pose.right)},
          {"down", triple(pose.down)},
          {"forward", triple(pose.forward)},
          {"eye", triple(pose.eye)},
          {"centre", triple(middle.centre)},
          {"up", triple(up)},
          {"fx", camera.fx},
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

constexpr std::uintmax_t kMostMeshBytes = 16 << 20;

/// The choice between splat, mesh and colliders, and the bytes of the run's mesh. Empty without one, or if it is large.
std::string mesh_layer(const RunFolder& run) {
  const std::string path = (fs::path(run.path) / "mesh.glb").generic_string();
  std::error_code unreadable;
  if (!fs::is_regular_file(path, unreadable) || fs::file_size(path, unreadable) > kMostMeshBytes) return {};
  const io::MappedFile file(path);
  const std::string_view text = file.text();
  if (text.find("\"to_splat\"") == text.npos) return {};  // not of ngs-mesh
  const bool has_colliders = text.find("collider00") != text.npos || text.find("UCX_object_00") != text.npos;
  return "<select id=layer aria-label=\"What is shown\"><option value=splat>Splat</option><option "
         "value=mesh>Mesh</option>" +
         std::string(has_colliders ? "<option value=collider>Mesh and colliders</option>" : "") +
         "</select><script type=\"application/octet-stream\" id=mesh>" + base64(file.bytes()) + "</script>";
}

}  // namespace

std::string viewer_beside(const std::string& page) {
  const fs::path path(page);
  const std::string stem = path.stem().string();
  return (path.parent_path() / (stem == "report" ? "object.html" : stem + "-object.html")).generic_string();
}

bool has_object(const RunFolder& run) {
  std::error_code unreadable;
  return fs::is_regular_file(fs::path(run.path) / "object.ply", unreadable);
}

ViewerPage viewer_page(const RunFolder& run, const ViewerOptions& options) {
  const fs::path path = fs::path(run.path) / "object.ply";
  if (!fs::is_regular_file(path))
    throw Error(ErrorCode::kBadInput, path.generic_string() + ": no such file, expected the object for --viewer",
                "write it with ngs-extract --object-ply");
  const io::GaussianPly ply = io::read_gaussian_ply(path.generic_string());
  io::SplatSelection selection = io::select_rows(ply.cloud, {});
  if (selection.rows.empty()) throw Error(ErrorCode::kNothingFound, path.generic_string() + ": no Gaussian to draw");
  const auto all = std::ssize(selection.rows);
  keep_largest(selection, std::size_t(options.gaussians));
  ViewerPage page;
  page.shown = std::ssize(selection.rows);
  page.left_out = all - page.shown;
  const std::string scene = run.scene ? scene_title(*run.scene) : std::string();
  const std::string title = scene.empty() || scene == run.title ? run.title : scene + ": " + run.title;
  std::string body = file_of_page("/viewer.html");
  body.insert(body.find("</nav>"), mesh_layer(run));
  page.html =
      "<!doctype html>\n<html lang=en><head><meta charset=utf-8><meta name=viewport "
      "content=\"width=device-width,initial-scale=1\"><meta http-equiv=Content-Security-Policy "
      "content=\"default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'\"><title>" +
      escaped(title) + " – object</title><style>\n" + file_of_page("/viewer.css") +
      "</style></head>\n<body><header><h1>" + escaped(title) + "</h1><p>" + with_separators(page.shown) + " Gaussians" +
      (page.left_out > 0 ? ", " + with_separators(page.left_out) + " of least visible area left out" : std::string()) +
      ". Simplified colours (no view-dependent shading).</p></header>\n" + body +
      "<script type=\"application/json\" id=parameters>" + for_script(viewer_parameters(run, selection)) +
      "</script>\n<script type=\"application/octet-stream\" id=splats>" + base64(io::encode_dot_splat(selection)) +
      "</script>\n<script>\n" + file_of_page("/viewer.js") + "</script>\n" + kViewerMark + kVersion +
      " --></body></html>\n";
  return page;
}

namespace {

/// Whether an earlier run wrote the file, for example one that was killed before it wrote the page.
bool is_viewer_page(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  constexpr std::streamoff kTail = 100;
  file.seekg(0, std::ios::end);
  file.seekg(std::max(std::streamoff(0), std::streamoff(file.tellg()) - kTail));
  const std::string tail{std::istreambuf_iterator<char>(file), {}};
  return tail.find(kViewerMark) != tail.npos;
}

std::string path_of(const Run& run, const ViewerOutput& output, const std::vector<RunFolder>& runs) {
  if (output.viewer) return output.viewer.path;
  if (run.goes_to_stdout(output.page) || runs.size() != 1 || !has_object(runs.front())) return {};
  const std::string path = viewer_beside(output.page.path);
  std::error_code unreadable;
  if (!run.overwrite() && std::filesystem::exists(path, unreadable) && !is_viewer_page(path))
    throw Error(ErrorCode::kUsage, path + ": exists already, expected a free name for the 3D page",
                "replace it with -w, or write no 3D page: --viewer-gaussians 0");
  return path;
}

}  // namespace

std::string write_viewer(Run& run, const ViewerOutput& output, std::vector<RunFolder>& runs) {
  if (output.options.gaussians == 0) {
    run.warn_unused({"--viewer"}, "with --viewer-gaussians 0");
    return {};
  }
  const std::string path = path_of(run, output, runs);
  if (path.empty()) return path;
  try {
    const ViewerPage object = viewer_page(runs.front(), output.options);
    io::write_file(path, object.html);
    run.result()["viewer"] = {{"gaussians", object.shown}, {"left_out", object.left_out}};
    return path;
  } catch (const Error& e) {
    if (output.viewer || e.code() == ErrorCode::kEnvironment) throw;
    runs.front().problems.push_back(e.what());
    return {};
  }
}

}  // namespace ngs::cli
