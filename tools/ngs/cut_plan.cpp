#include "cut_plan.h"

#include <algorithm>

#include "shared/text/text_columns.h"

namespace ngs::ngs_tool {
namespace {

/// Times of ngs-joint, as of the other steps measured on splats of some 80,000 Gaussians with 29 pictures.
double joint_share(Quality quality) {
  switch (quality) {
    case Quality::kDraft: return 12;
    case Quality::kStandard: return 60;
    case Quality::kHigh: return 150;
    case Quality::kReference: return 400;
  }
  return 60;
}

void add_masks_of_strokes(const CutOptions& options, const CutInputs& inputs, std::vector<PlannedStep>& steps) {
  if (inputs.has_renders) steps.push_back({"first look", "finding the object", "ngs cut", "marked/", 5, true});
  const double share = options.quality == Quality::kDraft ? 12 : 30;
  steps.push_back({"ngs-mask", "outlining the object in the pictures", "ngs-mask", "strokes/", share, true});
}

}  // namespace

std::vector<PlannedStep> planned_steps(const CutOptions& options, const CutInputs& inputs, const PlanFacts& facts) {
  std::vector<PlannedStep> steps;
  if (inputs.kind == SourceKind::kSplat && !facts.reuses_pictures)
    steps.push_back({"ngs-scene", "making pictures of the splat", "ngs-scene", "orbit/images/, orbit/sheet.jpg", 5});
  if (inputs.kind == SourceKind::kCapture)
    steps.push_back({"ngs-scene", "reading the capture", "ngs-scene", "capture.json", 3});
  if (!facts.marked && !facts.has_masks) return steps;
  if (options.method == CutMethod::kFlash) {
    steps.push_back(
        {"flash", "finding the object", "ngs cut", "object.ply, background.ply, labelled.ply, masks/", 5, true});
    if (options.mends_halves())
      steps.push_back({"ngs-extract", "mending both halves", "ngs-extract", "object.ply, background-filled.ply", 2});
    steps.push_back({"ngs-report", "writing the pages", "ngs-report", "report.html, object.html", 3});
    return steps;
  }
  if (facts.marked) add_masks_of_strokes(options, inputs, steps);
  steps.push_back({"ngs-variance", "finding the splats on the edge", "ngs-variance", "boundary.ply", 4});
  steps.push_back(
      {"ngs-joint", "sharpening the edge", "ngs-joint", "labelled.ply", joint_share(options.quality), true});
  steps.push_back({"ngs-extract", "writing the object", "ngs-extract", "object.ply, background.ply", 4});
  steps.push_back({"ngs-render", "drawing the masks of the result", "ngs-render", "masks/", 4});
  if (inputs.truth.empty() && facts.marked) {
    steps.push_back({"ngs-eval-agreement", "comparing the result with its masks", "ngs-eval", "agreement.json", 2});
  } else if (!inputs.truth.empty() || !options.hold_out.empty()) {
    steps.push_back({"ngs-render-alone", "drawing the object alone", "ngs-render", "", 1});
    steps.push_back({"ngs-eval", "scoring the result", "ngs-eval", "metrics.json", 2});
  }
  steps.push_back({"ngs-report", "writing the pages", "ngs-report", "report.html, object.html", 4});
  return steps;
}

std::string plan_text(const std::vector<PlannedStep>& steps, const std::string& out) {
  int words = 0, tool = 0;
  for (const PlannedStep& step : steps)
    words = std::max(words, cli::columns_of(step.words)), tool = std::max(tool, cli::columns_of(step.tool));
  std::string text = "steps, with their files in " + out + "/:\n";
  for (std::size_t k = 0; k < steps.size(); ++k)
    text += cli::padded(std::to_string(k + 1) + ".", 4) + cli::padded(steps[k].words, words + 2) +
            cli::padded(steps[k].tool, tool + 2) + steps[k].files + "\n";
  return text;
}

}  // namespace ngs::ngs_tool
