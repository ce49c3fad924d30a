// Generates strokes from ground truth and scores the resulting cuts, for tests/bench/around.sh, two-points.sh and
// no-photos.sh.
//
//   ngs_strokes ball    MODEL IDS ID               X,Y,Z,R of the Gaussians with this id
//   ngs_strokes strokes MODEL IDS ID SCENE         prompts for two views about 90 degrees apart
//   ngs_strokes sides   MODEL IDS ID SCENE COUNT   prompts for COUNT (1 or 2) views: a line on each side
//   ngs_strokes visit   MODEL IDS ID SCENE         requests for ngs-studio --replay: lines on and around the object
//                                                  from two sides, Refine in quick quality, export
//   ngs_strokes score   MODEL IDS ID SCENE LABELLED  {"iou", "worst_view", "views"}, "gaussian_iou" of the same rows
//   ngs_strokes ids     LABELLED IDS               writes IDS: 1 for Gaussians labelled as object
//   ngs_strokes above   MODEL A,B,C,D IDS          writes IDS: 1 if Ax + By + Cz + D >= 0 at the centre
//   ngs_strokes alone   MODEL IDS ID OUT           writes the Gaussians with this id as a PLY
//   ngs_strokes lines   MASK VIEW                  prompts for one view, from its mask
//   ngs_strokes points  MASK VIEW                  only the two ends of the line on the object
//
// IDS has one byte per Gaussian, in the order of MODEL. True mask of a view: pixels with a rendered share of the id of
// at least one half. Scores are means over the views with a nonempty true mask.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/render/render_options.h"
#include "ngs/scene/mask_threshold.h"
#include "strokes/stroke_rule.h"

namespace ngs::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kInlierShare = 0.995;  // quantile of the Gaussians inside the ball
constexpr double kBallMargin = 1.1;

std::vector<std::uint8_t> read_ids(const std::string& path, std::int64_t gaussians) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::uint8_t> ids{std::istreambuf_iterator<char>(file), {}};
  if (std::ssize(ids) != gaussians) throw Error(ErrorCode::kBadInput, path + ": expected one byte per Gaussian");
  return ids;
}

