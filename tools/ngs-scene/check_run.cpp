#include "check_run.h"

#include <algorithm>

#include "check_report.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/image/photo.h"
#include "ngs/io/files/regular_file.h"
#include "ngs/stages/render/background.h"
#include "ngs/stages/scene/filter_probe.h"
#include "ngs/stages/scene/view_align.h"
#include "ngs/problem/view_list.h"

namespace ngs::capture {
namespace {

std::function<ImageF(std::size_t view)> photos_of(const Scene& scene) {
  return [&scene](std::size_t view) { return io::load_photo(scene, view); };
}

SceneLoaders loaders_from_files(const Scene& scene) {
  return {photos_of(scene), [&scene](std::size_t view) {
            io::LoadedMasks loaded = io::load_masks_with_notes(scene, view);
            return MaskSample{std::move(loaded.masks), std::move(loaded.notes), loaded.lossy};
          }};
}

/// `count` views with a photo, evenly spaced.
std::vector<std::size_t> some_with_photo(const Scene& scene, int count) {
  const std::vector<std::size_t> with_photo = photo_views(scene);
  std::vector<std::size_t> some;
  for (const std::size_t i : evenly_spaced(std::size_t(count), with_photo.size())) some.push_back(with_photo[i]);
  return some;
}

}  // namespace

Model read_model(cli::Run& run, const Scene& scene, std::vector<std::string>& notes) {
  if (scene.model_path.empty()) return std::nullopt;
  const auto timed = run.monitor().scope("model");
  io::require_regular_file(scene.model_path);
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
  const FilterProbe probe = probe_filter(run.exec(), run.monitor(), {model->cloud, scene, photos_of(scene)},
                                         some_with_photo(scene, options.check_views));
  for (const FilterCandidate& c : probe.candidates)
    run.result()["filter"].push_back({{"filter_px2", c.filter_px2}, {"psnr_db", c.psnr_db}});
  return probe.filter_px2;
}

bool settle_transparent_photos(cli::Run& run, const SceneCheckOptions& options, const Model& model, Scene& scene,
                               std::vector<std::string>& notes) {
  const auto timed = run.monitor().scope("transparency");
  const std::vector<std::size_t> compared = some_with_photo(scene, options.check_views);
  if (std::none_of(compared.begin(), compared.end(),
                   [&](std::size_t view) { return io::photo_is_transparent(scene, view); }))
    return false;
  double psnr[2] = {0, 0};
  const double level[2] = {0, 1};
  for (const int k : {0, 1}) {
    scene.background = Vec3<double>{level[k], level[k], level[k]};
    if (model) psnr[k] = psnr_over_background(run.exec(), model->cloud, scene, compared, photos_of(scene));
  }
  const bool white = psnr[1] > psnr[0] + kBackgroundMarginDb;
  if (!white) scene.background = Vec3<double>{0, 0, 0};
  if (!model) scene.background.reset();
  notes.push_back(std::string("photos are transparent: they are laid over ") + (white ? "white" : "black") +
                  (model ? ", over which the model fits them better" : " until a model says otherwise") +
                  "; --background " + (white ? "black" : "white") + " takes the other");
  if (model) run.result()["background"] = {{"black_psnr_db", psnr[0]}, {"white_psnr_db", psnr[1]}};
  return true;
}

std::vector<std::size_t> background_views(const SceneCheckOptions& options, const Scene& scene) {
  constexpr int kViews = 24;  // of each the photos tell little where the model covers much
  return some_with_photo(scene, options.check_views == 0 ? 0 : std::max(options.check_views, kViews));
}

void find_model_background(cli::Run& run, const Model& model, const std::vector<std::size_t>& views,
                           const std::vector<BackgroundWitness>& witnesses, Scene& scene) {
  if (!model) return;
  const auto timed = run.monitor().scope("background");
  const BackgroundFinding found =
      witnesses.empty() ? find_background(run.exec(), run.monitor(), {model->cloud, scene, photos_of(scene)}, views)
                        : find_background(witnesses);
  scene.background = found.colour;
  const auto triple = [](const Vec3<double>& v) { return Json::array({v.x, v.y, v.z}); };
  run.result()["background"] = {{"found", found.colour.has_value()},
                                {"fitted", triple(found.fitted)},
                                {"error", triple(found.error)},
                                {"shown", found.shown},
                                {"gain_db", found.gain_db},
                                {"views", found.views}};
  if (found.colour) run.info("the photos show a background of " + background_text(background_of(scene)));
}

std::vector<BackgroundWitness> align_views(cli::Run& run, const Model& model, const std::vector<std::size_t>& questioned,
                                           Scene& scene) {
  std::vector<BackgroundWitness> witnesses;
  if (!model) return witnesses;
  const auto alignment =
      measure_alignment(run.exec(), run.monitor(), {model->cloud, scene, photos_of(scene)}, questioned);
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
  for (const ViewAlignment& a : alignment)
    if (a.background) witnesses.push_back(*a.background);
  return witnesses;
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
