#pragma once
// The masks that a scene.json names: the truth, and the input masks that may be scored against it.
#include <string>
#include <vector>

#include "evaluation.h"
#include "ngs/scene/scene.h"

namespace ngs::cli {

/// True for a JSON file: a scene.json in place of a folder of masks.
bool is_scene_file(const std::string& path);

/// The held-out views of a scene, or all views where none is held out, with the folder of true masks that ngs-scene
/// import recorded. Without such a folder the input masks of held-out views are the truth: no stage has read them.
class SceneMasks {
 public:
  explicit SceneMasks(const std::string& path);

  /// Why nothing can be scored; empty: `truth()` has masks.
  std::string problem() const;
  /// Why the input masks themselves cannot be scored; empty: they can. `options` after complete().
  std::string problem_of_inputs(const EvalOptions& options) const;
  bool inputs_are_truth() const { return truth_dir_.empty(); }
  ImageList truth() const;
  /// Named as ngs-render names its masks.
  ImageList input_masks() const;
  /// Label maps: the ids and the void id of the scene where `options` has none. Sets the views and the layout of
  /// `files`.
  void complete(EvalOptions& options, EvalFileOptions& files) const;

 private:
  Scene scene_;
  std::string truth_dir_;
  std::vector<std::size_t> views_;
  bool held_out_ = false;
};

}  // namespace ngs::cli
