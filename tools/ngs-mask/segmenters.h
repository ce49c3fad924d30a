#pragma once
// Segmenters of a view: built-in GrabCut, or a program of the user.
#include <optional>
#include <string>

#include "ngs/cut/masks/mask_spread.h"
#include "ngs/io/image/image_file.h"
#include "ngs/options/field.h"
#include "shared/run/run.h"

namespace ngs::cli {

struct SegmenterOptions {
  std::string segmenter;
  double segmenter_timeout_s = 600;
  double window = 0.35;
  bool everything = false;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.segmenter,
          Text{"segmenter", "CMD {image} {prompts} {out}",
               "Program that segments one view, run without a shell; without placeholders, the program stays "
               "running and reads one line per view; default: built-in GrabCut"});
    visit(self.segmenter_timeout_s,
          Field<double>{"segmenter_timeout_s", "s", "Time limit of the program per view", 0.01, 1e6});
    visit(self.everything,
          Flag{"everything",
               "Make id maps of all masks in each photo, without prompts; their ids mean nothing across views"});
    visit(self.window, Field<double>{"window", "of the object",
                                     "GrabCut: size of overlapping windows with separate colour "
                                     "models; 0: one cut per view",
                                     0.0, 10.0});
  }
};

/// Loads the photo of view `view` at the size of its prompt.
using PhotoLoader = std::function<ImageU8(std::size_t view)>;

Segmenter grab_cut_segmenter(const Exec& exec, const SegmenterOptions& options, PhotoLoader load, std::uint64_t seed);

/// Runs the command for each view. A command without placeholders is started once and gets one line of JSON per view
/// (pipelines/segmenters/README.md). Files are passed in a folder that is removed with the last copy of the segmenter.
/// kUsage for a command with only some of the three placeholders, kEnvironment if it fails or exceeds its time,
/// kBadInput for another response, or if the output is not a mask of the image's size.
Segmenter command_segmenter(const SegmenterOptions& options, const Scene& scene, PhotoLoader load, Run& run);

/// The id map [H, W] of all masks of a view, at the size that is given; nothing after a stop request.
using EverythingSegmenter = std::function<std::optional<ImageU16>(std::size_t view, io::ImageSize size)>;
/// The same program with the prompt "everything" instead of points; it writes a 16-bit id map. Errors as above.
EverythingSegmenter everything_segmenter(const SegmenterOptions& options, const Scene& scene, PhotoLoader load,
                                         Run& run);

}  // namespace ngs::cli
