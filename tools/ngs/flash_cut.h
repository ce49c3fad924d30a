#pragma once
// Strokes on pictures of a splat -> labels, in seconds and without training, by this process (stages/live/ball_cut.h):
// all of --quality flash, and what the other qualities begin with and are held against.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/scene/scene.h"
#include "ngs/scene/view_prompt.h"
#include "shared/run/run.h"

namespace ngs::front {

struct FlashInputs {
  std::string scene;   // file; it has the cameras and the pictures that were marked
  std::string around;  // "X,Y,Z,R"; empty: all of the model
  std::string view;    // that the strokes are of; empty: as each says
  std::vector<std::string> strokes;
  bool all_pieces = false;
  int longer_side_px = 0;  // of the masks; 0: live::kSegmentedSide_px
};

struct FlashFigures {
  std::int64_t object = 0, background = 0, in_ball = 0, left_out = 0;  // Gaussians
  std::size_t views = 0, segmented = 0;                                // of these, with a mask of their own
  double wall_s = 0;                                                   // with reading and writing
};

struct FlashCut {
  LabelColumns labels;           // [N]
  Scene scene;                   // as it was read
  std::vector<Camera> cameras;   // of its views, at the size of the masks
  std::vector<PixelMask> masks;  // of all views
  bool is_expected = false;      // BallCut::is_expected
  FlashFigures figures;          // without wall_s
};

/// Nothing where a signal asked to stop.
std::optional<FlashCut> flash_cut(cli::Run& run, const io::GaussianPly& ply, const FlashInputs& inputs);

/// Puts what the labels show in each view in the place of the masks that they come from: views then agree at the plane
/// that told where the object is, where colours of single pictures do not know it.
void take_masks_of_labels(const cli::Run& run, const GaussianCloud& cloud, FlashCut& cut);

/// STEM.png of all views.
void write_flash_masks(const std::string& folder, const FlashCut& cut);
/// object.ply, background.ply and labelled.ply.
void write_flash_models(cli::Run& run, const std::string& folder, const io::GaussianPly& ply,
                        const LabelColumns& labels);

/// --max-views of ngs-scene orbit for --quality flash, where `views` are wanted to begin with (0: as many as are
/// usual).
std::string most_flash_views(int views);

}  // namespace ngs::front
