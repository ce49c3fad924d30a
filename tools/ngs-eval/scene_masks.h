#pragma once
// The masks of a scene.json: the true masks, and the input masks, which can be scored against them.
#include <optional>
#include <string>
#include <vector>

#include "evaluation.h"
#include "ngs/scene/scene.h"

namespace ngs::cli {

/// True for a JSON file, which is a scene.json instead of a folder of masks.
bool is_scene_file(const std::string& path);

/// The held-out views of a scene, or all views if none is held out, with the folder of true masks recorded by ngs-scene
/// import. Without such a folder the input masks of held-out views are the truth: no stage reads them.
class SceneMasks {
 public:
  explicit SceneMasks(const std::string& path);

  /// Why nothing can be scored; empty: `truth()` has masks.
  std::string problem() const;
  /// Why the input masks cannot be scored; empty: they can. Call after complete().
  std::string problem_of_inputs(const EvalOptions& options) const;
  bool inputs_are_truth() const { return truth_dir_.empty(); }
  ImageList truth() const;
  /// With the file names that ngs-render gives to masks.
  ImageList input_masks() const;
  /// Sets the views and the layout of `files`. For label maps, fills missing ids and a missing void id of `options`.
  void complete(EvalOptions& options, EvalFileOptions& files) const;

 private:
  Scene scene_;
  std::string truth_dir_;
  std::vector<std::size_t> views_;
  bool held_out_ = false;
};

struct Masks {
  ImageList predicted, truth;
};

/// Completes `options` and `files` from the scene. Empty if nothing can be scored and --allow-empty is given.
std::optional<Masks> masks_of_scene(Run& run, const std::string& predicted, const std::string& scene_json,
                                    EvalOptions& options, EvalFileOptions& files);

}  // namespace ngs::cli
