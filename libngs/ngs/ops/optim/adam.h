#pragma once
// Adam on flat parameter blocks.
//
// A gradient that is not finite, or so large that its square is not representable, is an Error (kNumeric) that
// names the index; the block is then unchanged. A zero gradient with zero moments leaves the value unchanged.
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "ngs/backend/exec.h"

namespace ngs {

struct AdamOptions {
  double lr = 1e-3;
  double beta1 = 0.9, beta2 = 0.999;
  double eps = 1e-15;      // 3DGS's; it only guards 0/0
  int sparse_columns = 0;  // > 0: rows of this many values with an all-zero gradient are skipped entirely
};

/// The values that a step changes, and their gradients.
template <class T>
struct AdamBlock {
  std::string_view name;  // for error messages
  std::span<T> value;
  std::span<const T> grad;  // of the same size
};

/// Moments of one block; empty means zero. Both have the block's length once stepped.
struct AdamMoments {
  std::vector<float> m, v;
};
/// Moments owned by the caller, of the block's length.
template <class T>
struct AdamMomentSpans {
  std::span<T> m, v;
};

/// Step number `step` (the first is 1) of a block.
void adam_step(const Exec& exec, const AdamOptions& options, std::int64_t step, const AdamBlock<float>& block,
               AdamMoments& moments);

/// A block with its options and moments.
struct AdamGroup {
  AdamOptions options;
  AdamBlock<float> block;
  AdamMoments& moments;
};
/// A step of at most 24 groups. A device takes them at once, and changes none if a gradient of one is unusable.
void adam_step(const Exec& exec, std::int64_t step, std::span<const AdamGroup> groups);
/// The same in double, for tests and small problems.
void adam_step(const Exec& exec, const AdamOptions& options, std::int64_t step, const AdamBlock<double>& block,
               const AdamMomentSpans<double>& moments);

/// Index of the first value that is NaN, infinite or larger in magnitude than `limit`; -1 if none.
std::int64_t first_unusable(const Exec& exec, std::span<const float> values, float limit);
std::int64_t first_unusable(const Exec& exec, std::span<const double> values, double limit);

}  // namespace ngs
