#pragma once
// Evidence of several views, and what the others say without one of them.
#include <functional>
#include <map>

#include "ngs/backend/exec.h"
#include "ngs/scene/evidence.h"

namespace ngs {

/// Keeps the weights of single views up to `kept_bytes`; those of further views are gathered anew when they are asked
/// for.
class LeaveOneOut {
 public:
  /// What view n says.
  using Gather = std::function<ViewSums(std::size_t n)>;
  LeaveOneOut(const Exec& exec, std::int64_t gaussians, int objects, Gather gather,
              std::size_t kept_bytes = 256u << 20);

  void add(std::size_t n);
  /// A view that was added: nothing of it is left.
  void remove(std::size_t n);

  struct Rest {
    std::vector<std::uint8_t> seen;  // [N] the others have at least a thousandth of the weight
    std::vector<float> share;        // [N, K] of objects in the weight of the others; 0 where not seen
    std::vector<double> own;         // [N] weight in the view that is left out
  };
  /// A view that was not added takes nothing away.
  Rest without(std::size_t n) const;

 private:
  struct Own {
    std::vector<std::uint32_t> row;  // [V] of the Gaussians that the view sees
    std::vector<double> weight;      // [V, 1 + K] W, then W1 of each object
  };
  Own own_of(const ViewSums& one) const;
  static std::size_t bytes_of(const Own& own);
  bool is_not_kept(std::size_t n) const;

  const Exec exec_;
  std::int64_t gaussians_;
  std::size_t objects_;
  Gather gather_;
  std::size_t left_bytes_;
  ExactSums weight_, object_weight_;   // [N], [N, K] of all views
  std::map<std::size_t, Own> kept_;    // by view
  std::vector<std::size_t> not_kept_;  // views that were added too
};

}  // namespace ngs
