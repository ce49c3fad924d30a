#include "cut_chain.h"

#include <algorithm>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/core/version.h"
#include "ngs/io/capture/capture_source.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/content_hash.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/render/render_options.h"
#include "ngs/scene/view_names.h"

namespace ngs::ngs_tool {
namespace {

namespace fs = std::filesystem;

constexpr int kWholePicture_px = 1 << 20;
constexpr const char* kMadeFrom = "orbit/made_from.json";  // with this record the pictures are complete

bool has_masks(const Scene& scene) {
  for (const SceneView& view : scene.views)
    if (!view.mask_path.empty()) return true;
  return false;
}

}  // namespace

CutChain::CutChain(cli::Run& run, const CutOptions& options, CutInputs inputs)
    : run_(run),
      options_(options),
      inputs_(std::move(inputs)),
      stages_(run, inputs_.out, run.exec().threads, inputs_.own_flags) {}

CutEnd CutChain::run() {
  if (inputs_.kind == SourceKind::kCapture && inputs_.model.empty()) require_model_in(inputs_.source);
  if (inputs_.kind == SourceKind::kScene && inputs_.truth.empty())
    inputs_.truth = io::truth_of_scene_json(inputs_.source);
  plan();
  if (inputs_.kind == SourceKind::kSplat) take_pictures_of_earlier_run();
  if (run_.dry_run()) {
    const bool has_views = exists(plain_scene()) && (inputs_.kind != SourceKind::kSplat || facts_.reuses_pictures);
    if (marked())
      strokes_found_ =
          strokes_text(run_, has_views ? plain_scene() : "", options_.view, not_in_folder(inputs_.strokes, pictures()));
    return needs_strokes() ? CutEnd::kNeedsStrokes : CutEnd::kDone;
  }
  const bool makes_scene = !stages_.steps().empty() && stages_.steps()[0].name == "ngs-scene";
  if (makes_scene && !run_step(PlannedStep(stages_.steps()[0]))) return CutEnd::kStopped;
  if (needs_strokes()) {
    refuse_unfit_masks();
    return CutEnd::kNeedsStrokes;
  }
  // Reads the strokes before anything is computed from them, and draws them on their views.
  if (marked()) write_marked_views(run_, {plain_scene(), options_.view, inputs_.strokes}, at("marked"));
  for (std::size_t k = makes_scene ? 1 : 0; k < stages_.steps().size(); ++k)  // a step may change later ones
    if (!run_step(PlannedStep(stages_.steps()[k]))) return CutEnd::kStopped;
  return CutEnd::kDone;
}

/// Must be called again when strokes or a fact become known. A capture is assumed to have masks until it is imported.
/// --all ignores masks found in a capture, because they are of one object.
void CutChain::plan() {
  facts_.marked = marked();
  facts_.has_masks = !(options_.all ? inputs_.given_masks : inputs_.masks).empty();
  if (inputs_.kind == SourceKind::kScene) {
    const Scene scene = io::read_scene_json(inputs_.source);
    facts_.has_masks |= has_masks(scene) && (!options_.all || scene.mask_mode == MaskMode::kLabel);
  }
  if (inputs_.kind == SourceKind::kCapture && !options_.all)
    facts_.has_masks |= !imported_ || has_masks(io::read_scene_json(plain_scene()));
  stages_.plan(planned_steps(options_, inputs_, facts_));
}

bool CutChain::needs_strokes() const { return stages_.steps().empty() || stages_.steps().back().name == "ngs-scene"; }

bool CutChain::run_step(const PlannedStep& step) {
  if (step.command.empty()) stages_.begin(step.name);
  if (step.name == "flash") return cut_flash();
  if (step.name == "first look") return cut_untrained();
  if (step.name == "page") return write_objects_page(), true;
  if (step.name == "ngs-mask" && untrained_ && untrained_->is_expected)
    return write_flash_masks(at("strokes"), *untrained_), true;
  if (step.name == "ngs-render-alone" || step.name == "ngs-eval") return score_by_truth(step);
  before(step.name);
  return stages_.run(step) && after(step.name);
}

void CutChain::before(const std::string& step) {
  std::error_code absent;
  if (step == "ngs-scene" && inputs_.kind == SourceKind::kSplat) {
    fs::create_directories(at("orbit"));
    fs::remove(at(kMadeFrom), absent);
  }
  if (step == "ngs-group" && inputs_.kind == SourceKind::kScene && plain_scene() != inputs_.source)
    write_scene(inputs_.source, plain_scene(), "");  // another model than its own
  if (step == "ngs-variance" && !options_.all)
    write_scene(plain_scene(), at("scene.json"), marked() ? at("strokes") : inputs_.masks);
  if (step == "ngs-extract") fs::remove_all(at("objects"), absent);  // of an earlier run
  if (step == "ngs-render") fs::remove_all(at("masks"), absent);
}

bool CutChain::after(const std::string& step) {
  if (step == "ngs-scene" && inputs_.kind == SourceKind::kSplat) {
    record_pictures(pictures(), at("orbit/pictures.json"));
    io::write_file(at(kMadeFrom), pictures_of_.dump(1) + "\n");
  }
  if (step == "ngs-scene" && inputs_.kind == SourceKind::kCapture) take_capture();
  if (step == "ngs-group") take_groups();
  if (step == "ngs-variance" && marked()) return check_strokes();
  if (step == "ngs-joint" && untrained_ && untrained_->is_expected)
    keep_boundary_labels(at("joint.ply"), untrained_->labels);
  if (step == "ngs-extract") {
    if (!keep_better_result()) return false;
    if (!options_.all) {
      facts_.one_object = !exists(at("objects"));
      plan();
    }
    for (const char* intermediate : {"boundary.ply", "joint.ply", "trace.jsonl"})
      if (!options_.keep) fs::remove(at(intermediate));
  }
  if (step == "ngs-render" && !options_.all) {
    std::error_code absent;
    for (const char* scores : {"metrics.json", "agreement.json"}) fs::remove(at(scores), absent);
    agreement_ = compare_with_masks(io::read_scene_json(at("scene.json")), at("masks"));
  }
  return true;
}

/// Whether the pictures are those of an earlier run with the same options and, unless it is a dry run, the same model
/// and cameras.
bool CutChain::has_same_pictures() const {
  if (!exists(plain_scene()) || !exists(at(kMadeFrom))) return false;
  nlohmann::json made = io::read_json_file(at(kMadeFrom));
  for (const char* hash : {"model", "cameras"})
    if (run_.dry_run() && made.is_object()) made.erase(hash);
  return made == nlohmann::json(pictures_of_);
}

/// Reuses the images of an earlier run if model, options and version are unchanged, because strokes were drawn on them.
void CutChain::take_pictures_of_earlier_run() {
  const Words& words = stages_.steps()[0].command;
  pictures_of_ = {{"version", kVersion}, {"options", Words(words.begin() + 5, words.end())}};
  if (!run_.dry_run()) {
    const PaintedPictures painted = rescue_painted(pictures(), at("orbit/pictures.json"), at("painted"));
    for (const std::string& name : painted.unknown)
      run_.monitor().warn(pictures() + "/" + name +
                          ": called like no image of the splat, not read; if it is painted, " +
                          "name it after its image or pass it with --strokes and --view");
    for (const std::string& name : painted.other_format)
      run_.monitor().warn(pictures() + "/" + name + ": strokes are read from it (a copy: " + at("painted/") + name +
                          ")");
    for (const std::string& name : painted.in_place)
      run_.monitor().warn(pictures() + "/" + name + ": was painted on; its strokes are read from a copy, " +
                          at("painted/") + name + ", and the image is rendered again");
    inputs_.strokes = strokes_on_copies(inputs_.strokes, pictures(), at("painted"), painted);
    std::error_code absent;
    if (!painted.in_place.empty()) fs::remove(at(kMadeFrom), absent);
    pictures_of_["model"] = io::content_hash(inputs_.splat()).xxh3;
    io::CaptureRequest cameras;
    cameras.source = inputs_.source;
    if (inputs_.renders_capture) pictures_of_["cameras"] = io::content_hash(io::read_capture(cameras).file).xxh3;
  }
  facts_.reuses_pictures = has_same_pictures();
  plan();
}

void CutChain::take_capture() {
  inputs_.masks.clear();  // the scene has their paths
  inputs_.truth = io::truth_of_scene_json(plain_scene());
  imported_ = true;
  plan();
  if (marked()) leave_masks_unused();
}

std::optional<FlashCut> CutChain::flash(const io::GaussianPly& ply, int longer_side_px) {
  return flash_cut(
      run_, ply, {plain_scene(), options_.around, options_.view, inputs_.strokes, options_.all_pieces, longer_side_px});
}

bool CutChain::cut_flash() {
  const double start_s = wall_seconds();
  const io::GaussianPly ply = [&] {
    const auto timed = run_.monitor().scope("read");
    return io::read_gaussian_ply(inputs_.splat());
  }();
  const std::optional<FlashCut> found = flash(ply, 0);
  if (!found) return false;
  if (found->figures.object == 0)
    run_.nothing_found("no Gaussian of the ball is labelled as object with these strokes",
                       "draw more strokes on the object");
  const StrokeAgreement kept_to = StrokeCheck(run_, plain_scene(), options_.view, inputs_.strokes)
                                      .of(ply.cloud, found->labels.label.values(), true);
  if (!kept_to.broken.empty()) run_.monitor().warn(broken_text(kept_to));
  const auto timed = run_.monitor().scope("write");
  write_flash_masks(at("masks"), *found);
  write_flash_models(run_, inputs_.out, ply, found->labels);
  remove_results_of_training();
  write_scene(plain_scene(), at("scene.json"), "");
  flash_ = found->figures;
  flash_->wall_s = wall_seconds() - start_s;
  return true;
}

/// Removes results of training by an earlier run, which the page would show as results of this run.
void CutChain::remove_results_of_training() const {
  std::error_code ignored;
  for (const char* name : {"metrics.json", "agreement.json", "trace.jsonl", "boundary.ply", "strokes"})
    fs::remove_all(at(name), ignored);
  for (const PlannedStep& step : planned_steps({}, inputs_, {.marked = true, .has_masks = true}))
    for (const char* ending : {".json", ".sh"})
      if (step.name != "ngs-scene") fs::remove(at("reports/" + step.name + ending), ignored);
}

/// Without photos: the labels of --method flash, and masks of the images' size. False: stopped by a
/// signal.
bool CutChain::cut_untrained() {
  const auto timed = run_.monitor().scope("first look");
  const io::GaussianPly ply = io::read_gaussian_ply(inputs_.splat());
  try {
    untrained_ = flash(ply, kWholePicture_px);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::kNothingFound) throw;  // segmentation of the images may still find the object
    return true;
  }
  if (!untrained_) return false;
  if (untrained_
          ->is_expected) {  // on large pictures fewer Gaussians are hidden, which the expected object labels better
    std::optional<FlashCut> small = flash(ply, 0);
    if (!small) return false;
    untrained_->labels = std::move(small->labels);
    untrained_->figures = small->figures;
  }
  untrained_quality_ = quality_of(ply.cloud, untrained_->labels.label.values(), untrained_->segmented);
  if (untrained_->is_expected) render_masks_from_labels(run_, ply.cloud, *untrained_);
  return true;
}

