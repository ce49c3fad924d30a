#pragma once
// The mask loss as a function of the labels alone, with geometry fixed.              C18 (a), paper.md §5.3
//
//   q(p) = ε + (1 - 2ε) Σ_i w_ip m_i                          rendered foreground of pixel p
//   c(p) = ε + (1 - 2ε) (T_p + Σ_i w_ip (1 - m_i)) = 1 - q    rendered background, with the final T
//   L(m) = -(1 / Σ_p (a_p + b_p)) Σ_p [a_p ln q(p) + b_p ln c(p)]
//
// a, b: weights of the pixel as inside and outside the mask (binary mask: one is 1, the other 0; unknown pixel: both
// 0). Squeezing by ε instead of clamping keeps L convex, finite, and a mixture as the EM update needs. q and c are both
// summed from non-negative terms, so neither suffers cancellation near 0.
//
// The weights w_ip of the columns (the labels that may move) are cached, 8 pixels of a row at a time;
// everything else is folded into two constants per pixel. Pixels that no column reaches cost nothing. Views that do not
// fit the memory budget are composited again in every evaluation, with the same result. Cache: 33 bytes (17 in half
// precision) per (column, pack of 8 pixels) pair, 8 per (column, tile) pair, 132 per pack reached.
#include <functional>
#include <memory>
#include <vector>

#include "ngs/ops/labels/label_block.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/scene.h"

namespace ngs {

/// Weights of the pixels of one view in L; empty: the view has no mask.
struct PixelTargets {
  std::vector<float> inside, outside;  // [H·W] a, b >= 0
};

/// The mask of one object as targets.
PixelTargets pixel_targets(const ViewMasks& masks, int object);

struct LabelProblem {
  const GaussianCloud& cloud;
  std::vector<Camera> cameras;
  std::function<PixelTargets(std::size_t camera)> load_targets;  // called from one thread
  SplatOptions splat;
  bool half_weights = false;  // cache weights in half precision: 5e-4 relative each, half the memory
};

/// L and its two one-sided sums at one point: P = Σ_p w a / q and Q = Σ_p w b / c per column.
/// ∂L/∂m_i = gradient_scale() · (Q_i - P_i).
struct LabelSums {
  double loss = 0;
  std::vector<double> inside, outside;  // P, Q
};

class LabelSystem {
 public:
  struct Stats {
    std::int64_t cached_bytes = 0, cached_views = 0, streamed_views = 0;
  };

  /// `column_of` [N]: index of the Gaussian's column, -1: folded at label[i]. Columns are numbered
  /// 0..columns-1 in any order, each used once. `label` [N] in [0, 1]: the values at which the others are folded, and
  /// the start of the columns. Keeps a reference to `problem`.
  LabelSystem(const Exec& exec, const LabelProblem& problem, const std::vector<std::int32_t>& column_of,
              const std::vector<double>& label, std::int64_t cache_bytes);
  LabelSystem(LabelSystem&&) noexcept;
  ~LabelSystem();

  /// The system of the columns with new_column[c] >= 0, renumbered; the others are folded at m[c]. Views that are
  /// cached here stay cached, in no more memory than here. `cache_bytes` limits the cache when other views are added.
  LabelSystem reduced(const Exec& exec, const std::vector<std::int32_t>& new_column, const std::vector<double>& m,
                      std::int64_t cache_bytes) const;

  std::int64_t columns() const;
  /// `m` [columns] in [0, 1].
  void evaluate(const Exec& exec, const std::vector<double>& m, LabelSums& out) const;
  /// evaluate() at the initial `label`, computed by the constructor. Only for a system with cache_bytes = 0.
  const LabelSums& at_start() const;
  double gradient_scale() const;  // (1 - 2ε) / Σ (a + b); 0 without any target
  const Stats& stats() const;

 private:
  struct State;
  explicit LabelSystem(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// Builds label blocks from recorded tiles, and reduced blocks from label blocks. Internal to ops (label_system.cpp).

/// The labels of the Gaussians for collect_block: the column, or -1 and the folded value.
struct LabelPlaces {
  const std::uint32_t* id;     // [V] visible Gaussians
  const std::int32_t* column;  // [N]
  const double* label;         // [N]
};

/// The block of a tile, with weights in half precision if `half`; slots are those of the view's lists.
LabelBlock collect_block(const RecordedTile& tile, LabelPlaces places, TargetPlanes targets, bool half);

/// The block with only the columns whose `new_column` is >= 0, renumbered; the others are folded at their values. Its
/// constant_loss is that of the pixels that lose their last column; its target_sum is 0.
LabelBlock reduced_block(const LabelBlock& block, const std::int32_t* new_column, ColumnValues at);

// Losses of labels and the sums of their gradients, tile by tile. Internal to ops (label_system.cpp).

/// The block's part of -(Σ a ln q + b ln c). Writes the slots of its entries.
double evaluate_block(const LabelBlock& block, ColumnValues at, SlotSums* slots);

/// Loss and targets of a tile.
struct TileLoss {
  double loss = 0;        // -Σ a ln q + b ln c
  double target_sum = 0;  // Σ a + b
};

/// The loss of a tile at the labels `at` [V] of the visible Gaussians. Writes the slots of all its Gaussians: the same
/// sums as of a block in which every Gaussian is a column.
TileLoss evaluate_tile(const RecordedTile& tile, ColumnValues at, TargetPlanes targets, SlotSums* slots);

}  // namespace ngs
