#pragma once
// Measures how well a labelled model fits the masks that it was made from: labels are rendered in the views and
// compared with the masks. A good fit does not prove accuracy, because masks may be wrong. Labels that contradict the
// masks of several views are wrong.
#include <span>
#include <string>
#include <vector>

#include "ngs/ops/splat/splat.h"
#include "ngs/scene/labels/label_column.h"
#include "ngs/scene/view_prompt.h"
#include "ngs/scene/views.h"

namespace ngs {

// Agreement of labels with the strokes that they were made from: the labelled model is rendered at the marked views and
// compared with the strokes.

/// A connected stroke or painted patch with a fraction of wrong pixels above kBrokenShare.
inline constexpr double kBrokenShare = 0.25;
struct BrokenStroke {
  std::string view;
  bool object = true;  // its side
  int x = 0, y = 0;    // px of the camera: its first wrong pixel
  double wrong = 0;    // fraction of its pixels, in (kBrokenShare, 1]
};

struct StrokeAgreement {
  std::int64_t pixels = 0, wrong = 0;  // pixels under strokes; background strokes count where the model is visible
  std::vector<BrokenStroke> broken;    // by view, object strokes first

  double wrong_share() const { return pixels > 0 ? double(wrong) / double(pixels) : 0; }
};

struct LabelledSplat {
  const GaussianCloud& cloud;
  std::span<const float> label;  // [N] in [0, 1]
  const SplatOptions& splat;
};

/// Adds a view; `marks` has the size of the camera. Background strokes on empty pixels of the render are not counted.
void add_stroke_agreement(const Exec& exec, const LabelledSplat& model, const Camera& camera, const ViewPrompt& marks,
                          StrokeAgreement& agreement);

/// Mean IoU over the views between the rendered labels and the masks. An empty vector is a view without a mask. Views
/// in which both are empty do not count; 1 without a view that counts. A mask has the size of its camera.
double view_agreement(const Exec& exec, const LabelledSplat& model, std::span<const Camera> cameras,
                      std::span<const PixelMask> masks);

struct ResultQuality {
  double strokes_wrong = 0;  // StrokeAgreement::wrong_share()
  double agreement = 1;      // view_agreement() with the masks that the result was made from
};

/// True if `result` contradicts strokes, or the masks of its views, by more than `other` does, beyond a small margin.
bool is_worse(const ResultQuality& result, const ResultQuality& other);

/// Replaces the labels of the boundary Gaussians of `trained` by those of `first`, which has the same rows. The masks
/// of a boundary Gaussian disagree: if all masks were segmented from one expected object, that object decides. Returns
/// [N] the column ngs_fixed: 1 for these Gaussians.
std::vector<float> fix_boundary(const LabelColumns& first, LabelColumns& trained);

}  // namespace ngs
