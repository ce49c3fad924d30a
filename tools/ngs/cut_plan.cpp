#include "cut_plan.h"

#include <algorithm>

#include "flash_cut.h"
#include "ngs/options/name_of.h"
#include "shared/text/layout.h"

namespace ngs::ngs_tool {
namespace {

using Option = std::pair<const char*, std::string>;

/// The words, and those of the options that have a value.
Words with(Words words, const std::vector<Option>& options) {
  for (const auto& [flag, value] : options)
    if (!value.empty()) words.insert(words.end(), {flag, value});
  return words;
}

/// The words with the options of ngs-extract that clip the object and fill the background, as far as chosen.
Words mending(Words words, const CutOptions& options, const CutInputs& inputs) {
  if (!options.finish) words.emplace_back("--no-finish");
  if (options.all || options.fill.fill == FillKind::kOff) return words;
  return with(std::move(words), {{"--background-filled", inputs.out + "/background-filled.ply"},
                                 {"--fill", std::string(name_of(kFillNames, options.fill.fill))}});
}

class Planner {
 public:
  Planner(const CutOptions& options, const CutInputs& inputs, const PlanFacts& facts)
      : options_(options), inputs_(inputs), facts_(facts), scene_(plain_scene(options, inputs)) {}

  std::vector<PlannedStep> steps() {
    const bool flash = options_.method == CutMethod::kFlash && !all_;
    if (inputs_.kind == SourceKind::kSplat && !facts_.reuses_pictures)
      add({"ngs-scene", "making pictures of the splat", orbit(), "orbit/images/, orbit/sheet.jpg", 5});
    if (inputs_.kind == SourceKind::kCapture) add({"ngs-scene", "reading the capture", import(), "capture.json", 3});
    if (!all_ && !facts_.marked && (flash || !facts_.has_masks)) return std::move(steps_);
    if (all_) add({"ngs-group", "finding the objects", group(), "groups/, objects.json", 10});
    if (flash) {
      add({"flash", "finding the object", {}, "object.ply, background.ply, labelled.ply, masks/", 5, true});
      if (options_.mends_halves())
        add({"ngs-extract", "mending both halves", mending_command(options_, inputs_),
             "object.ply, background-filled.ply", 2});
    } else {
      if (facts_.marked) add_masks_of_strokes();
      add_training();
      if (!all_) add_scores();
    }
    if (options_.mesh && !all_)
      add({"ngs-mesh", "making the mesh",
           with({"ngs-mesh", at("object.ply"), "--background", at("background.ply"), "-o", at("mesh.glb")},
                {{"--collider", options_.collider},
                 {"--up", up()},
                 {"--unit", options_.unit == 1 ? "" : Json(options_.unit).dump()}}),
           "mesh.glb", 8});
    const Words report = all_ ? Words{} : Words{"ngs-report", inputs_.out, "-o", at("report.html")};
    add({all_ ? "page" : "ngs-report", "writing the pages", report, all_ ? "report.html" : "report.html, object.html",
         4});
    return std::move(steps_);
  }

 private:
  void add(PlannedStep step) { steps_.push_back(std::move(step)); }
  std::string at(const std::string& name) const { return inputs_.out + "/" + name; }
  std::string up() const { return options_.up == UpAxis::kAuto ? "" : std::string(name_of(kUpNames, options_.up)); }

  void add_masks_of_strokes() {
    if (inputs_.has_renders) add({"first look", "finding the object", {}, "marked/", 5, true});
    const bool is_draft = options_.quality == Quality::kDraft;
    Words words = with({"ngs-mask", scene_, "-o", at("strokes")},
                       {{"--passes", is_draft ? "1" : ""},
                        {"--model", inputs_.kind == SourceKind::kScene ? inputs_.model : ""},
                        {"--view", options_.view}});
    for (const std::string& strokes : inputs_.strokes) words.insert(words.end(), {"--prompts", strokes});
    add({"ngs-mask", "outlining the object in the pictures", words, "strokes/", is_draft ? 12.0 : 30.0, true});
  }

  void add_training() {
    // Times of ngs-joint, as of the other steps measured on splats of some 80,000 Gaussians with 29 pictures.
    constexpr double kJoint_s[] = {12, 60, 150, 400};  // by quality
    const bool closed_form = all_ && !inputs_.trains_all;
    const std::string trained = at(facts_.marked ? "joint.ply" : "labelled.ply");
    add({"ngs-variance", "finding the splats on the edge", variance(), "boundary.ply", 4});
    add({"ngs-joint", closed_form ? "labelling the splats" : "sharpening the edge",
         with({"ngs-joint", at("scene.json"), at("boundary.ply"), "-o", trained},
              {{"--trace", all_ ? "" : at("trace.jsonl")},
               {"--method", closed_form ? "flash" : ""},
               {"--quality", closed_form ? "" : std::string(name_of(kQualityNames, options_.quality))}}),
         "labelled.ply", closed_form ? 2 : kJoint_s[int(options_.quality)], !closed_form});
    add({"ngs-extract", all_ ? "writing the objects" : "writing the object", extract(trained),
         all_ ? "objects/, background.ply" : "object.ply, background.ply", 4});
    add({"ngs-render", "drawing the masks of the result", render("labelled.ply", all_ ? "labels" : "mask", "masks"),
         "masks/", 4});
  }

