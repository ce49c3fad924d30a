#pragma once
// From strokes on some views to masks of all: lift, render into the next view, segment there, repeat. PAPER.md
// §6.7
//
// The prompts of the marked views are segmented, each by itself, and their masks lifted to the splat (evidence). The
// other views follow, the one next whose direction to the object is closest to a view that is done. The consensus
// rendered there becomes the prompt; a mask that agrees too little with it (SA3D's gate) is rejected and
// lifted nowhere. Later passes do all views again, each against the consensus of the others, in a band that
// halves. What a person marked holds in every pass, and the mask of a marked view is never rejected. Where the model
// shows nothing all is background, to the segmenter and in the mask, but for strokes on the object. A view on which
// only background is marked says nothing of the object by itself: it follows as the others do, with its marks.
//
// The photo of a held-out view decides nothing but the mask of that view: it is segmented in the last pass and lifted
// nowhere, unless it is marked.
#include <functional>
#include <map>

#include "ngs/core/monitor.h"
#include "ngs/options/field.h"
#include "ngs/stages/masks/mask_consensus.h"

namespace ngs {

struct SpreadOptions {
  double gate_iou = 0.7;
  int passes = 3;
  double band = 0.02;
  double least_band_px = 3;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.passes, Field<int>{"passes", "", "Number of times that every view is segmented", 1, 20});
  }
};

/// The mask of view `view` given what is known about it. Sizes as the prompt's.
using Segmenter = std::function<PixelMask(std::size_t view, const ViewPrompt& prompt)>;

enum class MaskSource : std::uint8_t { kReference, kSegmented, kRendered, kUnseen };
inline constexpr NamedValue<MaskSource> kMaskSourceNames[] = {{MaskSource::kReference, "reference"},
                                                              {MaskSource::kSegmented, "segmented"},
                                                              {MaskSource::kRendered, "rendered"},
                                                              {MaskSource::kUnseen, "unseen"}};

struct SpreadView {
  PixelMask mask;           // at the size of SpreadInput::camera
  std::vector<float> soft;  // [H·W] mean of mask and consensus
  MaskSource source = MaskSource::kUnseen;
  double agreement = -1;  // with the consensus of the other views; negative: there is none
  double known = 0;       // share of the picture that the other views know
};

struct SpreadInput {
  const GaussianCloud& cloud;
  const Scene& scene;
  std::vector<Camera> camera;                // per view of the scene, at the size that is segmented
  std::vector<bool> has_photo;               // per view; without one the consensus is the mask
  SplatOptions splat;                        // at the size of `camera`
  std::map<std::size_t, ViewPrompt> marked;  // by view, at least one
  Segmenter segment;
  std::function<void(std::size_t view, const SpreadView&)> done;  // once per view, in the last pass
  bool asks_neighbours = true;                                    // LiftedModel
};

/// Calls `done` for every view of the scene. kNothingFound where no object is marked, and where the mask of a view with
/// a marked object is empty.
void spread_masks(const Exec& exec, Monitor& monitor, const SpreadOptions& options, const SpreadInput& input);

/// All views in the order in which they are done: `first` as they come, then the one whose direction from `focus` is
/// closest to one before it; ties go to the first.
std::vector<std::size_t> view_order(const std::vector<Camera>& cameras, const std::vector<std::size_t>& first,
                                    Vec3<double> focus);

}  // namespace ngs
