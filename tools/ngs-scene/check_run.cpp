#include "check_run.h"

#include <algorithm>

#include "check_report.h"
#include "commands.h"
#include "ngs/capture/filter_probe.h"
#include "ngs/capture/view_align.h"
#include "ngs/capture/view_shares.h"
#include "ngs/core/formatted.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/image/photo.h"
#include "ngs/problem/view_list.h"
#include "ngs/render/render_options.h"
#include "shared/page/mask_sheet.h"
#include "shared/scene/scene_model.h"
#include "shared/tool.h"

namespace ngs::scene_tool {
namespace {

constexpr int kBackgroundViews = 24;  // many: a view gives little evidence if the model covers most of it

/// At most `count` views with a photo, evenly spaced.
std::vector<std::size_t> some_with_photo(const Scene& scene, int count) {
  const std::vector<std::size_t> with_photo = photo_views(scene);
  std::vector<std::size_t> some;
  for (const std::size_t i : evenly_spaced(std::size_t(count), with_photo.size())) some.push_back(with_photo[i]);
  return some;
}

std::vector<std::size_t> background_views(const SceneCheckOptions& options, const Scene& scene) {
  return some_with_photo(scene, options.check_views == 0 ? 0 : std::max(options.check_views, kBackgroundViews));
}

Json triple(const Vec3<double>& v) { return Json::array({v.x, v.y, v.z}); }

/// Appends reading notes to `notes`.
Model read_model(cli::Run& run, const Scene& scene, std::vector<std::string>& notes) {
  if (scene.model_path.empty()) return std::nullopt;
  const auto timed = run.monitor().scope("model");
  io::require_regular_file(scene.model_path);
  io::GaussianPly model = io::read_gaussian_ply(scene.model_path);
  run.add_input("model", scene.model_path);
  notes.insert(notes.end(), model.notes.begin(), model.notes.end());
  if (model.health.excluded() > 0)
    notes.push_back(scene.model_path + ": " + std::to_string(model.health.excluded()) +
                    " Gaussians are ignored: not finite or absurdly large");
  if (model.health.zero_rotation > model.health.total / 100)
    notes.push_back(scene.model_path + ": " + std::to_string(model.health.zero_rotation) +
                    " Gaussians have the rotation 0 0 0 0: read as not turned");
  run.result()["model"] = health_json(model.health);
  return model;
}

/// Writes a page with the input masks over their photos; warns of unreadable pictures.
void write_sheet(cli::Run& run, const Scene& scene, const std::string& path) {
  const auto timed = run.monitor().scope("sheet");
  const cli::MaskSheet sheet = cli::mask_sheet(scene, {});
  for (const std::string& problem : sheet.problems) run.monitor().warn(problem);
  io::write_file(path, cli::mask_sheet_page(scene, sheet));
  run.result()["sheet"] = {
      {"shown", sheet.shown}, {"left_out", sheet.left_out}, {"without_mask", sheet.without.size()}};
}

}  // namespace

SceneChecks::SceneChecks(cli::Run& run, const SceneCheckOptions& options, Scene& scene, std::vector<std::string> notes)
    : run_(run),
      options_(options),
      scene_(scene),
      notes_(std::move(notes)),
      compared_(some_with_photo(scene, options.check_views)),
      photos_(scene, compared_),
      model_(read_model(run, scene, notes_)) {}

PhotographedModel SceneChecks::photographed() {
  return {model_->cloud, scene_, [this](std::size_t view) { return photo(view); }};
}

void SceneChecks::validate_alpha_masks() {
  constexpr float kHidden = 0.5f;        // alpha below which a mask hides the pixel
  constexpr double kMostCovered = 0.25;  // covered hidden pixels; whole scenes 0.71 to 1, objects alone 0.01 to 0.03
  if (std::ranges::none_of(scene_.views, io::has_mask_in_photo)) return;
  const auto timed = run_.monitor().scope("transparency");
  double hidden = 0, covered = 0;
  for (const std::size_t v : compared_) {
    if (!model_ || !io::has_mask_in_photo(scene_.views[v])) continue;
    const ImageF shown = rendered(v).alpha, alpha = io::load_alpha(scene_.views[v]);
    for (std::size_t p = 0; p < alpha.data.size(); ++p) {
      if (!(alpha.data[p] < kHidden)) continue;
      covered += double(shown.data[p]);
      ++hidden;
    }
  }
  if (model_ && covered >= kMostCovered * hidden) return;
  for (SceneView& view : scene_.views)
    if (io::has_mask_in_photo(view)) view.mask_path.clear();
  notes_.push_back(std::string("the alpha channel of the photos is not used as masks: ") +
                   (model_ ? "the model covers only " + formatted("%.0f", 100 * covered / hidden) +
                                 " % of what it hides, it is of the object alone"
                           : "there is no model"));
}

void SceneChecks::drop_emptied_photos() {
  constexpr float kPlain = 8 / 255.f;  // range of a channel over pixels that a tool has painted over
  const auto timed = run_.monitor().scope("transparency");
  std::size_t emptied = 0;
  for (SceneView& view : scene_.views) {
    if (!io::has_mask_in_photo(view)) continue;
    const ImageF photo = io::load_photo(scene_, std::size_t(&view - scene_.views.data())), alpha = io::load_alpha(view);
    float least[3] = {1, 1, 1}, most[3] = {0, 0, 0};
    for (std::size_t i = 0; i < photo.data.size(); ++i) {
      if (alpha.data[i / 3] > 0) continue;
      least[i % 3] = std::min(least[i % 3], photo.data[i]);
      most[i % 3] = std::max(most[i % 3], photo.data[i]);
    }
    const auto is_plain = [&](int channel) { return most[channel] - least[channel] <= kPlain; };
    if (!is_plain(0) || !is_plain(1) || !is_plain(2)) continue;
    view.image_path.clear();
    ++emptied;
  }
  if (emptied > 0)
    run_.monitor().warn(std::to_string(emptied) +
                        " photos have one colour where their alpha channel hides them: only their masks are used; "
                        "opaque photos make edges sharper");
}

RenderedView SceneChecks::rendered(std::size_t view) const {
  RenderRequest request{.label = {}, .background = background_of(scene_)};
  return render(run_.exec(), model_->cloud, scene_.views[view].camera, splat_options({}, model_->cloud, scene_),
                request);
}

ImageF SceneChecks::photo(std::size_t view) {
  ImageF photo = photos_.load(view);
  if (!model_ || !io::has_mask_in_photo(scene_.views[view])) return photo;
  const ImageF behind = rendered(view).colour, alpha = io::load_alpha(scene_.views[view]);
  for (std::size_t i = 0; i < photo.data.size(); ++i)
    photo.data[i] += (1 - alpha.data[i / 3]) * (behind.data[i] - photo.data[i]);
  return photo;
}

bool SceneChecks::choose_background_of_transparent_photos() {
  const auto timed = run_.monitor().scope("transparency");
  if (std::none_of(compared_.begin(), compared_.end(),
                   [&](std::size_t view) { return io::photo_is_transparent(scene_, view); }))
    return false;
  double psnr[2] = {0, 0};
  const double level[2] = {0, 1};
  for (const int k : {0, 1}) {
    scene_.background = Vec3<double>{level[k], level[k], level[k]};
    if (model_)
      psnr[k] = psnr_over_background(run_.exec(), model_->cloud, scene_, compared_,
                                     [&](std::size_t view) { return io::load_photo(scene_, view); });
  }
  const bool white = psnr[1] > psnr[0] + kBackgroundMarginDb;
  if (!white) scene_.background = Vec3<double>{0, 0, 0};
  if (!model_) scene_.background.reset();
  notes_.push_back(std::string("photos are transparent; they are composed over ") + (white ? "white" : "black") +
                   (model_ ? ", which fits the model better" : " since there is no model to compare with") +
                   "; --background " + (white ? "black" : "white") + " selects the other");
  if (model_) run_.result()["background"] = {{"black_psnr_db", psnr[0]}, {"white_psnr_db", psnr[1]}};
  return true;
}

void SceneChecks::check(bool compat_is_default) {
  const SceneLoaders loaders{[this](std::size_t view) { return photo(view); },
                             [this](std::size_t view) {
                               io::LoadedMasks loaded = io::load_masks_with_notes(scene_, view);
                               return MaskSample{std::move(loaded.masks), std::move(loaded.notes), loaded.lossy};
                             }};
  for (const std::string& note : notes_) run_.monitor().warn(note);  // also if the check fails: notes may explain it
  const SceneCheck result = check_scene(run_.exec(), run_.monitor(), options_,
                                        {model_ ? &model_->cloud : nullptr, scene_, loaders, compat_is_default});
  scene_.compat = result.compat;
  scene_.world_unit = result.world_unit;
  for (const std::string& warning : result.warnings) run_.monitor().warn(warning);
  run_.result().update(check_json(scene_, result));
  run_.text(check_table(scene_, result));
  lost_masks_ = result.uniform_masks.contradicted;
}

void SceneChecks::leave_out_lost_masks() {
  for (const std::size_t view : lost_masks_) scene_.views[view].mask_path.clear();
}

void SceneChecks::find_filter(double given_px2) {
  if (given_px2 > 0) scene_.filter_px2 = given_px2;
  if (given_px2 > 0 || !model_) return;
  const auto timed = run_.monitor().scope("filter");
  const FilterProbe probe = probe_filter(run_.exec(), run_.monitor(), photographed(), compared_);
  for (const FilterCandidate& c : probe.candidates)
    run_.result()["filter"].push_back({{"filter_px2", c.filter_px2}, {"psnr_db", c.psnr_db}});
  scene_.filter_px2 = probe.filter_px2;
}

void SceneChecks::align_views(bool for_background) {
  if (!model_) return;
  std::vector<std::size_t> background_from;
  if (for_background) background_from = background_views(options_, scene_);
  const auto alignment = measure_alignment(run_.exec(), run_.monitor(), photographed(), background_from);
  apply_alignment(alignment, scene_);
  for (const ViewAlignment& a : alignment) {
    run_.result()["view_alignment"].push_back({{"view", scene_.views[a.view].camera.name},
                                               {"flow_px", a.flow_px},
                                               {"turn_rad", triple(a.motion.turn)},
                                               {"move_world", triple(a.motion.move)},
                                               {"error_before", a.error_before},
                                               {"error_after", a.error_after},
                                               {"applied", a.applied}});
    if (a.background) measurements_.push_back(*a.background);
  }
}

void SceneChecks::find_background() {
  if (!model_) return;
  const auto timed = run_.monitor().scope("background");
  const BackgroundFinding found =
      measurements_.empty()
          ? ngs::find_background(run_.exec(), run_.monitor(), photographed(), background_views(options_, scene_))
          : ngs::find_background(measurements_);
  scene_.background = found.colour;
  run_.result()["background"] = {{"found", found.colour.has_value()}, {"fitted", triple(found.fitted)},
                                 {"error", triple(found.error)},      {"shown", found.shown},
                                 {"gain_db", found.gain_db},          {"views", found.views}};
  if (found.colour) run_.info("the photos show a background of " + background_text(background_of(scene_)));
}

void check_renders(cli::Run& run, const SceneCheckOptions& checks, io::ImportedScene& imported) {
  run.warn_unused({"--align-views", "--background", "--compat", "--antialias", "--filter-px2"},
                  "with renders of the model, whose settings are kept");
  run.result()["photos"] = kRenderedPhotosNote;
  SceneChecks scene(run, checks, imported.scene, std::move(imported.notes));
  scene.check();
  scene.leave_out_lost_masks();
}

int check_command(int argc, char** argv) {
  cli::Tool tool("ngs-scene check", "Check that cameras, model, photos and masks of a scene belong together.",
                 {"ngs-scene check scene.json --sheet masks.html",
                  "ngs-scene check scene.json --check-views 100000 --report check.json"});
  SceneCheckOptions checks;
  tool.options(checks);
  const cli::Input& scene_json = tool.input("scene", "scene.json written by ngs-scene import");
  const cli::Output& sheet =
      tool.optional_output("--sheet", "HTML page with every input mask over its photo, to check before a run");

  return tool.run(argc, argv, [&](cli::Run& run) {
    Scene scene = cli::read_scene(run, scene_json.path);
    run.result()["views"] = scene.views.size();
    if (run.dry_run()) {
      run.plan({{"views", scene.views.size()}, {"compared_views", checks.check_views}});
      return cli::kDone;
    }
    SceneChecks(run, checks, scene, {}).check();
    if (sheet) write_sheet(run, scene, sheet.path);
    return cli::kDone;
  });
}

}  // namespace ngs::scene_tool
