#pragma once
// Scores predicted masks against true masks, per view and object (definitions: ops/image/metrics.h). Stage of ngs-eval;
// pure functions of pixels in memory.
//
// Protocol (Boundary IoU, NVOS, LERF-Mask): the prediction is resized to the truth by nearest neighbour. Both are made
// binary by `>= threshold` on the 8-bit scale; a file whose largest sample is 1 counts as {0,1}-valued. With several
// channels the largest of R, G, B is used, or alpha if it is not constant (scene/mask_samples.h).
//
// Label maps: an object is `value == id`. Maps of three equal channels are grey, as in scene import (io/image/masks.h);
// other colours have id = R + 256 G + 65536 B. A pair in which neither map contains the object is not counted. If
// exactly one id is to be scored, a prediction that contains only 0 and 255 is the mask of that object. True pixels
// with the id `void_id` are not scored (ops/image/metrics.h); predicted ones count as background.
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/ops/image/metrics.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/options/field.h"
#include "ngs/scene/labels/label_column.h"
#include "ngs/scene/mask_samples.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {

/// Match distance of the contour F-score, as a fraction of the diagonal.
inline constexpr double kContourTolerance = 0.008;

struct EvalOptions {
  double threshold = kMaskThreshold;
  bool label_map = false;
  int void_id = -1;
  std::vector<std::string> object_id;
  std::string fail_below;
  int occluder_margin_px = -1;  // no option; >= 0: other objects of a true label map are void, dilated by this

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.threshold, Field<double>{"threshold", "of 255", "Object at and above this value", 1, 255});
    visit(self.label_map, Flag{"label_map", "Files are label maps: score each object id separately"});
    visit(self.void_id,
          Field<int>{"void_id", "",
                     "Label maps: true pixels with this id are not scored, such as 255 in VOC; -1: score all", -1,
                     0xffffff});
    visit(self.object_id, Text{"object_id", "ID|NAME=ID", "Score only this id of the label maps (repeatable)"});
    visit(self.fail_below,
          Text{"fail_below", "SCORE=MIN,...", "Exit with 1 if a mean score is lower, e.g. iou=0.9,biou=0.6"});
  }
};

/// Object ids with their names; an empty map means every id that occurs.
using ObjectIds = std::map<std::uint32_t, std::string>;
/// Throws kUsage for an id or a name that is given twice.
ObjectIds parse_object_ids(const std::vector<std::string>& texts);

/// [H·W] 0 or 1.
std::vector<std::uint8_t> binarised(const DecisiveSamples& samples, double threshold);
inline std::vector<std::uint8_t> binarised(const MaskSamples& samples, double threshold) {
  return binarised(decisive_samples(samples), threshold);
}
/// True if all samples are 0 or 255: a mask, not a label map.
bool is_black_and_white(const MaskSamples& samples);
/// [H·W] object ids.
std::vector<std::uint32_t> label_ids(const MaskSamples& samples);

struct EvalPair {
  std::string view, object;  // label maps: objects are named by id, `object` is a prefix
  MaskSamples predicted, truth;
  std::uint32_t truth_id = 0;  // > 0: the prediction is the mask of this object alone, the truth a label map
};

struct PairScore {
  std::string view, object;
  int width_px = 0, height_px = 0;                      // of the truth
  int predicted_width_px = 0, predicted_height_px = 0;  // before resizing
  bool predicted_zero_one = false, truth_zero_one = false;
  bool truth_has_usual_void = false;  // 255 occurs besides other ids, but is neither void_id nor an object id
  MaskScores scores;
};

/// Throws kUsage if options of label maps are given without label_map, or if an object id is void_id.
void require_consistent(const EvalOptions& options);

/// One score for binary masks; for label maps one per object that occurs in either. Throws kBadInput for empty images.
std::vector<PairScore> evaluate_pair(const Exec& exec, const EvalOptions& options, const ObjectIds& ids,
                                     const EvalPair& pair);

using ScoreValues = std::array<double, kScoreNames.size()>;  // in the order of kScoreNames

struct ObjectMean {
  std::string object;
  std::int64_t pairs = 0, both_empty = 0, one_empty = 0;
  Confusion counts;  // summed over the pairs
  std::uint64_t far_fp = 0, far_fn = 0, void_px = 0;
  ScoreValues mean{};
};

struct EvalSummary {
  std::vector<ObjectMean> objects;  // by name
  ScoreValues mean{};               // mean over objects of their means over views (LERF-Mask; NVOS: over tasks)
  ScoreValues mean_over_pairs{};    // every pair has the same weight (LERF-OVS)
};
/// `pairs` must not be empty.
EvalSummary summarise(std::span<const PairScore> pairs);

struct ScoreCheck {
  std::string score;
  double at_least = 0, found = 0;
  bool passed() const { return found >= at_least; }  // NaN fails
};
/// Checks a rule such as "iou=0.9,biou=0.6" on `found`. kUsage for an unknown score or a value that is no number.
std::vector<ScoreCheck> check_scores(const std::string& rule, const std::map<std::string, double>& found);

// Assigns one cause to every wrong pixel of a rendered mask.
//
// The first cause that applies, by the Gaussians composited in the pixel (weights w = α T) and the truth:
// clang-format off
//   reach       the splat is transparent: alpha < 0.5
//   unseen      most of w belongs to Gaussians visible in at most two views with masks
//   floater     the object is occluded: alone it covers the pixel, the full model does not show it, and the occluder is
//               nearer by more than a tenth of the object's RMS radius
//   input-mask  the input mask of this view, which no stage has read, has the same error: so had the other input masks
//   straddler   most of w belongs to boundary Gaussians
//   soft-edge   the rendered value is uncertain (0.25 to 0.75)
//   label       Gaussians with confident labels of the wrong side
// clang-format on

enum class ErrorCause : std::uint8_t { kNone, kReach, kUnseen, kFloater, kInputMask, kStraddler, kSoftEdge, kLabel };
inline constexpr std::size_t kErrorCauses = 8;
struct ErrorCauseName {
  std::string_view name, help;
  std::array<std::uint8_t, 3> rgb;  // colour in atlas images
};
inline constexpr std::array<ErrorCauseName, kErrorCauses> kErrorCauseNames = {
    {{"none", "correct", {0, 0, 0}},
     {"reach", "not covered by the splat", {160, 160, 160}},
     {"unseen", "Gaussians visible in at most two views", {255, 255, 0}},
     {"floater", "something in front of the object", {255, 0, 255}},
     {"input-mask", "the view's input mask has the same error", {255, 60, 40}},
     {"straddler", "Gaussians across the edge", {60, 220, 60}},
     {"soft-edge", "uncertain value at an edge", {0, 220, 255}},
     {"label", "confident labels of the wrong side", {255, 150, 0}}}};

struct AtlasInput {
  const GaussianCloud& cloud;
  const LabelColumns& labels;
  Camera camera;                      // of the truth's size
  SplatOptions splat;                 // with the low-pass filter for that size
  MaskPlane predicted, truth, input;  // one size; input.data may be null
};

struct ErrorAtlas {
  std::vector<ErrorCause> cause;  // [H·W]
  std::array<std::int64_t, kErrorCauses> pixels{};
  std::int64_t wrong() const;
};

ErrorAtlas error_atlas(const Exec& exec, const AtlasInput& input);

}  // namespace ngs
