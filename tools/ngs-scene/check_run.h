#pragma once
// The checks of stages/scene_check.h with files behind them: what import and check have in common.
#include "ngs/scene/scene.h"
#include "ngs/stages/scene_check.h"
#include "shared/tool.h"

namespace ngs::capture {

/// Reads the model, photos and masks, fills "result" of the report, prints the table. `notes` become
/// warnings, after the checks: an error must stand first on stderr. Throws where the scene does not hold
/// together.
/// The low-pass filter of the scene's model (stages/filter_probe.h); 0.3 px² where model or photos are missing. What was
/// measured goes into the report.
double probe_model_filter(cli::Run& run, const SceneCheckOptions& options, const Scene& scene);

/// Moves the cameras of the scene to where the photos fit the model (stages/view_shift.h); says in the report by how much.
void align_views(cli::Run& run, Scene& scene);

void run_checks(cli::Run& run, const SceneCheckOptions& options, const Scene& scene,
                std::vector<std::string> notes);

}  // namespace ngs::capture
