#pragma once
// Computes labels from strokes on renders of a splat in seconds, without training and in this process
// (interactive/ball_cut.h). It is all of --method flash; --method ngs starts from its result and compares against
// it.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cut_inputs.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/scene/scene.h"
#include "ngs/scene/view_prompt.h"
#include "shared/run/run.h"

namespace ngs::ngs_tool {

struct FlashInputs {
  std::string scene;   // scene file with the cameras and the images of the strokes
  std::string around;  // "X,Y,Z,R"; empty: the whole model
  std::string view;    // view of the strokes; empty: as given in each file
  std::vector<std::string> strokes;
  bool all_pieces = false;
  int longer_side_px = 0;  // size of the masks; 0: live::kSegmentedSide_px
};

struct FlashFigures {
  std::int64_t object = 0, background = 0, in_ball = 0, left_out = 0, needles = 0;  // Gaussians
  std::size_t views = 0, segmented = 0;  // segmented: views with their own mask
  double wall_s = 0;                     // including reading and writing
};

struct FlashCut {
  LabelColumns labels;               // [N]
  Scene scene;                       // as read from the file
  std::vector<Camera> cameras;       // cameras of its views, at the size of the masks
  std::vector<PixelMask> masks;      // of all views
  std::vector<PixelMask> segmented;  // the same as segmented; empty: the view's mask is a render of the labels
  bool is_expected = false;          // BallCut::is_expected
  FlashFigures figures;              // wall_s is not set
};

/// Returns nullopt if stopped by a signal.
std::optional<FlashCut> flash_cut(cli::Run& run, const io::GaussianPly& ply, const FlashInputs& inputs);

/// Replaces the masks by renders of the labels. All views then agree at the plane that bounds the object, which colours
/// of single images may not show.
void render_masks_from_labels(cli::Run& run, const GaussianCloud& cloud, FlashCut& cut);

/// view_agreement() of labels with masks of the views of `cut`.
double agreement_in_views(cli::Run& run, const GaussianCloud& cloud, const std::vector<float>& label,
                          const FlashCut& cut, const std::vector<PixelMask>& masks);

/// STEM.png masks of all views.
void write_flash_masks(const std::string& folder, const FlashCut& cut);
/// Reads such masks of the views of `cut`, which another tool may have written; empty: no file, or of another size.
std::vector<PixelMask> read_flash_masks(const std::string& folder, const FlashCut& cut);
/// Writes object.ply, background.ply and labelled.ply.
void write_flash_models(cli::Run& run, const std::string& folder, const io::GaussianPly& ply,
                        const LabelColumns& labels);

/// The masks of training were segmented from the expected object: in the trained model of `path`, boundary Gaussians,
/// whose masks disagree, get the labels of `first`. A model in which training has split Gaussians stays as it is.
void keep_boundary_labels(const std::string& path, const LabelColumns& first);

/// Value of ngs-scene orbit --max-views: --view-count, else a limit for --method flash; empty: the default.
std::string max_views(const CutOptions& options);

}  // namespace ngs::ngs_tool
