#pragma once
// Whether labels keep to the strokes that they come from: the labelled model is rendered at the marked views, and the
// pixels under the strokes are looked up.
#include <span>
#include <string>
#include <vector>

#include "ngs/ops/splat/splat.h"
#include "ngs/scene/view_prompt.h"

namespace ngs {

/// A connected stroke, or painted patch, of which more than kBrokenShare is on the wrong side.
inline constexpr double kBrokenShare = 0.25;
struct BrokenStroke {
  std::string view;
  bool object = true;  // its side
  int x = 0, y = 0;    // px of the camera: its first wrong pixel
  double wrong = 0;    // share of its pixels, in (kBrokenShare, 1]
};

struct StrokeAgreement {
  std::int64_t pixels = 0, wrong = 0;  // under strokes on what the model shows
  std::vector<BrokenStroke> broken;    // view by view, those on the object first

  double wrong_share() const { return pixels > 0 ? double(wrong) / double(pixels) : 0; }
};

struct LabelledModel {
  const GaussianCloud& cloud;
  std::span<const float> label;  // [N] in [0, 1]
  const SplatOptions& splat;
};

/// Adds a view; `marks` has the size of the camera. Strokes on background where the model shows nothing are right.
void add_stroke_agreement(const Exec& exec, const LabelledModel& model, const Camera& camera, const ViewPrompt& marks,
                          StrokeAgreement& agreement);

}  // namespace ngs
