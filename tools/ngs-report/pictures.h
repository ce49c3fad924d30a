#pragma once
// Photos with the outlines of masks drawn over them: JPEG data URIs under inline SVG, sharp at any zoom.
#include <string>

#include "run_folder.h"

namespace ngs::cli {

struct PictureOptions {
  int sheet_width_px = 360, crop_side_px = 96;
  double budget_mib = 4.2;  // of picture bytes for the whole page
  int zoomed_views = 4;
};

/// Hands out figures until the budget of the page is spent.
class Pictures {
 public:
  explicit Pictures(const PictureOptions& options) : options_(options) {}

  /// The contact sheet of a run, worst views first, and zoomed crops of the worst. Unreadable pictures are
  /// added to `run.problems`.
  std::string sheet(RunFolder& run);
  std::string crops(RunFolder& run);
  /// What was given: the mask of each view over its photo, as far as there is room left.
  std::string given_masks(RunFolder& run);

  /// False where the page has no room for so many bytes.
  bool spend(std::size_t bytes);
  int zoomed_views() const { return options_.zoomed_views; }

 private:
  PictureOptions options_;
  std::size_t spent_bytes_ = 0;
};

}  // namespace ngs::cli
