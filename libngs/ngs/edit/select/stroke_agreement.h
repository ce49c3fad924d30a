#pragma once
// Agreement of labels with the strokes that they were made from: the labelled model is rendered at the marked views and
// compared with the strokes.
#include <span>
#include <string>
#include <vector>

#include "ngs/ops/splat/splat.h"
#include "ngs/scene/view_prompt.h"

namespace ngs {

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

}  // namespace ngs