double quantile(std::vector<double> values, double share) {
  const auto at = std::ptrdiff_t(share * double(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[std::size_t(at)];
}

struct Truth {
  io::GaussianPly ply;
  std::vector<float> share;  // [N] 1: Gaussian with the id

  Truth(const char* model, const char* ids, const char* id) : ply(io::read_gaussian_ply(model)) {
    for (const std::uint8_t other : read_ids(ids, ply.cloud.size())) share.push_back(float(other == std::atoi(id)));
  }
};

void print_ball(const Truth& truth) {
  const GaussianCloud& cloud = truth.ply.cloud;
  std::array<std::vector<double>, 3> along;
  std::vector<double> distance;
  const auto for_each_member = [&](const auto& f) {
    for (std::size_t i = 0; i < truth.share.size(); ++i)
      if (truth.share[i] > 0) f(&cloud.position[3 * i]);
  };
  for_each_member([&](const float* p) {
    for (std::size_t a = 0; a < 3; ++a) along[a].push_back(double(p[a]));
  });
  std::array<double, 3> centre{};
  for (std::size_t a = 0; a < 3; ++a)
    centre[a] = 0.5 * (quantile(along[a], kInlierShare) + quantile(along[a], 1 - kInlierShare));
  for_each_member([&](const float* p) {
    distance.push_back(std::hypot(double(p[0]) - centre[0], double(p[1]) - centre[1], double(p[2]) - centre[2]));
  });
  std::printf("%.5g,%.5g,%.5g,%.5g\n", centre[0] + cloud.origin[0], centre[1] + cloud.origin[1],
              centre[2] + cloud.origin[2], kBallMargin * quantile(distance, kInlierShare));
}

PixelMask mask_of(const ImageF& label) {
  PixelMask mask(std::size_t(label.pixels()));
  for (std::size_t p = 0; p < mask.size(); ++p) mask[p] = label_is_foreground(label.data[p]);
  return mask;
}

struct Views {
  Exec exec;
  Scene scene;
  SplatOptions splat;

  Views(const char* path, const GaussianCloud& cloud) : scene(io::read_scene_json(path)) {
    splat = prepared_for(exec, splat_options({}, cloud, scene), cloud);
  }
  ImageF labels(const GaussianCloud& cloud, const Camera& camera, const std::vector<float>& channel) const {
    RenderRequest request;
    request.colour = false;
    request.label = {channel.data(), cloud.size(), 1};
    return std::move(render(exec, cloud, camera, splat, request).label);
  }
};

/// Deviation of two cameras from equal height and an angle of 90 degrees; 0 is ideal. Pictures of ngs-scene orbit are
/// level: their x axes depend only on the azimuth.
double deviation_from_square(const Camera& a, const Camera& b) {
  const auto axis = [](const Camera& c, int row) {
    return Vec3<double>{c.rotation(row, 0), c.rotation(row, 1), c.rotation(row, 2)};
  };
  const Vec3<double> up = cross(axis(a, 0), axis(b, 0)), rise = axis(b, 2) - axis(a, 2);
  const double turned = std::sqrt(dot(up, up));
  return turned > 0.1 ? std::abs(dot(axis(a, 0), axis(b, 0))) + std::abs(dot(rise, up)) / turned : 2;
}

Vec3<double> viewing_direction(const Camera& c) { return {c.rotation(2, 0), c.rotation(2, 1), c.rotation(2, 2)}; }

void print(const std::vector<HandPrompt>& prompts) {
  Json out{{"ngs_prompts", 2}, {"views", Json::array()}};
  for (const HandPrompt& prompt : prompts) {
    Json strokes = Json::array();
    for (const PromptStroke& stroke : prompt.strokes)
      strokes.push_back({{"object", stroke.object}, {"radius", stroke.radius_px}, {"points", stroke.points}});
    out["views"].push_back(
        {{"view", prompt.view}, {"width", prompt.width_px}, {"height", prompt.height_px}, {"strokes", strokes}});
  }
  std::cout << out.dump() << "\n";
}

void print_strokes(const Truth& truth, const Views& views) {
  const Camera& first = views.scene.views.front().camera;
  const Camera* second = &first;
  for (const SceneView& view : views.scene.views)
    if (deviation_from_square(first, view.camera) < deviation_from_square(first, *second)) second = &view.camera;
  std::vector<HandPrompt> prompts;
  for (const Camera* camera : {&first, second}) {
    const PixelMask mask = mask_of(views.labels(truth.ply.cloud, *camera, truth.share));
    prompts.push_back(strokes_of_truth(mask, camera->width_px, camera->height_px, camera->name));
  }
  print(prompts);
}

/// First view: the one that shows most of the smaller side. Second: of the views turned by more than 120 degrees from
/// it, the same.
void print_sides(const Truth& truth, const Views& views, int count) {
  std::vector<float> rest;
  for (const float share : truth.share) rest.push_back(1 - share);
  const Camera* last = nullptr;
  std::vector<HandPrompt> prompts;
  for (int k = 0; k < count; ++k) {
    std::int64_t most = 0;
    HandPrompt best;
    const Camera* chosen = nullptr;
    for (const SceneView& view : views.scene.views) {
      const Camera& camera = view.camera;
      if (last != nullptr && dot(viewing_direction(*last), viewing_direction(camera)) > -0.5) continue;
      const PixelMask object = mask_of(views.labels(truth.ply.cloud, camera, truth.share));
      const PixelMask other = mask_of(views.labels(truth.ply.cloud, camera, rest));
      const std::int64_t smaller = std::min(std::ranges::count(object, 1), std::ranges::count(other, 1));
      if (smaller <= most) continue;
      most = smaller, chosen = &camera;
      best = strokes_of_sides(object, other, camera.width_px, camera.height_px, camera.name);
    }
    if (chosen == nullptr) throw Error(ErrorCode::kNothingFound, "no view shows both sides");
    prompts.push_back(best), last = chosen;
  }
  print(prompts);
}

/// The camera of ngs-studio at the pose of a view, with a centred principal point.
Json studio_camera(const Camera& camera) {
  const Vec3<double> forward = viewing_direction(camera);
  const Vec3<double> centre = camera.centre();
  return {{"position", {centre.x, centre.y, centre.z}},
          {"look_at", {centre.x + forward.x, centre.y + forward.y, centre.z + forward.z}},
          {"up", {-camera.rotation(1, 0), -camera.rotation(1, 1), -camera.rotation(1, 2)}},
          {"fov_y_deg", 2 * std::atan(0.5 * camera.height_px / camera.fy) * 180 / std::numbers::pi},
          {"width", camera.width_px},
          {"height", camera.height_px}};
}

/// Front: the view with most pixels of the object. Behind: of the views turned by more than 120 degrees, the same.
void print_visit(const Truth& truth, const Views& views) {
  const Camera* front = nullptr;
  for (const bool behind : {false, true}) {
    std::int64_t most = 0;
    const Camera* chosen = nullptr;
    PixelMask mask;
    for (const SceneView& view : views.scene.views) {
      if (behind && dot(viewing_direction(*front), viewing_direction(view.camera)) > -0.5) continue;
      PixelMask seen = mask_of(views.labels(truth.ply.cloud, view.camera, truth.share));
      const std::int64_t pixels = std::ranges::count(seen, 1);
      if (pixels > most) most = pixels, chosen = &view.camera, mask = std::move(seen);
    }
    if (chosen == nullptr) throw Error(ErrorCode::kNothingFound, "no view shows the object");
    Json strokes = Json::array();
    for (const PromptStroke& stroke : strokes_of_truth(mask, chosen->width_px, chosen->height_px, chosen->name).strokes)
      strokes.push_back({{"label", stroke.object ? "object" : "background"},
                         {"radius_px", stroke.radius_px},
                         {"points", stroke.points}});
    std::cout << Json{{"path", "/api/strokes"},
                      {"body", {{"camera", studio_camera(*chosen)}, {"object", 1}, {"strokes", strokes}}}}
                     .dump()
              << "\n";
    front = chosen;
  }
  std::cout << R"({"path": "/api/refine", "body": {"quality": "quick"}})"
            << "\n"
            << R"({"path": "/api/export", "body": {}})"
            << "\n";
}

void print_marks(const std::string& mask_path, const std::string& view, bool only_points) {
  const io::RawMask raw = io::read_mask_raw(mask_path, io::Palette::kMask);
  HandPrompt prompt = strokes_of_truth(object_pixels(raw.samples()), raw.width_px, raw.height_px, view);
  if (only_points) {
    std::erase_if(prompt.strokes, [](const PromptStroke& stroke) { return !stroke.object; });
    if (prompt.strokes.empty())
      throw Error(ErrorCode::kNothingFound, mask_path + ": no object pixel deep enough for a stroke");
    PromptStroke end = prompt.strokes[0];
    end.points.erase(end.points.begin());
    prompt.strokes[0].points.resize(1);
    prompt.strokes.push_back(end);
  }
  print({prompt});
}

double ratio(std::int64_t both, std::int64_t either) { return either > 0 ? double(both) / double(either) : 1; }

double gaussian_iou(const std::vector<float>& label, const std::vector<float>& share) {
  std::int64_t both = 0, either = 0;
  for (std::size_t i = 0; i < label.size(); ++i) {
    both += label_is_foreground(label[i]) && share[i] > 0;
    either += label_is_foreground(label[i]) || share[i] > 0;
  }
  return ratio(both, either);
}

/// The labelled model may differ from the true model, since training changes it.
void print_score(const Truth& truth, const Views& views, const char* scene, const char* labelled) {
  const io::GaussianPly found = io::read_gaussian_ply(labelled);
  const Views found_views(scene, found.cloud);
  const std::vector<float> label = found.labels.label.values();
  double sum = 0, worst = 1;
  int count = 0;
  const bool all = std::ranges::none_of(views.scene.views, [](const auto& v) { return v.split == Split::kHeldOut; });
  for (const SceneView& view : views.scene.views) {
    if (!all && view.split != Split::kHeldOut) continue;
    const PixelMask expected = mask_of(views.labels(truth.ply.cloud, view.camera, truth.share));
    if (std::ranges::count(expected, 1) == 0) continue;
    const PixelMask mask = mask_of(found_views.labels(found.cloud, view.camera, label));
    std::int64_t shared = 0, any = 0;
    for (std::size_t p = 0; p < mask.size(); ++p) shared += mask[p] && expected[p], any += mask[p] || expected[p];
    sum += ratio(shared, any), worst = std::min(worst, ratio(shared, any)), ++count;
  }
  Json out{{"iou", sum / std::max(1, count)}, {"worst_view", worst}, {"views", count}};
  if (label.size() == truth.share.size()) out["gaussian_iou"] = gaussian_iou(label, truth.share);
  std::cout << out.dump() << "\n";
}

void write_ids(const std::string& path, const std::vector<std::uint8_t>& ids) {
  io::write_file(path, std::string(ids.begin(), ids.end()));
}

void write_labelled_ids(const char* labelled, const char* out) {
  std::vector<std::uint8_t> ids;
  for (const float label : io::read_gaussian_ply(labelled).labels.label) ids.push_back(label_is_foreground(label));
  write_ids(out, ids);
}

void write_above(const char* model, const char* plane, const char* out) {
  double a = 0, b = 0, c = 0, d = 0;
  if (std::sscanf(plane, "%lf,%lf,%lf,%lf", &a, &b, &c, &d) != 4)
    throw Error(ErrorCode::kUsage, std::string(plane) + ": expected A,B,C,D");
  const GaussianCloud cloud = io::read_gaussian_ply(model).cloud;
  std::vector<std::uint8_t> ids;
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
    const float* p = &cloud.position[3 * i];
    ids.push_back(a * (double(p[0]) + cloud.origin[0]) + b * (double(p[1]) + cloud.origin[1]) +
                      c * (double(p[2]) + cloud.origin[2]) + d >=
                  0);
  }
  write_ids(out, ids);
}

void write_alone(const Truth& truth, const char* out) {
  io::write_strict_ply(out, truth.ply, {truth.share.begin(), truth.share.end()});
}

int run(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const std::map<std::string, int> words{{"ball", 5},  {"strokes", 6}, {"score", 7},  {"ids", 4},   {"above", 5},
                                         {"alone", 6}, {"lines", 4},   {"points", 4}, {"sides", 7}, {"visit", 6}};
  if (!words.contains(what) || argc != words.at(what)) {
    std::fputs(
        "usage: ngs_strokes ball|strokes|visit|score MODEL IDS ID [SCENE [LABELLED]]\n"
        "       ngs_strokes sides MODEL IDS ID SCENE COUNT\n"
        "       ngs_strokes ids LABELLED IDS | above MODEL A,B,C,D IDS | alone MODEL IDS ID OUT\n"
        "       ngs_strokes lines|points MASK VIEW\n",
        stderr);
    return 2;
  }
  if (what == "lines" || what == "points") return print_marks(argv[2], argv[3], what == "points"), 0;
  if (what == "ids") return write_labelled_ids(argv[2], argv[3]), 0;
  if (what == "above") return write_above(argv[2], argv[3], argv[4]), 0;
  const Truth truth(argv[2], argv[3], argv[4]);
  if (what == "ball") return print_ball(truth), 0;
  if (what == "alone") return write_alone(truth, argv[5]), 0;
  const Views views(argv[5], truth.ply.cloud);
  if (what == "strokes") return print_strokes(truth, views), 0;
  if (what == "visit") return print_visit(truth, views), 0;
  if (what == "sides") return print_sides(truth, views, std::atoi(argv[6])), 0;
  return print_score(truth, views, argv[5], argv[6]), 0;
}

}  // namespace
}  // namespace ngs::bench

int main(int argc, char** argv) {
  try {
    return ngs::bench::run(argc, argv);
  } catch (const ngs::Error& error) {
    std::fprintf(stderr, "ngs_strokes: %s\n", error.what());
    return int(error.code());
  }
}
