#pragma once
// What the marked views of one object say of every Gaussian, kept so that one view can be put in or taken out by
// itself. The labels are those of ngs-variance and of `ngs-joint --method flash` over the same views, to the bit.
#include "ngs/backend/exec.h"
#include "ngs/math/exact_sum.h"
#include "ngs/stages/live/marks.h"

namespace ngs::live {

class ObjectEvidence {
 public:
  explicit ObjectEvidence(std::int64_t gaussians);

  void add(const MarkedView& view);
  void remove(const MarkedView& view);
  /// Puts a view in the place of another that sees the same Gaussians. Those whose sums change, increasing.
  std::vector<std::uint32_t> replace(const MarkedView& before, const MarkedView& now);

  /// Share of the object in a Gaussian's weight, in [0, 1]; 0 where no view sees it.
  double share(std::size_t gaussian) const;
  bool is_seen(std::size_t gaussian) const { return weight_.whole[gaussian] != 0 || weight_.fraction[gaussian] != 0; }
  std::size_t gaussians() const { return weight_.size(); }

 private:
  ExactSums weight_, inside_;  // [N]
};

/// Of one object, [N].
struct ObjectLabels {
  std::vector<float> label;            // 1 object, 0 not
  std::vector<std::uint8_t> boundary;  // 1: views disagree (ngs-variance --tau at its default)
  std::int64_t count = 0;              // of label 1
  std::int64_t left_out = 0;           // Gaussians of pieces that no stroke touches: label and boundary 0

  /// Of an object that no view has shown.
  static ObjectLabels none(std::size_t gaussians) {
    return {std::vector<float>(gaussians), std::vector<std::uint8_t>(gaussians), 0, 0};
  }
};
/// After the sums of these Gaussians, of which none is there twice, have changed.
void label_rows(const Exec& exec, const ObjectEvidence& evidence, const std::vector<std::uint32_t>& rows,
                ObjectLabels& labels);

}  // namespace ngs::live
