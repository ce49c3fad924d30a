#include "check_run.h"

#include "check_report.h"
#include "ngs/io/masks.h"
#include "ngs/io/photo.h"
#include "ngs/stages/filter_probe.h"
#include "ngs/stages/view_align.h"
#include "ngs/stages/view_list.h"

namespace ngs::capture {
namespace {

SceneLoaders loaders_from_files(const Scene& scene) {
  return {[&scene](std::size_t view) { return io::load_photo(scene, view); },
          [&scene](std::size_t view) {
            io::LoadedMasks loaded = io::load_masks_with_notes(scene, view);
            return MaskSample{std::move(loaded.masks), std::move(loaded.notes), loaded.lossy};
          }};
}

}  // namespace

Model read_model(cli::Run& run, const Scene& scene, std::vector<std::string>& notes) {
  if (scene.model_path.empty()) return std::nullopt;
  const auto timed = run.monitor().scope("model");
  io::GaussianPly model = io::read_gaussian_ply(scene.model_path);
  run.add_input("model", scene.model_path);
  notes.insert(notes.end(), model.notes.begin(), model.notes.end());
  if (model.health.excluded() > 0)
    notes.push_back(scene.model_path + ": " + std::to_string(model.health.excluded()) +
                    " Gaussians are not finite or absurdly large and take no part");
  run.result()["model"] = health_json(model.health);
  return model;
}

double probe_model_filter(cli::Run& run, const SceneCheckOptions& options, const Scene& scene,
                          const Model& model) {
  if (!model) return scene.filter_px2;
  const auto timed = run.monitor().scope("filter");
  const std::vector<std::size_t> with_photo = photo_views(scene);
  std::vector<std::size_t> compared;
  for (const std::size_t i : evenly_spaced(std::size_t(options.check_views), with_photo.size()))
    compared.push_back(with_photo[i]);
  const FilterProbe probe = probe_filter(run.exec(), model->cloud, scene, compared,
                                         [&](std::size_t view) { return io::load_photo(scene, view); });
  for (const FilterCandidate& c : probe.candidates)
    run.result()["filter"].push_back({{"filter_px2", c.filter_px2}, {"psnr_db", c.psnr_db}});
  return probe.filter_px2;
}

void align_views(cli::Run& run, const Model& model, Scene& scene) {
  if (!model) return;
  const auto alignment = measure_alignment(run.exec(), run.monitor(), model->cloud, scene,
                                           [&](std::size_t view) { return io::load_photo(scene, view); });
  apply_alignment(alignment, scene);
  const auto triple = [](const Vec3<double>& v) { return Json::array({v.x, v.y, v.z}); };
  for (const ViewAlignment& a : alignment)
    run.result()["view_alignment"].push_back({{"view", scene.views[a.view].camera.name},
                                              {"flow_px", a.flow_px},
                                              {"turn_rad", triple(a.motion.turn)},
                                              {"move_world", triple(a.motion.move)},
                                              {"error_before", a.error_before},
                                              {"error_after", a.error_after},
                                              {"applied", a.applied}});
}

void run_checks(cli::Run& run, const SceneCheckOptions& options, const Scene& scene, const Model& model,
                std::vector<std::string> notes) {
  const SceneCheck result = check_scene(run.exec(), run.monitor(), options, model ? &model->cloud : nullptr,
                                        scene, loaders_from_files(scene));
  notes.insert(notes.end(), result.warnings.begin(), result.warnings.end());
  for (const std::string& note : notes) run.monitor().warn(note);
  run.result().update(check_json(scene, result));
  run.text(check_table(scene, result));
}

}  // namespace ngs::capture
