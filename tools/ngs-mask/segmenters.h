#pragma once
// What may segment a view: GrabCut, or a program of the user.
#include <memory>
#include <string>

#include "ngs/options/field.h"
#include "ngs/stages/masks/mask_spread.h"
#include "shared/run/run.h"

namespace ngs::cli {

struct SegmenterOptions {
  std::string segmenter;
  double segmenter_timeout_s = 600;
  double window = 0.35;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.segmenter, Text{"segmenter", "CMD {image} {prompts} {out}",
                               "program that segments one view, run without a shell; without the placeholders one "
                               "that is kept running and reads a line for each view; default: built-in GrabCut"});
    visit(self.segmenter_timeout_s,
          Field<double>{"segmenter_timeout_s", "s", "the program is ended after this", 0.01, 1e6});
    visit(self.window, Field<double>{"window", "of the object",
                                     "GrabCut: size of the overlapping windows that have colours of "
                                     "their own; 0: one cut per view",
                                     0.0, 10.0});
  }
};

/// The photo of view `view` of `scene` at the prompt's size.
using PhotoLoader = std::function<ImageU8(std::size_t view)>;

Segmenter grab_cut_segmenter(const Exec& exec, const SegmenterOptions& options, PhotoLoader load, std::uint64_t seed);

/// Runs the command for each view, or, where it has no placeholder, starts it at the first and asks it by lines of JSON
/// (pipelines/segmenters/README.md). Files are passed in a folder that is removed with the last copy of the segmenter.
/// kUsage for a command with some of its three placeholders, kEnvironment where it fails or takes too long, kBadInput
/// where it answers otherwise, or what it wrote is no mask of the image's size.
Segmenter command_segmenter(const SegmenterOptions& options, const Scene& scene, PhotoLoader load, Run& run);

}  // namespace ngs::cli
