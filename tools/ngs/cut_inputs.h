#pragma once
// What ngs cut works on, from its command line.
#include <set>
#include <string>
#include <vector>

#include "cut_source.h"

namespace ngs::front {

struct CutInputs {
  std::string source;  // as given on the command line
  SourceKind kind = SourceKind::kSplat;
  std::vector<std::string> strokes;       // prompt files and folders, as for ngs-mask --prompts
  std::string model, masks, truth;        // empty: from the capture
  std::string given_masks, given_truth;   // of these, as given on the command line
  std::string images, world_transform;    // of a capture; empty: from the capture, none
  std::vector<std::string> import_words;  // other options for ngs-scene import
  std::vector<std::string> all_words;     // all given options
  std::set<std::string> own_flags;        // of ngs cut
  std::string out;                        // the output folder
  bool has_renders = false;               // all images are renders of the splat, or will be
  std::string splat() const { return kind == SourceKind::kSplat ? source : model; }  // with has_renders
};

}  // namespace ngs::front
