#pragma once
// The labels of one object from the sums of its marked views. They are bit-identical to those of ngs-variance and of
// `ngs-joint --method flash` over the same views.
#include "ngs/backend/exec.h"
#include "ngs/interactive/marks.h"
#include "ngs/scene/evidence.h"

namespace ngs::live {

/// Add a view to the sums of its object, and remove it again.
void add_view(const MarkedView& view, WeightSums<>& sums);
void remove_view(const MarkedView& view, WeightSums<>& sums);
/// Replaces a view by another with the same visible Gaussians. Returns the Gaussians whose sums change, ascending.
std::vector<std::uint32_t> replace_view(const MarkedView& before, const MarkedView& now, WeightSums<>& sums);

/// The labels of one object, [N].
struct ObjectLabels {
  std::vector<float> label;            // 1 object, 0 not
  std::vector<std::uint8_t> boundary;  // 1: views disagree (ngs-variance --tau at its default)
  std::int64_t count = 0;              // Gaussians with label 1
  std::int64_t removed = 0;            // Gaussians of pieces that no stroke touches, and needles: label and boundary 0

  /// The labels of an object without views.
  static ObjectLabels none(std::size_t gaussians) {
    return {std::vector<float>(gaussians), std::vector<std::uint8_t>(gaussians), 0, 0};
  }
};
/// Updates the labels of `rows`, each listed once, after their sums have changed.
void label_rows(const Exec& exec, const WeightSums<>& sums, const std::vector<std::uint32_t>& rows,
                ObjectLabels& labels);

}  // namespace ngs::live
