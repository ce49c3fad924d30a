#include "cut_chain.h"

#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/core/version.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/content_hash.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/options/name_of.h"
#include "ngs/scene/view_names.h"
#include "painted_pictures.h"

namespace ngs::front {
namespace {

namespace fs = std::filesystem;

constexpr int kWholePicture_px = 1 << 20;
constexpr double kWorseMargin =
    0.01;  // tolerated increase of wrong stroke pixels by training, as a fraction of all stroke pixels

bool exists(const std::string& path) {
  std::error_code unreadable;
  return !path.empty() && fs::exists(path, unreadable);
}

void append(Words& words, const std::string& flag, const std::string& value) {
  if (!value.empty()) words.push_back(flag), words.push_back(value);
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
  if (!make_scene()) return CutEnd::kStopped;  // may find strokes painted into its images
  const bool marked = !inputs_.strokes.empty();
  if (options_.quality == CutQuality::kFlash) {
    if (!marked) return CutEnd::kNeedsStrokes;
    return cut_flash() ? CutEnd::kDone : CutEnd::kStopped;
  }
  if (marked && !masks_from_strokes()) return CutEnd::kStopped;
  if (run_.dry_run()) return cut(), score(), CutEnd::kDone;
  if (!marked && inputs_.masks.empty() && !has_masks(io::read_scene_json(plain_scene_))) return CutEnd::kNeedsStrokes;
  write_scene_with(marked ? at("strokes") : inputs_.masks);
  return cut() && score() ? CutEnd::kDone : CutEnd::kStopped;
}

bool CutChain::stage(const std::string& name, const Words& words) {
  const bool marked = !inputs_.strokes.empty();
  const bool makes_scene = inputs_.kind != SourceKind::kScene && !reused_orbit_;
  const bool only_pictures = inputs_.kind == SourceKind::kSplat && !marked && inputs_.masks.empty();
  const bool scored = marked || !inputs_.truth.empty();
  constexpr std::size_t kAlways = 5;  // variance, joint, extract, render, report
  stages_.expect(only_pictures ? 1 : std::size_t(makes_scene) + std::size_t(marked) + kAlways + std::size_t(scored));
  return stages_.run(name, words);
}

bool CutChain::make_scene() {
  switch (inputs_.kind) {
    case SourceKind::kSplat: return orbit();
    case SourceKind::kCapture: return import();
    case SourceKind::kScene: break;
  }
  plain_scene_ = inputs_.source;
  return true;
}

/// Reuses the images of an earlier run if model, options and version are unchanged, because strokes were drawn on them.
bool CutChain::orbit() {
  plain_scene_ = at("orbit/scene.json");
  Words words{"ngs-scene", "orbit", inputs_.source, "-o", plain_scene_};
  append(words, "--around", options_.around);
  append(words, "--up", options_.up == "auto" ? "" : options_.up);
  append(words, "--size", options_.size);
  append(words, "--views", options_.views > 0 ? std::to_string(options_.views) : "");
  append(words, "--hold-out", options_.hold_out);
  append(words, "--max-views", options_.quality == CutQuality::kFlash ? most_flash_views(options_.views) : "");
  Json key{{"version", kVersion}, {"options", Words(words.begin() + 5, words.end())}};
  const std::string key_file = at("orbit/made_from.json");
  if (!run_.dry_run()) {
    const PaintedPictures painted = rescue_painted(pictures(), at("orbit/pictures.json"), at("painted"));
    for (const std::string& name : painted.unknown)
      run_.monitor().warn(pictures() + "/" + name + ": called like no image of the splat, not read; if it is painted, " +
                          "name it after its image or pass it with --strokes and --view");
    for (const std::string& name : painted.beside)
      run_.monitor().warn(pictures() + "/" + name + ": strokes are read from it (a copy: " + at("painted/") + name + ")");
    for (const std::string& name : painted.in_place)
      run_.monitor().warn(pictures() + "/" + name + ": was painted on; its strokes are read from a copy, " +
                          at("painted/") + name + ", and the image is rendered again");
    inputs_.strokes = strokes_on_copies(inputs_.strokes, pictures(), at("painted"), painted);
    std::error_code absent;
    if (!painted.in_place.empty()) fs::remove(key_file, absent);
    key["model"] = io::content_hash(inputs_.source).xxh3;
    if (exists(plain_scene_) && exists(key_file) && io::read_json_file(key_file) == nlohmann::json(key))
      return reused_orbit_ = true;
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
  if (inputs_.strokes.empty() && inputs_.masks.empty()) inputs_.masks = masks_in(inputs_.source);
  if (inputs_.truth.empty()) inputs_.truth = truth_in(inputs_.source);
  if (const std::string unused = masks_in(inputs_.source); !inputs_.strokes.empty() && !unused.empty())
    run_.monitor().warn(unused + ": not used because strokes are given");
  Words words{
      "ngs-scene", "import", inputs_.source, "-o", plain_scene_, "--image-scale", std::to_string(options_.image_scale)};
  append(words, "--ply", inputs_.model);
  append(words, "--hold-out", options_.hold_out);
  append(words, "--masks", inputs_.strokes.empty() ? inputs_.masks : "");
  if (!inputs_.strokes.empty()) words.emplace_back("--no-check-polarity");  // the masks are not used
  append(words, "--images", inputs_.images);
  append(words, "--world-transform", inputs_.world_transform);
  words.insert(words.end(), inputs_.import_words.begin(), inputs_.import_words.end());
  inputs_.masks.clear();  // the scene has their paths
  return stage("ngs-scene", words);
}

std::optional<FlashCut> CutChain::flash(const io::GaussianPly& ply, int longer_side_px) {
  return flash_cut(
      run_, ply, {plain_scene_, options_.around, options_.view, inputs_.strokes, options_.all_pieces, longer_side_px});
}

bool CutChain::cut_flash() {
  if (run_.dry_run()) return true;
  const double start_s = wall_seconds();
  const io::GaussianPly ply = [&] {
    const auto timed = run_.monitor().scope("read");
    return io::read_gaussian_ply(inputs_.source);
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
  flash_ = found->figures;
  flash_->wall_s = wall_seconds() - start_s;
  return true;
}

/// For a splat without photos: the result of --quality flash, with masks of the images' size. False: stopped by a
/// signal.
bool CutChain::cut_untrained() {
  const auto timed = run_.monitor().scope("first look");
  const io::GaussianPly ply = io::read_gaussian_ply(inputs_.source);
  try {
    untrained_ = flash(ply, kWholePicture_px);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::kNothingFound) throw;  // segmentation of the images may still find the object
    return true;
  }
  if (!untrained_) return false;
  if (untrained_->is_expected) render_masks_from_labels(run_, ply.cloud, *untrained_);
  untrained_wrong_ = StrokeCheck(run_, plain_scene_, options_.view, inputs_.strokes)
                         .of(ply.cloud, untrained_->labels.label.values(), true)
                         .wrong_share();
  return true;
}

bool CutChain::masks_from_strokes() {
  if (inputs_.kind == SourceKind::kSplat && !run_.dry_run()) {
    if (!cut_untrained()) return false;
    if (untrained_ && untrained_->is_expected) return write_flash_masks(at("strokes"), *untrained_), true;
  }
  Words words{"ngs-mask", plain_scene_, "-o", at("strokes")};
  if (options_.quality == CutQuality::kDraft) append(words, "--passes", "1");
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
    scene.mask_mode = MaskMode::kBinary, scene.mask_invert = false, scene.mask_threshold = 128;
    scene.objects = {SceneObject{}};
  }
  io::write_scene_json(at("scene.json"), scene);
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
  if (!found.broken.empty() && untrained_ && untrained_wrong_ < found.wrong_share()) {
    write_flash_masks(at("strokes"), *untrained_);
    if (!stage("ngs-variance", {"ngs-variance", at("scene.json"), "-o", at("boundary.ply")})) return false;
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
  if (!stage("ngs-variance", {"ngs-variance", scene, "-o", at("boundary.ply")})) return false;
  if (marked && !run_.dry_run() && !check_strokes()) return false;
  if (!stage("ngs-joint",
             {"ngs-joint", scene, at("boundary.ply"), "--quality",
              std::string(name_of(kCutQualities, options_.quality)), "--trace", at("trace.jsonl"), "-o", trained}) ||
      !extract(trained))
    return false;
  if (run_.dry_run()) return true;
  if (marked) keep_better_result();
  if (options_.keep) return true;
  for (const char* intermediate : {"boundary.ply", "joint.ply", "trace.jsonl"}) fs::remove(at(intermediate));
  return true;
}

/// With strokes only the components that they touch are written, and labels are rounded, so that masks and page show
/// the written object.
bool CutChain::extract(const std::string& trained) {
  Words words{"ngs-extract", trained, "--object", at("object.ply"), "--background", at("background.ply")};
  if (!inputs_.strokes.empty()) append(words, "--labelled", at("labelled.ply"));
  if (!inputs_.strokes.empty() && !options_.all_pieces) {
    append(words, "--scene", at("scene.json"));
    append(words, "--view", options_.view);
    for (const std::string& strokes : inputs_.strokes) append(words, "--strokes", strokes);
  }
  return stage("ngs-extract", words);
}

/// Writes the untrained result if the trained one agrees less with the strokes.
void CutChain::keep_better_result() {
  if (!untrained_ || untrained_->figures.object == 0) return;
  const double wrong = [&] {
    const io::GaussianPly ply = io::read_gaussian_ply(at("labelled.ply"), {io::HigherBands::kCheckOnly});
    return StrokeCheck(run_, at("scene.json"), options_.view, inputs_.strokes)
        .of(ply.cloud, ply.labels.label.values(), true)
        .wrong_share();
  }();
  run_.result()["strokes_wrong"] = {{"trained", wrong}, {"first", untrained_wrong_}};
  if (wrong <= untrained_wrong_ + kWorseMargin) return;
  kept_untrained_ = true;
  write_flash_models(run_, inputs_.out, io::read_gaussian_ply(inputs_.source), untrained_->labels);
}

/// Scores masks of the result against the true masks if given, else against the input masks.
bool CutChain::score() {
  const bool held_out = !options_.hold_out.empty();
  std::error_code ignored;
  if (!run_.dry_run()) fs::remove_all(at("masks"), ignored);
  if (!stage("ngs-render", {"ngs-render", at("scene.json"), at("labelled.ply"), "--layers", "mask", "--scale", "0",
                            "--format", "png", "--views", held_out ? "held-out" : "all", "-o", at("masks")}))
    return false;
  if (!run_.dry_run())
    for (const char* scores : {"metrics.json", "agreement.json"}) fs::remove(at(scores), ignored);
  if (!inputs_.truth.empty()) {
    if (!stage("ngs-eval", {"ngs-eval", at("masks"), inputs_.truth, "-o", at("metrics.json")})) return false;
  } else if (!inputs_.strokes.empty()) {
    if (!stage("ngs-eval-agreement", {"ngs-eval", at("masks"), at("strokes"), "-o", at("agreement.json")}))
      return false;
  }
  return stage("ngs-report", {"ngs-report", inputs_.out, "-o", at("report.html")});
}

}  // namespace ngs::front
