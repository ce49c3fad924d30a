#pragma once
// What a fit starts from, and how it is described.
#include <string>
#include <vector>

#include "ngs/stages/fit/fit_stage.h"
#include "shared/run/run.h"

namespace ngs::cli {

/// Every view of the scene that has a photo.
std::vector<FitView> load_views(Run& run, const Scene& scene);
/// Empty, with a warning, if no file is given; a warning too where there are more than the fit may have.
std::vector<FitPoint> load_points(Run& run, const FitOptions& options, const Input& input);

/// What a dry run says.
Json fit_plan(const FitOptions& options, const Scene& scene, bool resumes, int threads);
/// The comment of the model.
std::string history(const FitOptions& options);
Json score_json(const FitScore& score);

/// With the background that the options ask for; they then name it, for the report.
Scene read_fit_scene(Run& run, const std::string& path, FitOptions& options);

}  // namespace ngs::cli
