#pragma once
// Pairs the files of ngs-eval and scores the pairs.
#include <string>
#include <utility>
#include <vector>

#include "ngs/eval/eval_stage.h"
#include "ngs/io/image/image_file.h"
#include "shared/run/run.h"

namespace ngs::cli {

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

}  // namespace ngs::cli
