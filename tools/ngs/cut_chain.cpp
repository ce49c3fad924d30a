#include "cut_chain.h"

#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/core/version.h"
#include "ngs/io/capture/capture_source.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/content_hash.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/options/name_of.h"
#include "ngs/render/render_options.h"
#include "ngs/scene/view_names.h"

namespace ngs::ngs_tool {
namespace {

namespace fs = std::filesystem;

constexpr int kWholePicture_px = 1 << 20;

void append(Words& words, const std::string& flag, const std::string& value) {
  if (!value.empty()) words.push_back(flag), words.push_back(value);
}

/// Clips the object and fills the background in ngs-extract, as far as chosen.
void append_mending(Words& words, const CutOptions& options, const CutChain& chain) {
  if (!options.finish) words.emplace_back("--no-finish");
  if (options.fill.fill == FillKind::kOff) return;
  append(words, "--background-filled", chain.at("background-filled.ply"));
  append(words, "--fill", std::string(name_of(kFillNames, options.fill.fill)));
}

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
  plan();
  if (!make_scene()) return CutEnd::kStopped;  // may find strokes painted into its images
  if (options_.all) return cut_all() ? CutEnd::kDone : CutEnd::kStopped;
  const bool marked = !inputs_.strokes.empty();
  if (marked) look_at_strokes();
  if (options_.method == CutMethod::kFlash) {
    if (!marked) return CutEnd::kNeedsStrokes;
    return cut_flash() && write_page() ? CutEnd::kDone : CutEnd::kStopped;
  }
  if (run_.dry_run() && stages_.steps().size() < 2) return CutEnd::kNeedsStrokes;
  if (marked && !masks_from_strokes()) return CutEnd::kStopped;
  if (run_.dry_run()) return cut(), score(), CutEnd::kDone;
  if (!marked && inputs_.masks.empty() && !has_masks(io::read_scene_json(plain_scene_))) {
    refuse_unfit_masks();
    return CutEnd::kNeedsStrokes;
  }
  write_scene_with(marked ? at("strokes") : inputs_.masks);
  return cut() && score() ? CutEnd::kDone : CutEnd::kStopped;
}

/// Call it again if the strokes, the reuse of pictures or the files of the capture become known. Until the capture is
/// imported, it is expected to have masks.
void CutChain::plan() {
  PlanFacts facts{!inputs_.strokes.empty(), !inputs_.masks.empty(), reused_orbit_};
  if (inputs_.kind == SourceKind::kScene) facts.has_masks |= has_masks(io::read_scene_json(inputs_.source));
  if (inputs_.kind == SourceKind::kCapture)
    facts.has_masks |= !imported_ || has_masks(io::read_scene_json(plain_scene_));
  stages_.plan(planned_steps(options_, inputs_, facts));
}

/// Reads the strokes before anything is computed from them, and draws them on their views. A dry run only lists them.
void CutChain::look_at_strokes() {
  if (!run_.dry_run()) return write_marked_views(run_, {plain_scene_, options_.view, inputs_.strokes}, at("marked"));
  const bool has_views = exists(plain_scene_) && (inputs_.kind != SourceKind::kSplat || reused_orbit_);
  strokes_found_ =
      strokes_text(run_, has_views ? plain_scene_ : "", options_.view, not_in_folder(inputs_.strokes, pictures()));
}

bool CutChain::make_scene() {
  switch (inputs_.kind) {
    case SourceKind::kSplat: return orbit();
    case SourceKind::kCapture: return import();
    case SourceKind::kScene: break;
  }
  plain_scene_ = inputs_.source;
  if (inputs_.truth.empty()) inputs_.truth = io::truth_of_scene_json(plain_scene_);
  return true;
}

/// Whether the pictures are those of an earlier run with the same options and, unless it is a dry run, the same model
/// and cameras.
bool CutChain::has_same_pictures(const Json& key) const {
  const std::string key_file = at("orbit/made_from.json");
  if (!exists(plain_scene_) || !exists(key_file)) return false;
  nlohmann::json made = io::read_json_file(key_file);
  for (const char* hash : {"model", "cameras"})
    if (run_.dry_run() && made.is_object()) made.erase(hash);
  return made == nlohmann::json(key);
}

/// Reuses the images of an earlier run if model, options and version are unchanged, because strokes were drawn on them.
bool CutChain::orbit() {
  plain_scene_ = at("orbit/scene.json");
  Words words{"ngs-scene", "orbit", inputs_.splat(), "-o", plain_scene_};
  if (inputs_.renders_capture) append(words, "--cameras", inputs_.source);
  append(words, "--around", options_.around);
  append(words, "--up", options_.up == "auto" ? "" : options_.up);
  append(words, "--size", options_.size);
  append(words, "--view-count", options_.view_count > 0 ? std::to_string(options_.view_count) : "");
  append(words, "--hold-out", options_.hold_out);
  append(words, "--max-views", max_views(options_));
  Json key{{"version", kVersion}, {"options", Words(words.begin() + 5, words.end())}};
  const std::string key_file = at("orbit/made_from.json");
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
    if (!painted.in_place.empty()) fs::remove(key_file, absent);
    key["model"] = io::content_hash(inputs_.splat()).xxh3;
    io::CaptureRequest cameras;
    cameras.source = inputs_.source;
    if (inputs_.renders_capture) key["cameras"] = io::content_hash(io::read_capture(cameras).file).xxh3;
  }
  reused_orbit_ = has_same_pictures(key);
  plan();
  if (reused_orbit_) return true;
  if (!run_.dry_run()) {
    fs::create_directories(at("orbit"));
    std::error_code ignored;
    fs::remove(key_file, ignored);
  }
  if (!stage("ngs-scene", words)) return false;
  if (run_.dry_run()) return true;
  record_pictures(pictures(), at("orbit/pictures.json"));
  io::write_file(key_file, key.dump(1) + "\n");
  return true;
}

