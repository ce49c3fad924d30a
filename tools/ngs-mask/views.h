#pragma once
// Views at the size used for segmentation, and their resulting masks.
#include <map>
#include <string>

#include "ngs/cut/masks/mask_spread.h"
#include "ngs/options/field.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/hand_prompt.h"
#include "segmenters.h"
#include "shared/run/run.h"

namespace ngs::cli {

struct ViewOptions {
  std::string view;
  int detail = 2;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.view, Text{"view", "NAME", "Picture of the prompts; default: the name in each file"});
    visit(self.detail, Field<int>{"detail", "",
                                  "Size of the masks: at most this many times the scene's working size, and "
                                  "at most that of the photos",
                                  1, 16});
  }
};

class MaskViews {
 public:
  /// Reads the headers of the photos; photos of held-out views may be missing. Each view is segmented at up to `detail`
  /// times the camera's size.
  MaskViews(const Scene& scene, int detail);

  const std::vector<Camera>& cameras() const { return cameras_; }
  const std::vector<bool>& has_photo() const { return has_photo_; }
  /// Largest size of a view over the scene's working size.
  double scale() const { return scale_; }
  ImageU8 photo(std::size_t view) const;

  /// The marks at the sizes used for segmentation. Reports and prints the fraction of each view that they cover.
  /// kInconsistent for a marked view without a photo.
  std::map<std::size_t, ViewPrompt> rasterised(Run& run,
                                               const std::map<std::size_t, std::vector<HandPrompt>>& marks) const;

  std::string file_in(const std::string& folder, std::size_t view) const;
  /// Throws kUsage if a mask in one of the folders (empty: none) would replace a photo.
  void refuse_over_photos(const std::vector<std::string>& folders) const;
  /// Stores the pictures of a view until finish(), so that an aborted run does not change existing masks.
  void store(Run& run, std::size_t view, const SpreadView& result, const std::string& masks, const std::string& soft);
  Json plan(const GaussianCloud& cloud, int passes) const;
  /// Writes the pictures, then prints the table and warnings and reports the counts.
  void finish(Run& run);

 private:
  const Scene& scene_;
  int detail_;
  std::vector<std::string> file_names_;  // [views] names of the masks
  double scale_ = 1;
  std::vector<Camera> cameras_;
  std::vector<bool> has_photo_;
  struct Outcome {
    MaskSource source;
    double agreement, known, coverage;
  };
  std::map<std::size_t, Outcome> outcome_;
  struct Picture {
    std::string file;
    std::vector<std::uint8_t> png;
  };
  std::vector<Picture> pictures_;
};

// --everything: id maps of all masks in each photo, by a program or from annotations of another tool.

struct EverythingInput {
  const SegmenterOptions& segmenter;
  int detail;
  std::string scene, annotations, output;  // paths; annotations: empty without
};

/// Writes STEM.png, 16 bit, for every view with a photo, or with annotations. Nothing is written before the last view
/// is done. kUsage without a program or annotations, and with both; kNothingFound without a mask.
int make_everything(Run& run, const EverythingInput& input);

}  // namespace ngs::cli
