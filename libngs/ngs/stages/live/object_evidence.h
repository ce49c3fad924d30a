#pragma once
// The evidence of one object's marked views for every Gaussian. Single views can be added and removed. The labels are
// bit-identical to those of ngs-variance and of `ngs-joint --method flash` over the same views.
#include "ngs/backend/exec.h"
#include "ngs/math/exact_sum.h"
#include "ngs/stages/live/marks.h"

namespace ngs::live {

class ObjectEvidence {
 public:
  explicit ObjectEvidence(std::int64_t gaussians);

  void add(const MarkedView& view);
  void remove(const MarkedView& view);
  /// Replaces a view by another with the same visible Gaussians. Returns the Gaussians whose sums change, ascending.
  std::vector<std::uint32_t> replace(const MarkedView& before, const MarkedView& now);

  /// Share of the object in a Gaussian's weight, in [0, 1]; 0 if it is visible in no view.
  double share(std::size_t gaussian) const;
  bool is_seen(std::size_t gaussian) const { return weight_.whole[gaussian] != 0 || weight_.fraction[gaussian] != 0; }
  std::size_t gaussians() const { return weight_.size(); }

 private:
  ExactSums weight_, inside_;  // [N]
};

/// The labels of one object, [N].
struct ObjectLabels {
  std::vector<float> label;            // 1 object, 0 not
  std::vector<std::uint8_t> boundary;  // 1: views disagree (ngs-variance --tau at its default)
  std::int64_t count = 0;              // Gaussians with label 1
  std::int64_t left_out = 0;           // Gaussians of pieces that no stroke touches, and needles: label and boundary 0

  /// The labels of an object without views.
  static ObjectLabels none(std::size_t gaussians) {
    return {std::vector<float>(gaussians), std::vector<std::uint8_t>(gaussians), 0, 0};
  }
};
/// Updates the labels of `rows`, each listed once, after their sums have changed.
void label_rows(const Exec& exec, const ObjectEvidence& evidence, const std::vector<std::uint32_t>& rows,
                ObjectLabels& labels);

}  // namespace ngs::live