bool CutChain::import() {
  plain_scene_ = at("capture.json");
  if (inputs_.model.empty()) require_model_in(inputs_.source);
  Words words{
      "ngs-scene", "import", inputs_.source, "-o", plain_scene_, "--image-scale", std::to_string(options_.image_scale)};
  append(words, "--ply", inputs_.model);
  append(words, "--hold-out", options_.hold_out);
  append(words, "--masks", inputs_.strokes.empty() ? inputs_.masks : "");
  if (!inputs_.strokes.empty()) words.emplace_back("--no-check-polarity");  // the masks are not used
  if (options_.all)  // label maps whose ids are not those of objects
    words.insert(words.end(), {"--mask-mode", "label", "--object-id", "everything=1", "--no-check-polarity"});
  append(words, "--truth", inputs_.truth);
  append(words, "--images", inputs_.images);
  append(words, "--world-transform", inputs_.world_transform);
  words.insert(words.end(), inputs_.import_words.begin(), inputs_.import_words.end());
  inputs_.masks.clear();  // the scene has their paths
  if (!stage("ngs-scene", words)) return false;
  if (run_.dry_run()) return true;
  inputs_.truth = io::truth_of_scene_json(plain_scene_), imported_ = true;
  plan();
  if (!inputs_.strokes.empty()) leave_masks_unused();
  return true;
}

std::optional<FlashCut> CutChain::flash(const io::GaussianPly& ply, int longer_side_px) {
  return flash_cut(
      run_, ply, {plain_scene_, options_.around, options_.view, inputs_.strokes, options_.all_pieces, longer_side_px});
}

bool CutChain::cut_flash() {
  if (run_.dry_run()) return true;
  stages_.begin("flash");
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
  const StrokeAgreement kept_to =
      StrokeCheck(run_, plain_scene_, options_.view, inputs_.strokes).of(ply.cloud, found->labels.label.values(), true);
  if (!kept_to.broken.empty()) run_.monitor().warn(broken_text(kept_to));
  const auto timed = run_.monitor().scope("write");
  write_flash_masks(at("masks"), *found);
  write_flash_models(run_, inputs_.out, ply, found->labels);
  remove_results_of_training();
  write_scene_with("");
  flash_ = found->figures;
  flash_->wall_s = wall_seconds() - start_s;
  return finish_untrained();
}

/// The folder may hold an earlier run of another quality; its page would show these as results of this run.
void CutChain::remove_results_of_training() const {
  std::error_code ignored;
  for (const char* name : {"metrics.json", "agreement.json", "trace.jsonl", "boundary.ply", "strokes"})
    fs::remove_all(at(name), ignored);
  for (const PlannedStep& step : planned_steps({}, inputs_, {.marked = true, .has_masks = true}))
    for (const char* ending : {".json", ".sh"})
      if (step.name != "ngs-scene") fs::remove(at("reports/" + step.name + ending), ignored);
}

bool CutChain::write_page() { return stage("ngs-report", {"ngs-report", inputs_.out, "-o", at("report.html")}); }

/// Without photos: the labels of --method flash, and masks of the images' size. False: stopped by a
/// signal.
bool CutChain::cut_untrained() {
  stages_.begin("first look");
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
    untrained_->labels = std::move(small->labels), untrained_->figures = small->figures;
  }
  untrained_quality_ = quality_of(ply.cloud, untrained_->labels.label.values(), untrained_->segmented);
  if (untrained_->is_expected) render_masks_from_labels(run_, ply.cloud, *untrained_);
  return true;
}

/// Agreement of labels with the strokes and with `masks`, which have the views and sizes of the untrained result.
ResultQuality CutChain::quality_of(const GaussianCloud& cloud, const std::vector<float>& label,
                                   const std::vector<PixelMask>& masks) const {
  const StrokeAgreement strokes =
      StrokeCheck(run_, plain_scene_, options_.view, inputs_.strokes).of(cloud, label, true);
  return {strokes.wrong_share(), agreement_in_views(run_, cloud, label, *untrained_, masks)};
}

