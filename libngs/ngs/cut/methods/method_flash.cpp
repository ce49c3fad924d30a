#include "ngs/cut/methods/method_flash.h"

#include <algorithm>
#include <cmath>

#include "ngs/cut/evidence/method_labels.h"

namespace ngs {
namespace {

/// The object with the largest share, if it exceeds the background's share plus gamma; otherwise -1.
int largest_share_object(const FlashOptions& options, const std::vector<LabelColumns>& labels, std::size_t row) {
  double object_sum = 0, square_sum = 0, best_share = 0;
  int best = -1;
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const double share = double(labels[k].prob[row]);
    object_sum += share;
    square_sum += share * share;
    if (share > best_share) {
      best = int(k);
      best_share = share;
    }
  }
  const double background = std::max(0.0, 1 - object_sum);  // shares of overlapping objects may sum to more than 1
  const double norm =
      options.norm == FlashNorm::kL1 ? background + object_sum : std::sqrt(background * background + square_sum);
  return best_share / norm > background / norm + options.gamma ? best : -1;
}

}  // namespace

double flash_threshold(const FlashOptions& options) {
  if (options.norm == FlashNorm::kL1) return (1 + options.gamma) / 2;
  const double quarter_turn = std::atan(1.0), angle = quarter_turn + std::asin(options.gamma / std::sqrt(2.0));
  return std::sin(angle) / (std::cos(angle) + std::sin(angle));  // t / (1 + t) with t = tan(angle)
}

Solution run_flash(const Exec& exec, Monitor& monitor, const FlashOptions& options, const Problem& input) {
  Solution result;
  result.cloud = unchanged(input.cloud);
  result.labels = closed_form_labels(exec, monitor, input);
  const auto timed = monitor.scope("flash");
  const double threshold = flash_threshold(options);
  const bool exclusive = result.labels.size() > 1;
  for (std::size_t i = 0; i < std::size_t(input.cloud.size()); ++i) {
    const int owner = exclusive ? largest_share_object(options, result.labels, i) : -1;
    for (std::size_t k = 0; k < result.labels.size(); ++k) {
      LabelColumns& c = result.labels[k];
      const bool object = exclusive ? owner == int(k) : double(c.prob[i]) > threshold;
      c.label[i] = float(c.views[i] > 0 && object);
    }
  }
  restore_fixed(input, {}, result.labels);
  result.figures["threshold"] = threshold;
  for (const LabelColumns& c : result.labels) result.figures["object_gaussians"] += labelled_count(c);
  return result;
}

}  // namespace ngs
