#pragma once
// Photos with mask outlines: JPEG data URIs under inline SVG, sharp at any zoom.
#include <string>

#include "run_folder.h"

namespace ngs::cli {

struct PictureOptions {
  int sheet_width_px = 360, crop_side_px = 96;
  double budget_mib = 4.2;  // picture bytes on the whole page
  int zoomed_views = 4;
};

/// Makes figures until the picture budget of the page is spent.
class Pictures {
 public:
  explicit Pictures(const PictureOptions& options) : options_(options) {}

  /// The contact sheet of a run, worst views first, and zoomed crops of the worst views. Adds unreadable
  /// pictures to `run.problems`.
  std::string sheet(RunFolder& run);
  std::string crops(RunFolder& run);
  /// The input mask of each view over its photo, within the remaining budget.
  std::string given_masks(RunFolder& run);

  /// Takes `bytes` from the budget; false if they exceed it.
  bool spend(std::size_t bytes);
  int zoomed_views() const { return options_.zoomed_views; }

 private:
  PictureOptions options_;
  std::size_t spent_bytes_ = 0;
};

}  // namespace ngs::cli
