#pragma once
// Inputs of a fit, its plan and its metadata.
#include <string>
#include <vector>

#include "ngs/make/fit/fit_stage.h"
#include "shared/run/run.h"

namespace ngs::cli {

/// All views of the scene that have a photo.
std::vector<FitView> load_views(Run& run, const Scene& scene);
/// Empty, with a warning, if no file is given; also warns if there are more points than --max-gaussians.
std::vector<FitPoint> load_points(Run& run, const FitOptions& options, const Input& input);

/// The plan of a dry run.
Json fit_plan(const FitOptions& options, const Scene& scene, bool resumes, int threads);
/// The comment in the model file.
std::string history(const FitOptions& options);
Json score_json(const FitScore& score);

/// Reads the scene, applies the background option and records the background in `options` for the report.
Scene read_fit_scene(Run& run, const std::string& path, FitOptions& options);

}  // namespace ngs::cli
