#pragma once
// The checks of stages/scene/scene_check.h with files behind them: what import and check have in common.
#include <optional>

#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/scene/scene.h"
#include "ngs/stages/render/background.h"
#include "ngs/stages/scene/scene_check.h"
#include "shared/tool.h"

namespace ngs::capture {

/// Empty: the scene names no model.
using Model = std::optional<io::GaussianPly>;

/// Reads the scene's model into memory, its health into the report, and adds to `notes`.
Model read_model(cli::Run& run, const Scene& scene, std::vector<std::string>& notes);

/// The low-pass filter of the model (stages/scene/filter_probe.h); 0.3 px² where model or photos are missing. What
/// was measured goes into the report.
double probe_model_filter(cli::Run& run, const SceneCheckOptions& options, const Scene& scene,
                          const Model& model);

/// Where the background shows through photos, no photo tells it: black or white, whichever the model fits better over,
/// with a note. False: the photos are opaque, and nothing was done.
bool settle_transparent_photos(cli::Run& run, const SceneCheckOptions& options, const Model& model, Scene& scene,
                               std::vector<std::string>& notes);

/// Moves the cameras of the scene to where the photos fit the model (stages/scene/view_align.h); says in the report
/// by how much. Returns what the `questioned` photos say about the background; nothing without a model.
std::vector<BackgroundWitness> align_views(cli::Run& run, const Model& model, const std::vector<std::size_t>& questioned,
                                           Scene& scene);

/// The photos that are asked for the background.
std::vector<std::size_t> background_views(const SceneCheckOptions& options, const Scene& scene);

/// The background that the photos tell (stages/render/background.h), into the scene and the report. `witnesses`: of
/// these views, as far as known; none: the views are rendered.
void find_model_background(cli::Run& run, const Model& model, const std::vector<std::size_t>& views,
                           const std::vector<BackgroundWitness>& witnesses, Scene& scene);

/// Reads photos and masks, fills "result" of the report, prints the table. `notes` become warnings, after the
/// checks: an error must stand first on stderr. Throws where the scene does not hold together.
void run_checks(cli::Run& run, const SceneCheckOptions& options, const Scene& scene, const Model& model,
                std::vector<std::string> notes);

}  // namespace ngs::capture
