#include "photo_match.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <vector>

#include "ngs/capture/scene_check.h"
#include "ngs/core/error.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/math/median.h"
#include "ngs/problem/view_list.h"

namespace ngs::joint {
namespace {

/// PSNR gain of the model over a constant colour in dB, the median of three views; nullopt without photos or after a
/// stop request.
std::optional<double> gain_over_constant(cli::Run& run, const Problem& problem, const GaussianCloud& cloud) {
  constexpr std::size_t kViews = 3;
  const std::vector<std::size_t> with_photo = photo_views(problem.scene);
  std::vector<double> gains_db;
  for_each_view(&run.monitor(), spread_views(with_photo, kViews), [&](std::size_t, std::size_t v) {
    const Camera& camera = problem.scene.views[v].camera;
    gains_db.push_back(match_photo(run.exec(), cloud, {camera, problem.load_photo(v)}, problem.splat).gain_db());
  });
  if (gains_db.empty() || run.monitor().stop_requested()) return std::nullopt;
  return upper_median(std::move(gains_db));
}

}  // namespace

void compare_with_photos(cli::Run& run, const Problem& problem, const std::string& path) {
  const auto timed = run.monitor().scope("compare with photos");
  const double least_db = SceneCheckOptions{}.min_fit_db;
  const std::optional<double> gain_db = gain_over_constant(run, problem, problem.cloud);
  if (!gain_db || *gain_db >= least_db) return;
  char text[160];
  std::snprintf(text, sizeof text,
                "the rendered model matches the photos %.1f dB above a constant colour, expected at least %.1f",
                std::abs(*gain_db) < 0.05 ? 0.0 : *gain_db, least_db);
  const std::string& own = problem.scene.model_path;
  std::error_code absent;
  if (!std::filesystem::is_regular_file(own, absent))
    return run.monitor().warn(std::string(text) + ": it may belong to another scene");
  const std::optional<double> own_db = gain_over_constant(run, problem, io::read_gaussian_ply(own).cloud);
  if (!own_db) return;
  if (*own_db < least_db) return run.monitor().warn(std::string(text) + ", and so does the scene's own model, " + own);
  throw Error(
      ErrorCode::kInconsistent, path + ": " + text + ": it belongs to another scene, " + own + " matches the photos",
      "give the labelled PLY that ngs-variance writes for this scene.json, or import the scene with this model: "
      "ngs-scene import ... --ply");
}

}  // namespace ngs::joint
