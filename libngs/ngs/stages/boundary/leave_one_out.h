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

  /// Weight that Gaussians have where no view looked, all of it beside the objects: `weight` [N], 0 or more.
  void add_elsewhere(const std::vector<double>& weight);
  /// [N], [N, K] of all views that were added and not removed.
  double weight(std::size_t gaussian) const { return weight_.value(gaussian); }
  double object_weight(std::size_t gaussian, std::size_t k) const {
    return object_weight_.value(gaussian * objects_ + k);
  }

  /// What views say of Gaussians.
  struct Shares {
    std::vector<std::uint8_t> seen;  // [rows] they have weight: of all views any, of the others at least a thousandth
    std::vector<float> share;        // [rows, K] of objects in their weight; 0 where not seen
  };
  /// All views, of all Gaussians.
  Shares all() const;
  struct Rest {
    std::vector<std::uint32_t> row;  // increasing: those that view n shows; of all else the others say what all say
    Shares others;                   // [rows]
    std::vector<double> own;         // [rows] weight in view n
  };
  /// A view that was not added takes nothing away: no rows.
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
