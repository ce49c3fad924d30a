#include "import_renders.h"

#include "check_run.h"

namespace ngs::capture {

void check_renders(cli::Run& run, const SceneCheckOptions& checks, io::ImportedScene& imported) {
  run.warn_unused({"--align-views", "--background", "--compat", "--antialias", "--filter-px2"},
                  "with renders of the model, whose settings are kept");
  run.result()["photos"] = kRenderedPhotosNote;
  SceneChecks scene(run, checks, imported.scene, std::move(imported.notes));
  scene.check();
  scene.leave_out_lost_masks();
}

}  // namespace ngs::capture