/// Agreement of labels with the strokes and with `masks`, which have the views and sizes of the untrained result.
ResultQuality CutChain::quality_of(const GaussianCloud& cloud, const std::vector<float>& label,
                                   const std::vector<PixelMask>& masks) const {
  const StrokeAgreement strokes =
      StrokeCheck(run_, plain_scene(), options_.view, inputs_.strokes).of(cloud, label, true);
  return {strokes.wrong_share(), agreement_in_views(run_, cloud, label, *untrained_, masks)};
}

/// The masks that the trained result stems from: the segmented ones of the untrained result, or those of ngs-mask.
std::vector<PixelMask> CutChain::masks_of_training() const {
  return untrained_->is_expected ? untrained_->segmented : read_flash_masks(at("strokes"), *untrained_);
}

/// `masks`: a folder with STEM.png for some views; empty: keep the masks of the scene.
void CutChain::write_scene(const std::string& from, const std::string& to, const std::string& masks) const {
  Scene scene = io::read_scene_json(from);
  if (!inputs_.model.empty()) scene.model_path = inputs_.model;
  if (!masks.empty()) {
    const std::vector<std::string> names = output_names(scene.views);
    std::size_t found = 0;
    for (std::size_t v = 0; v < names.size(); ++v) {
      const std::string path = masks + "/" + names[v] + ".png";
      scene.views[v].mask_path = exists(path) ? path : "";
      found += exists(path);
    }
    if (found == 0)
      throw Error(ErrorCode::kInconsistent, masks + ": no mask of any view, expected for example " + names[0] + ".png",
                  "name masks after the images");
    scene.use_binary_masks();
    scene.objects = {SceneObject{}};
  }
  const std::string truth = inputs_.truth.empty() ? io::truth_of_scene_json(from) : inputs_.truth;
  io::write_scene_json(to, scene, io::StoredPaths::kRelative, truth);
}

