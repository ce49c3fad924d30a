#pragma once
// Evidence of several views, and what the others say without one of them.
#include <functional>
#include <map>

#include "ngs/scene/evidence.h"

namespace ngs {

/// Keeps the weights of single views up to `kept_bytes`; those of further views are gathered anew when they are asked for.
class LeaveOneOut {
 public:
  /// Adds the evidence of view n alone.
  using Gather = std::function<void(std::size_t n, Evidence& evidence)>;
  LeaveOneOut(std::int64_t gaussians, int objects, Gather gather, std::size_t kept_bytes = 256u << 20);

  void add(std::size_t n);

  struct Rest {
    std::vector<std::uint8_t> seen;  // [N] the others have at least a thousandth of the weight
    std::vector<float> share;        // [N, K] of objects in the weight of the others; 0 where not seen
  };
  /// A view that was not added takes nothing away.
  Rest without(std::size_t n) const;

 private:
  struct Own {
    std::vector<double> weight, object_weight;  // [N], [N, K]
  };
  static Own own_of(const Evidence& one);

  Gather gather_;
  std::size_t kept_bytes_;
  Evidence all_;
  std::map<std::size_t, Own> kept_;    // by view
  std::vector<std::size_t> not_kept_;  // views that were added too
};

}  // namespace ngs
