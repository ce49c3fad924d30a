#include "memory_plan.h"

#include <algorithm>
#include <cmath>

#include "ngs/problem/coarse_input.h"
#include "ngs/problem/view_list.h"

namespace ngs::joint {
namespace {

constexpr double kMib = 1024.0 * 1024.0;
constexpr double kProgram = 56 * kMib;   // with OpenCV and the other libraries
constexpr double kKept = 256 * kMib;     // photos of a CoarseInput; surfaces of the floater search
constexpr double kWeights = 512 * kMib;  // what single views weigh (LeaveOneOut)
constexpr double kShown = 0.25;          // of the Gaussians, in a view
constexpr double kFloat = sizeof(float), kDouble = sizeof(double), kSum = 2 * sizeof(std::uint64_t);

struct Sizes {
  double gaussians, rest, objects, views, photo_px, largest_px;
  double owners;  // objects that a Gaussian is part of, at most in the mean

  explicit Sizes(const Problem& problem)
      : gaussians(double(problem.cloud.size())),
        rest(problem.cloud.rest_count()),
        objects(double(problem.scene.objects.size())),
        views(double(problem.views.size())),
        photo_px(0),
        largest_px(0),
        owners(std::min(objects, 2.0)) {
    for (const std::size_t v : photo_views(problem.scene)) {
      const Camera& camera = problem.scene.views[v].camera;
      photo_px += double(camera.width_px) * camera.height_px;
    }
    for (const SceneView& view : problem.scene.views)
      largest_px = std::max(largest_px, double(view.camera.width_px) * view.camera.height_px);
  }
};

// Bytes of a Gaussian.
double model(const Sizes& s) { return kFloat * (3 + 4 + 3 + 1 + 3 + 3 * s.rest) + 1; }
constexpr double kPrepared = kFloat * (3 + 9 + 1 + 2 + 1);  // PreparedCloud
double labels(const Sizes& s) { return kFloat * (4 * s.owners + 1); }
/// A view's records, tiles and sums, of the Gaussians that it shows: variance::memory_plan() says which.
double view_pass(double columns) { return kShown * (97 + 48 + 3 * (20 + kFloat * (2 + 2 * columns))); }

/// Of single views: W, and W1 of each of some columns, behind a byte of flags each.
double kept_weights(const Sizes& s, double views, double columns) {
  return std::min(kWeights, views * kShown * s.gaussians * (2 + kFloat + columns * (1 + kFloat)));
}

/// While views are judged by the others: the consensus, and the evidence that it is made of.
double outliers(const Sizes& s) {
  const double row = kFloat * (s.objects + 1) + 2 + kSum + 4 + 24 * s.owners + view_pass(std::min(s.objects, 3.0));
  const double left = 2 * (12 + 16 * s.owners) + kFloat;  // evidence with and without the views that are ignored
  return std::max(row * s.gaussians + kept_weights(s, s.views, 1), left * s.gaussians);
}

/// While floaters are searched: evidence of three colours, five numbers a Gaussian, and pictures of the core.
double search(const Sizes& s, const Options& options, double shrink) {
  const bool draft = options.training.joint.quality == Quality::kDraft;
  const double views = draft ? std::min(s.views, 48.0) : s.views, scale = shrink * (draft ? 2 : 1);
  const double row = kSum * 4 + 4 * kDouble + 4 * kFloat + 4 + view_pass(3);
  const double px = s.photo_px / (scale * scale);
  return row * s.gaussians + kept_weights(s, views, 3) + 2 * std::min(kKept, 4 * kFloat * px);
}

/// While the result is written beside what was read.
double written(const Sizes& s) { return (model(s) + labels(s)) * s.gaussians; }

}  // namespace

Json memory_plan(const Options& options, const Problem& problem) {
  const Sizes s(problem);
  const double shrink = decision_shrink(problem.scene), bytes_px = 3 * kFloat;
  const double row = model(s) + kPrepared + 2 * labels(s) + 4;
  double most = written(s), photos = 0;
  if (options.runs_passes()) {
    most = std::max({most, outliers(s), search(s, options, shrink)});
    photos = std::min(kKept, bytes_px * s.photo_px) + std::min(kKept, bytes_px * s.photo_px / (shrink * shrink));
  }
  const double view = (kFloat * (4 + s.objects) + 3 * kFloat) * s.largest_px;  // one is drawn, one is read
  return {{"bytes_per_gaussian", std::round(row + most / std::max(1.0, s.gaussians))},
          {"bytes_per_pixel", bytes_px * (1 + 1 / (shrink * shrink))},
          {"bytes_per_view", view},
          {"estimated_peak_mib", std::ceil((kProgram + row * s.gaussians + most + photos + view) / kMib)}};
}

}  // namespace ngs::joint
