#pragma once
// Pairs the files of ngs-eval and scores the pairs.
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ngs/eval/eval_stage.h"
#include "ngs/io/image/image_file.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/scene/scene.h"
#include "shared/run/run.h"

namespace ngs::cli {

inline constexpr int kMetricsVersion = 1;  // of metrics.json

/// The images of a folder, or a single file, with names relative to the folder.
struct ImageList {
  std::string folder;                   // base of the names
  std::vector<std::string> names;       // sorted; "view.png" or, below folders, "sub/view.png"
  std::vector<std::string> files = {};  // their paths; empty: they are in `folder`
  std::string path(std::size_t i) const { return files.empty() ? folder + "/" + names[i] : files[i]; }
};

/// Images directly in the folder, or, if there are none, those of its sub-folders, up to three levels deep. Skips
/// hidden entries. Throws kBadInput if there is no image.
ImageList list_images(const std::string& path);

/// A view name may contain folders (cam0/0001), an object name does not.
enum class Layout : std::uint8_t { kViewObject, kObjectView, kView };

struct EvalFileOptions {
  std::string views = "all";
  Layout layout = Layout::kViewObject;
  bool image_metrics = false, opacity = false, halves = false, instances = false, allow_missing = false;
  std::vector<std::string> scene_views = {};  // no option: names of the views to score, in place of `views`

  static constexpr NamedValue<Layout> kLayouts[] = {
      {Layout::kViewObject, "view/object"}, {Layout::kObjectView, "object/view"}, {Layout::kView, "view"}};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.views, Text{"views", "all|every:N:K|FILE",
                           "Views to score: all, index % N == K of the truth's sorted names, or a file of names"});
    visit(
        self.layout,
        Choice<Layout>{"layout", "Meaning of sub-folders; view: parts of the view names, such as the cameras of a rig",
                       kLayouts});
    visit(self.image_metrics, Flag{"image_metrics", "Score photos by PSNR and SSIM instead of masks"});
    visit(self.opacity,
          Flag{"opacity", "Score opacities of an object rendered alone: its halo and its holes instead of masks"});
    visit(self.halves,
          Flag{"halves", "Score object.ply and background.ply against the truth of ngs-synth --truth halves"});
    visit(self.instances,
          Flag{"instances",
               "Score all objects of id maps whatever their ids: panoptic quality and average precision of the scene"});
    visit(self.allow_missing, Flag{"allow_missing", "With --fail-below: do not fail if true masks have no prediction"});
  }
};

struct FilePair {
  std::string view, object, predicted, truth;  // predicted, truth: paths
  std::uint32_t truth_id = 0;                  // EvalPair::truth_id
};

struct Pairing {
  std::vector<FilePair> pairs;
  std::vector<std::pair<std::string, int>> matched_by;  // rule, number of pairs
  std::vector<std::string> predicted_only, truth_only;  // names in the selected views
  std::vector<std::string> listed_only;                 // names in the --views file without a true mask
};

/// Throws kInconsistent if nothing matches.
Pairing pair_files(const ImageList& predicted, const ImageList& truth, const EvalFileOptions& options);

/// Pairs one folder of predicted masks per object with true label maps. Folders are named as in `ids`, or by number.
/// Throws kUsage if the id of a folder is unknown.
Pairing pair_objects(const ImageList& predicted, const ImageList& truth, const EvalFileOptions& options,
                     const ObjectIds& ids);
/// Number of folders in the names.
int depth(const ImageList& list);

struct PhotoScore {
  std::string view;
  double psnr_db = 0, ssim = 0;  // kEqualPsnrDb for equal photos
};

std::vector<PairScore> score_masks(Run& run, const EvalOptions& options, const std::vector<FilePair>& pairs);
/// Samples of a mask or a label map, an image or the EXR of ngs-render.
io::RawMask read_mask(const std::string& path, bool is_label_map);
std::vector<PhotoScore> score_photos(Run& run, const std::vector<FilePair>& pairs);

// Scores of the opacity of an object rendered alone against its true silhouettes (ops/image/metrics.h).

struct OpacityScore {
  std::string view;
  OpacityErrors errors;
};

/// Throws kUsage if true label maps are given without the id of one object.
void require_one_object(const EvalOptions& options);

/// In label maps, pixels of other objects are ignored, because they may occlude the object. Views without a contour of
/// the object have no score. Throws kNothingFound if no view has a contour.
std::vector<OpacityScore> score_opacities(Run& run, const EvalOptions& options, const std::vector<FilePair>& pairs);

Json opacity_metrics_json(const std::vector<OpacityScore>& scores);
/// Mean scores by name, halo_1px to holes_5px.
std::map<std::string, double> mean_scores(const std::vector<OpacityScore>& scores);
std::string opacity_table(const std::vector<OpacityScore>& scores);

// ngs-eval --halves: scores object.ply and background.ply against the folder of ngs-synth --truth halves.

struct HalvesInput {
  std::string cut;     // folder with object.ply, background.ply or both
  std::string truth;   // folder with object/ and background/
  std::string model;   // the uncut model; empty: none
  std::string output;  // metrics.json
};

/// Throws kUsage for options that contradict --halves; warns about unused ones, also of a run without --halves.
void check_halves_options(Run& run, const EvalOptions& options, const EvalFileOptions& files);

/// Scores the models of the folder, writes the output and shows a table.
void score_halves(Run& run, const HalvesInput& input);

// The masks of a scene.json: the true masks, and the input masks, which can be scored against them.

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