  /// Against the true masks; without true masks, against the masks from strokes or the input masks of held-out views.
  void add_scores() {
    if (inputs_.truth.empty() && facts_.marked) {
      const Words words{"ngs-eval", at("masks"), at("strokes"), "-o", at("agreement.json")};
      add({"ngs-eval-agreement", "comparing the result with its masks", words, "agreement.json", 2});
    } else if (!inputs_.truth.empty() || !options_.hold_out.empty()) {
      add({"ngs-render-alone", "drawing the object alone", render("object.ply", "alpha", "alone"), "", 1});
      const Words words{"ngs-eval", at("masks"), at("scene.json"), "-o", at("metrics.json"), "--allow-empty"};
      add({"ngs-eval", "scoring the result",
           with(words, {{"--alone", facts_.one_object.value_or(true) ? at("alone") : ""}}), "metrics.json", 2});
    }
  }

  Words orbit() const {
    return with({"ngs-scene", "orbit", inputs_.splat(), "-o", scene_},
                {{"--cameras", inputs_.renders_capture ? inputs_.source : ""},
                 {"--around", options_.around},
                 {"--up", up()},
                 {"--place", all_ && !inputs_.renders_capture ? "near" : ""},
                 {"--size", options_.size},
                 {"--view-count", options_.view_count > 0 ? std::to_string(options_.view_count) : ""},
                 {"--hold-out", options_.hold_out},
                 {"--max-views", max_views(options_)}});
  }

  Words import() const {
    Words words = with({"ngs-scene", "import", inputs_.source, "-o", scene_},
                       {{"--image-scale", Json(options_.image_scale).dump()},
                        {"--ply", inputs_.model},
                        {"--hold-out", options_.hold_out},
                        {"--masks", facts_.marked ? "" : inputs_.masks},
                        {"--truth", inputs_.truth},
                        {"--images", inputs_.images},
                        {"--world-transform", inputs_.world_transform}});
    if (facts_.marked || all_) words.emplace_back("--no-check-polarity");  // not used, or ids of no object
    if (all_ && facts_.has_masks) words.insert(words.end(), {"--mask-mode", "label", "--object-id", "everything=1"});
    words.insert(words.end(), inputs_.import_words.begin(), inputs_.import_words.end());
    return words;
  }

  Words group() const {  // of a capture, masks are those of its import
    Words words = with({"ngs-group", scene_, "-o", at("groups")},
                       {{"--masks", inputs_.kind == SourceKind::kCapture ? "" : inputs_.masks}});
    if (!facts_.has_masks) words.emplace_back("--without-masks");
    return words;
  }

  Words variance() const {  // masks from strokes are checked against the strokes instead
    const double least = all_ || facts_.marked ? -1 : options_.agreement.min_mask_agreement;
    const bool is_default = least == MaskAgreementOptions{}.min_mask_agreement;
    return with({"ngs-variance", at("scene.json"), "-o", at("boundary.ply")},
                {{"--min-mask-agreement", is_default ? "" : Json(least).dump()}});
  }

  /// With strokes only the components that they touch are written, and labels are rounded, so that masks and page show
  /// the written object.
  Words extract(const std::string& trained) const {
    const bool one_of_all = all_ && facts_.one_object.value_or(false);  // folders are for several objects only
    const bool by_strokes = facts_.marked && !options_.all_pieces;
    Words words = with({"ngs-extract", trained, "--scene", at("scene.json"), "--background-ply", at("background.ply")},
                       {{"--objects", one_of_all ? "" : at("objects")},
                        {"--object-ply", one_of_all ? at("objects/001.ply")
                                         : all_     ? ""
                                                    : at("object.ply")},
                        {"--labelled", facts_.marked ? at("labelled.ply") : ""},
                        {"--view", by_strokes ? options_.view : ""}});
    for (const std::string& strokes : by_strokes ? inputs_.strokes : Words{})
      words.insert(words.end(), {"--strokes", strokes});
    return mending(std::move(words), options_, inputs_);
  }

  Words render(const std::string& model, const std::string& layer, const std::string& folder) const {
    return with({"ngs-render", at("scene.json"), at(model), "--layers", layer, "--format", "png", "-o", at(folder)},
                {{"--views", all_ || options_.hold_out.empty() ? "all" : "held-out"}, {"--scale", all_ ? "" : "0"}});
  }

  const CutOptions& options_;
  const CutInputs& inputs_;
  const PlanFacts& facts_;
  const bool all_ = options_.all;
  const std::string scene_;
  std::vector<PlannedStep> steps_;
};

}  // namespace

std::vector<PlannedStep> planned_steps(const CutOptions& options, const CutInputs& inputs, const PlanFacts& facts) {
  return Planner(options, inputs, facts).steps();
}

std::string plain_scene(const CutOptions& options, const CutInputs& inputs) {
  if (inputs.kind == SourceKind::kSplat) return inputs.out + "/orbit/scene.json";
  const bool has_copy = options.all && !inputs.model.empty();  // with another model
  return inputs.kind == SourceKind::kScene && !has_copy ? inputs.source : inputs.out + "/capture.json";
}

Words mending_command(const CutOptions& options, const CutInputs& inputs) {
  const std::string& out = inputs.out;
  return mending(
      {"ngs-extract", out + "/labelled.ply", "--scene", out + "/scene.json", "--object-ply", out + "/object.ply"},
      options, inputs);
}

std::string tool_of(const PlannedStep& step) { return step.command.empty() ? "ngs cut" : step.command[0]; }

std::string plan_text(const std::vector<PlannedStep>& steps, const std::string& out) {
  int about = 0, tool = 0;
  for (const PlannedStep& step : steps) {
    about = std::max(about, cli::columns_of(step.about));
    tool = std::max(tool, cli::columns_of(tool_of(step)));
  }
  std::string text = "steps, with their files in " + out + "/:\n";
  for (std::size_t k = 0; k < steps.size(); ++k)
    text += cli::padded(std::to_string(k + 1) + ".", 4) + cli::padded(steps[k].about, about + 2) +
            cli::padded(tool_of(steps[k]), tool + 2) + steps[k].files + "\n";
  return text;
}

}  // namespace ngs::ngs_tool