/// Checks the initial labels against the strokes. Throws kInconsistent if they contradict a stroke, without --force.
/// False: stopped by a signal.
bool CutChain::check_strokes() {
  const StrokeCheck check(run_, at("scene.json"), options_.view, inputs_.strokes);
  const auto now = [&] {
    const auto timed = run_.monitor().scope("strokes");
    const io::GaussianPly ply = io::read_gaussian_ply(at("boundary.ply"), {io::HigherBands::kCheckOnly});
    return check.of(ply.cloud, ply.labels.label.values(), options_.all_pieces);
  };
  StrokeAgreement found = now();
  if (!found.broken.empty() && untrained_ && untrained_quality_.strokes_wrong < found.wrong_share()) {
    write_flash_masks(at("strokes"), *untrained_);
    if (!stages_.run(*std::ranges::find(stages_.steps(), "ngs-variance", &PlannedStep::name))) return false;
    found = now();
  }
  if (found.broken.empty()) return true;
  const std::string what = broken_text(found);
  if (!options_.force)
    throw Error(ErrorCode::kInconsistent, what + ", expected labels that agree with every stroke",
                "mark another view too: add --strokes FILE; or continue with --force");
  run_.monitor().warn(what);
  return true;
}

/// Writes the untrained result if the trained one agrees less with the strokes, or less with the masks of its views
/// than the untrained one with its own. False: stopped by a signal.
bool CutChain::keep_better_result() {
  if (!untrained_ || untrained_->figures.object == 0) return true;
  const ResultQuality trained = [&] {
    const io::GaussianPly ply = io::read_gaussian_ply(at("labelled.ply"), {io::HigherBands::kCheckOnly});
    return quality_of(ply.cloud, ply.labels.label.values(), masks_of_training());
  }();
  const ResultQuality& first = untrained_quality_;
  run_.result()["strokes_wrong"] = {{"trained", trained.strokes_wrong}, {"first", first.strokes_wrong}};
  run_.result()["view_agreement"] = {{"trained", trained.agreement}, {"first", first.agreement}};
  if (!is_worse(trained, first)) return true;
  kept_untrained_ = true;
  write_flash_models(run_, inputs_.out, io::read_gaussian_ply(inputs_.splat()), untrained_->labels);
  return !options_.mends_halves() || stages_.run({"ngs-extract", "", mending_command(options_, inputs_), ""});
}

}  // namespace ngs::ngs_tool
