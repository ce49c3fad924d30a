#pragma once
// From strokes on some views to masks of all: lift, render into the next view, segment there, repeat. paper.md §6.7
//
// The prompts of the marked views are segmented independently, and their masks lifted to the splat (evidence). The
// other views follow in the order of their angular distance to a finished view, seen from the object. The consensus
// rendered into a view becomes its prompt. A mask that agrees too little with the consensus (SA3D's gate) is rejected
// and not lifted. Later passes segment all views again, each against the consensus of the others, in a band that halves
// per pass.
//
// Hand-made marks are kept in every pass, and the mask of a marked view is never rejected. Empty pixels are background
// in prompt and mask, except under strokes on the object. A view with background marks only is not a starting view: it
// follows like the others, with its marks.
//
// A held-out view is segmented in the last pass only and not lifted, unless it is marked, so its photo influences only
// its own mask.
#include <functional>
#include <map>

#include "ngs/core/monitor.h"
#include "ngs/cut/masks/mask_consensus.h"
#include "ngs/options/field.h"

namespace ngs {

struct SpreadOptions {
  double gate_iou = 0.7;
  int passes = 3;
  double band = 0.02;
  double min_band_px = 3;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.passes, Field<int>{"passes", "", "Number of times that every view is segmented", 1, 20});
  }
};

/// Segments view `view` by `prompt`; the mask has the prompt's size.
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
  double agreement = -1;  // IoU with the consensus of the other views; negative: not segmented
  double known = 0;       // known fraction of the image, from the other views
};

struct SpreadInput {
  const GaussianCloud& cloud;
  const Scene& scene;
  std::vector<Camera> camera;                // per view of the scene, at the segmented size
  std::vector<bool> has_photo;               // per view; without a photo the consensus is the mask
  SplatOptions splat;                        // at the size of `camera`
  std::map<std::size_t, ViewPrompt> marked;  // by view, at least one
  Segmenter segment;
  std::function<void(std::size_t view, const SpreadView&)> done;  // once per view, in the last pass
  bool use_neighbours = true;                                     // as LiftedModel
};

/// Calls `done` for every view of the scene. Throws kNothingFound if no object is marked, or if the mask of a view with
/// a marked object is empty.
void spread_masks(const Exec& exec, Monitor& monitor, const SpreadOptions& options, const SpreadInput& input);

/// All views in processing order: `first` in its own order, then always the view whose direction from `focus` is
/// closest to that of an earlier view; ties go to the lower index.
std::vector<std::size_t> view_order(const std::vector<Camera>& cameras, const std::vector<std::size_t>& first,
                                    Vec3<double> focus);

}  // namespace ngs
