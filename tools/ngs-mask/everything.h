#pragma once
// --everything: id maps of all masks in each photo, by a program or from annotations of another tool.
#include <string>

#include "segmenters.h"

namespace ngs::cli {

struct EverythingInput {
  const SegmenterOptions& segmenter;
  int detail;
  std::string scene, annotations, output;  // paths; annotations: empty without
};

/// Writes STEM.png, 16 bit, for every view with a photo, or with annotations. Nothing is written before the last view
/// is done. kUsage without a program or annotations, and with both; kNothingFound without a mask.
int make_everything(Run& run, const EverythingInput& input);

}  // namespace ngs::cli
