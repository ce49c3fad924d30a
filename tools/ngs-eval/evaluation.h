#pragma once
// The work of ngs-eval between files and metrics.json.
#include <string>
#include <utility>
#include <vector>

#include "image_list.h"
#include "ngs/stages/eval/eval_stage.h"
#include "shared/run/run.h"

namespace ngs::cli {

/// A view may itself lie in folders (cam0/0001), an object does not.
enum class Layout : std::uint8_t { kViewObject, kObjectView, kView };

struct EvalFileOptions {
  std::string views = "all";
  Layout layout = Layout::kViewObject;
  bool image_metrics = false, opacity = false, allow_missing = false;
  std::vector<std::string> scene_views = {};  // no option: names of the views to score, in place of `views`

  static constexpr NamedValue<Layout> kLayouts[] = {
      {Layout::kViewObject, "view/object"}, {Layout::kObjectView, "object/view"}, {Layout::kView, "view"}};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.views, Text{"views", "all|every:N:K|FILE",
                           "which views to score: all, index % N == K of the truth's "
                           "sorted names, or a file of names"});
    visit(self.layout, Choice<Layout>{"layout",
                                      "what the sub-folders of a nested folder are; view: parts of the views' names, "
                                      "as the cameras of a rig",
                                      kLayouts});
    visit(self.image_metrics, Flag{"image_metrics", "the files are photos: PSNR and SSIM instead of mask scores"});
    visit(self.opacity, Flag{"opacity",
                             "the files are opacities of an object rendered alone: its halo and its holes instead of "
                             "mask scores"});
    visit(self.allow_missing, Flag{"allow_missing", "with --fail-below: true masks without a prediction fail nothing"});
  }
};

struct FilePair {
  std::string view, object, predicted, truth;  // the last two are paths
  std::uint32_t truth_id = 0;                  // EvalPair::truth_id
};

struct Pairing {
  std::vector<FilePair> pairs;
  std::vector<std::pair<std::string, int>> matched_by;  // rule, how many
  std::vector<std::string> predicted_only, truth_only;  // of the selected views
  std::vector<std::string> listed_only;                 // names of a --views file that the truth lacks
};

/// Throws kInconsistent where nothing matches.
Pairing pair_files(const ImageList& predicted, const ImageList& truth, const EvalFileOptions& options);

/// For a folder of predicted masks per object against true label maps; the folders are named like `ids`, or
/// by number. Throws kUsage where the id of a folder is not known.
Pairing pair_objects(const ImageList& predicted, const ImageList& truth, const EvalFileOptions& options,
                     const ObjectIds& ids);
/// How many folders its names begin with.
int depth(const ImageList& list);

struct PhotoScore {
  std::string view;
  double psnr_db = 0, ssim = 0;  // equal photos count as kEqualPsnrDb
};
inline constexpr double kEqualPsnrDb = 100;

std::vector<PairScore> score_masks(Run& run, const EvalOptions& options, const std::vector<FilePair>& pairs);
std::vector<PhotoScore> score_photos(Run& run, const std::vector<FilePair>& pairs);

}  // namespace ngs::cli
