// Strokes by a rule from the truth, and what a cut made of them is worth: for pipelines/around.sh.
//
//   ngs_strokes ball    MODEL IDS ID               X,Y,Z,R of the Gaussians with this id
//   ngs_strokes strokes MODEL IDS ID SCENE         prompts for two views about 90 degrees apart
//   ngs_strokes score   MODEL IDS ID SCENE LABELLED  {"iou", "worst_view", "views", "gaussian_iou"}
//
// IDS has one byte a Gaussian, in the order of MODEL. The truth of a view is what of the id shows there: its share of
// the pixel, at least one half. Scores are of the views that show any of it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/scene/mask_threshold.h"
#include "ngs/stages/render/render_options.h"
#include "strokes/stroke_rule.h"

namespace ngs::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kShown = 0.995;  // of the Gaussians, that the ball is told from
constexpr double kRoom = 1.1;

std::vector<std::uint8_t> read_ids(const std::string& path, std::int64_t gaussians) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::uint8_t> ids{std::istreambuf_iterator<char>(file), {}};
  if (std::ssize(ids) != gaussians) throw Error(ErrorCode::kBadInput, path + ": expected one byte a Gaussian");
  return ids;
}

double quantile(std::vector<double> values, double share) {
  const auto at = std::ptrdiff_t(share * double(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[std::size_t(at)];
}

struct Truth {
  io::GaussianPly ply;
  std::vector<float> share;  // [N] 1: of the id

  Truth(const char* model, const char* ids, const char* id) : ply(io::read_gaussian_ply(model)) {
    for (const std::uint8_t other : read_ids(ids, ply.cloud.size())) share.push_back(float(other == std::atoi(id)));
  }
};

void print_ball(const Truth& truth) {
  const GaussianCloud& cloud = truth.ply.cloud;
  std::array<std::vector<double>, 3> along;
  std::vector<double> distance;
  const auto each = [&](const auto& f) {
    for (std::size_t i = 0; i < truth.share.size(); ++i)
      if (truth.share[i] > 0) f(&cloud.position[3 * i]);
  };
  each([&](const float* p) {
    for (std::size_t a = 0; a < 3; ++a) along[a].push_back(double(p[a]));
  });
  std::array<double, 3> centre{};
  for (std::size_t a = 0; a < 3; ++a) centre[a] = 0.5 * (quantile(along[a], kShown) + quantile(along[a], 1 - kShown));
  each([&](const float* p) {
    distance.push_back(std::hypot(double(p[0]) - centre[0], double(p[1]) - centre[1], double(p[2]) - centre[2]));
  });
  std::printf("%.5g,%.5g,%.5g,%.5g\n", centre[0] + cloud.origin[0], centre[1] + cloud.origin[1],
              centre[2] + cloud.origin[2], kRoom * quantile(distance, kShown));
}

PixelMask mask_of(const ImageF& label, std::size_t channel) {
  PixelMask mask(std::size_t(label.pixels()));
  for (std::size_t p = 0; p < mask.size(); ++p)
    mask[p] = label_says_object(label.data[p * std::size_t(label.channels) + channel]);
  return mask;
}

struct Views {
  Exec exec;
  Scene scene;
  SplatOptions splat;

  Views(const char* path, const GaussianCloud& cloud) : scene(io::read_scene_json(path)) {
    splat = prepared_for(exec, splat_options({}, cloud, scene), cloud);
  }
  ImageF labels(const GaussianCloud& cloud, const Camera& camera, const std::vector<float>& channel, int count) const {
    RenderRequest request;
    request.colour = false;
    request.label = {channel.data(), cloud.size(), count};
    return std::move(render(exec, cloud, camera, splat, request).label);
  }
};

/// How far two cameras are from standing as high as each other, a quarter of a turn apart. Cameras of ngs-scene orbit
/// have level pictures: their x axes turn with the azimuth alone.
double off_square(const Camera& a, const Camera& b) {
  const auto axis = [](const Camera& c, int row) {
    return Vec3<double>{c.rotation(row, 0), c.rotation(row, 1), c.rotation(row, 2)};
  };
  const Vec3<double> up = cross(axis(a, 0), axis(b, 0)), rise = axis(b, 2) - axis(a, 2);
  const double turned = std::sqrt(dot(up, up));
  return turned > 0.1 ? std::abs(dot(axis(a, 0), axis(b, 0))) + std::abs(dot(rise, up)) / turned : 2;
}

void print_strokes(const Truth& truth, const Views& views) {
  const Camera& first = views.scene.views.front().camera;
  const Camera* second = &first;
  for (const SceneView& view : views.scene.views)
    if (off_square(first, view.camera) < off_square(first, *second)) second = &view.camera;
  Json out{{"ngs_prompts", 2}, {"views", Json::array()}};
  for (const Camera* camera : {&first, second}) {
    const PixelMask mask = mask_of(views.labels(truth.ply.cloud, *camera, truth.share, 1), 0);
    const HandPrompt prompt = strokes_of_truth(mask, camera->width_px, camera->height_px, camera->name);
    Json strokes = Json::array();
    for (const PromptStroke& stroke : prompt.strokes)
      strokes.push_back({{"object", stroke.object}, {"radius", stroke.radius_px}, {"points", stroke.points}});
    out["views"].push_back(
        {{"view", prompt.view}, {"width", prompt.width_px}, {"height", prompt.height_px}, {"strokes", strokes}});
  }
  std::cout << out.dump() << "\n";
}

double ratio(std::int64_t both, std::int64_t either) { return either > 0 ? double(both) / double(either) : 1; }

void print_score(const Truth& truth, const Views& views, const char* labelled) {
  const std::vector<float> label = io::read_gaussian_ply(labelled).labels.label;
  if (label.size() != truth.share.size()) throw Error(ErrorCode::kBadInput, std::string(labelled) + ": other rows");
  std::vector<float> channel;
  std::int64_t both = 0, either = 0;
  for (std::size_t i = 0; i < label.size(); ++i) {
    channel.push_back(label[i]), channel.push_back(truth.share[i]);
    both += label_says_object(label[i]) && truth.share[i] > 0;
    either += label_says_object(label[i]) || truth.share[i] > 0;
  }
  double sum = 0, worst = 1;
  int count = 0;
  for (const SceneView& view : views.scene.views) {
    const bool all = std::ranges::none_of(views.scene.views, [](const auto& v) { return v.split == Split::kHeldOut; });
    if (!all && view.split != Split::kHeldOut) continue;
    const ImageF image = views.labels(truth.ply.cloud, view.camera, channel, 2);
    const PixelMask found = mask_of(image, 0), expected = mask_of(image, 1);
    if (std::ranges::count(expected, 1) == 0) continue;
    std::int64_t shared = 0, any = 0;
    for (std::size_t p = 0; p < found.size(); ++p) shared += found[p] && expected[p], any += found[p] || expected[p];
    sum += ratio(shared, any), worst = std::min(worst, ratio(shared, any)), ++count;
  }
  std::cout << Json{{"iou", sum / std::max(1, count)},
                    {"worst_view", worst},
                    {"views", count},
                    {"gaussian_iou", ratio(both, either)}}
                   .dump()
            << "\n";
}

int run(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const int wanted = what == "ball" ? 5 : what == "strokes" ? 6 : what == "score" ? 7 : 0;
  if (argc != wanted) {
    std::fputs("usage: ngs_strokes ball|strokes|score MODEL IDS ID [SCENE [LABELLED]]\n", stderr);
    return 2;
  }
  const Truth truth(argv[2], argv[3], argv[4]);
  if (what == "ball") return print_ball(truth), 0;
  const Views views(argv[5], truth.ply.cloud);
  if (what == "strokes") return print_strokes(truth, views), 0;
  return print_score(truth, views, argv[6]), 0;
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
