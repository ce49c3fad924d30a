#pragma once
// The one plan of ngs cut: its steps in their order, with the command of each. `ngs cut -n` prints it, CutChain runs it
// (run_step() has what happens in this process around a step), and tests/contract compares pipelines/ngs-gs.sh with it.
//
//   OUT/orbit/       a splat: scene.json and images/, the pictures that strokes are made on, and sheet.jpg, all of them
//   OUT/capture.json a capture: its cameras, photos and model
//   OUT/marked/      the marked views with their strokes
//   OUT/strokes/     masks from strokes, STEM.png
//   OUT/scene.json   the one that is cut: cameras, pictures and masks
//   OUT/groups/      --all: label maps with one id per object, their scene, and what is known of each object
//   OUT/labelled.ply object.ply background.ply masks/STEM.png agreement.json or metrics.json, report.html,
//                  object.html, mesh.glb
//
// With --method flash only orbit/, marked/, the models, masks/ and the pages (flash_cut.h).
#include <optional>
#include <string>
#include <vector>

#include "cut_inputs.h"

namespace ngs::ngs_tool {

using Words = std::vector<std::string>;

struct PlannedStep {
  std::string name;         // of its report
  std::string about;        // for people: "sharpening the edge"
  Words command;            // the tool and its arguments; empty: done in this process
  std::string files;        // what it writes, relative to the output folder
  double share = 1;         // expected time in seconds, of a small splat
  bool has_passes = false;  // its progress restarts
};

struct PlanFacts {
  bool marked = false;                  // there are strokes
  bool has_masks = false;               // of the scene, of the capture, or given
  bool reuses_pictures = false;         // of an earlier run
  std::optional<bool> one_object = {};  // known after ngs-group or ngs-extract
};

/// The steps in the order in which they run. If there are none, or only pictures, strokes or masks are missing.
std::vector<PlannedStep> planned_steps(const CutOptions& options, const CutInputs& inputs, const PlanFacts& facts);

/// A table of the steps: number, words, tool, files.
std::string plan_text(const std::vector<PlannedStep>& steps, const std::string& out);

/// "ngs-joint"; "ngs cut": in this process.
std::string tool_of(const PlannedStep& step);

/// The scene file with cameras and images, before masks are added.
std::string plain_scene(const CutOptions& options, const CutInputs& inputs);

/// ngs-extract that clips the object and fills the background of an untrained result.
Words mending_command(const CutOptions& options, const CutInputs& inputs);

}  // namespace ngs::ngs_tool
