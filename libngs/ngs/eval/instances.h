#pragma once
// Panoptic quality and average precision of objects without known ids: predicted and true segments of a whole scene.
//
// A segment is all pixels of one id over all views together (or all Gaussians of one label), so that an object with
// different ids in different views is wrong. Id 0 is no segment on either side.
//
// clang-format off
//   match    a predicted and a true segment with IoU > 1/2; each has at most one
//   PQ       Σ IoU of the matches / (matches + ½ unmatched predictions + ½ unmatched true)   Kirillov et al., CVPR 2019;
//            over scenes: Bhalgat et al., Contrastive Lift, NeurIPS 2023
//   SQ, RQ   mean IoU of the matches; matches / (matches + ½ … + ½ …): PQ = SQ · RQ
//   AP50     area under the precision over recall, precision made monotonic. Predictions in the order of their size, as
//            id maps have no confidence; each takes the free true segment of the largest IoU if that is >= 1/2
//   AP25     the same at 1/4; AP: mean over .50, .55, … .95
//   missed   true segment, more than half of it in no prediction
//   invented prediction, more than half of it in no true segment
//   merged   prediction that contains more than half of two true segments or more
//   split    true segment with two predictions or more that lie more than half in it and cover 1/10 of it each
// clang-format on
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace ngs {

/// Number of pixels (or Gaussians) by (predicted id, true id).
class InstanceCounts {
 public:
  /// Adds pairs of ids; `is_void` [n] 1: not counted; empty: all are.
  void add(std::span<const std::uint32_t> predicted, std::span<const std::uint32_t> truth,
           std::span<const std::uint8_t> is_void = {});
  void add(const InstanceCounts& other);
  const std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t>& pixels() const { return pixels_; }

 private:
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint64_t> pixels_;
};

struct TrueInstance {
  std::uint32_t id = 0;
  std::uint64_t pixels = 0;
  std::uint32_t best = 0;  // predicted id of the largest IoU; 0: none overlaps
  double iou = 0;          // with `best`
  bool split = false, missed = false;
  bool matched() const { return iou > 0.5; }
};

struct PredictedInstance {
  std::uint32_t id = 0;
  std::uint64_t pixels = 0;
  std::uint32_t match = 0;            // true id; 0: none
  std::vector<std::uint32_t> merged;  // true ids, two or more; empty: not merged
  bool invented = false;
};

struct InstanceScores {
  double pq = 0, sq = 0, rq = 0, ap = 0, ap50 = 0, ap25 = 0;  // 0 without a prediction
  std::size_t matched = 0, split = 0, merged = 0, missed = 0, invented = 0;
  std::vector<TrueInstance> truth;           // by id
  std::vector<PredictedInstance> predicted;  // by id
};

/// Throws kNothingFound without a true segment.
InstanceScores score_instances(const InstanceCounts& counts);

/// Boundary IoU (ops/image/metrics.h) of the pixels [H·W] of predicted id `predicted` and true id `truth` in one view,
/// in a band of 0.02 of the diagonal; negative if neither occurs.
double instance_biou(std::span<const std::uint32_t> predicted_ids, std::span<const std::uint32_t> true_ids,
                     int width_px, const TrueInstance& instance);

}  // namespace ngs