/// The masks that the trained result stems from: the segmented ones of the untrained result, or those of ngs-mask.
std::vector<PixelMask> CutChain::masks_of_training() const {
  return untrained_->is_expected ? untrained_->segmented : read_flash_masks(at("strokes"), *untrained_);
}

bool CutChain::masks_from_strokes() {
  if (inputs_.has_renders && !run_.dry_run()) {
    if (!cut_untrained()) return false;
    if (untrained_ && untrained_->is_expected) return write_flash_masks(at("strokes"), *untrained_), true;
  }
  Words words{"ngs-mask", plain_scene_, "-o", at("strokes")};
  if (options_.quality == Quality::kDraft) append(words, "--passes", "1");
  if (inputs_.kind == SourceKind::kScene) append(words, "--model", inputs_.model);
  append(words, "--view", options_.view);
  for (const std::string& strokes : inputs_.strokes) append(words, "--prompts", strokes);
  return stage("ngs-mask", words);
}

/// `masks`: a folder with STEM.png for some views; empty: keep the masks of the scene.
void CutChain::write_scene_with(const std::string& masks) const {
  Scene scene = io::read_scene_json(plain_scene_);
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
  const std::string truth = inputs_.truth.empty() ? io::truth_of_scene_json(plain_scene_) : inputs_.truth;
  io::write_scene_json(at("scene.json"), scene, io::StoredPaths::kRelative, truth);
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
    if (!label()) return false;
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

bool CutChain::cut() {
  const std::string scene = at("scene.json");
  const bool marked = !inputs_.strokes.empty();
  const std::string trained = at(marked ? "joint.ply" : "labelled.ply");
  if (!label()) return false;
  if (marked && !run_.dry_run() && !check_strokes()) return false;
  if (!stage("ngs-joint",
             {"ngs-joint", scene, at("boundary.ply"), "--quality",
              std::string(name_of(kQualityNames, options_.quality)), "--trace", at("trace.jsonl"), "-o", trained}))
    return false;
  if (untrained_ && untrained_->is_expected) keep_boundary_labels(trained, untrained_->labels);
  if (!extract(trained)) return false;
  if (run_.dry_run()) return true;
  if (marked) keep_better_result();
  if (kept_untrained_ && !finish_untrained()) return false;
  if (options_.keep) return true;
  for (const char* intermediate : {"boundary.ply", "joint.ply", "trace.jsonl"}) fs::remove(at(intermediate));
  return true;
}

/// With strokes only the components that they touch are written, and labels are rounded, so that masks and page show
/// the written object.
bool CutChain::extract(const std::string& trained) {
  std::error_code absent;
  if (!run_.dry_run()) fs::remove_all(at("objects"), absent);  // of an earlier run
  Words words{"ngs-extract",    trained,     "--scene",     at("scene.json"),   "--object-ply",
              at("object.ply"), "--objects", at("objects"), "--background-ply", at("background.ply")};
  if (!inputs_.strokes.empty()) append(words, "--labelled", at("labelled.ply"));
  if (!inputs_.strokes.empty() && !options_.all_pieces) {
    append(words, "--view", options_.view);
    for (const std::string& strokes : inputs_.strokes) append(words, "--strokes", strokes);
  }
  append_mending(words, options_, *this);
  return stage("ngs-extract", words);
}

/// Clips the object and fills the background of an untrained result, which is written without ngs-extract. False:
/// stopped by a signal.
bool CutChain::finish_untrained() {
  if (!options_.mends_halves()) return true;
  Words words{"ngs-extract", at("labelled.ply"), "--scene", at("scene.json"), "--object-ply", at("object.ply")};
  append_mending(words, options_, *this);
  return stage("ngs-extract", words);
}

/// Writes the untrained result if the trained one agrees less with the strokes, or less with the masks of its views
/// than the untrained one with its own.
void CutChain::keep_better_result() {
  if (!untrained_ || untrained_->figures.object == 0) return;
  const ResultQuality trained = [&] {
    const io::GaussianPly ply = io::read_gaussian_ply(at("labelled.ply"), {io::HigherBands::kCheckOnly});
    return quality_of(ply.cloud, ply.labels.label.values(), masks_of_training());
  }();
  const ResultQuality& first = untrained_quality_;
  run_.result()["strokes_wrong"] = {{"trained", trained.strokes_wrong}, {"first", first.strokes_wrong}};
  run_.result()["view_agreement"] = {{"trained", trained.agreement}, {"first", first.agreement}};
  if (!is_worse(trained, first)) return;
  kept_untrained_ = true;
  write_flash_models(run_, inputs_.out, io::read_gaussian_ply(inputs_.splat()), untrained_->labels);
}

}  // namespace ngs::ngs_tool
