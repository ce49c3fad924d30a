#pragma once
// All parameters of the joint step in one array on a device, with their gradients, moments and the count of steps: what
// depends on the step's number is computed where the number is, so that a recorded step can be replayed.
#include "ngs/ops/device/adam_schedule.h"
#include "ngs/ops/device/device_joint.h"
#include "ngs/ops/device/tiles_schedule.h"

namespace ngs {

enum class JointHalt : std::uint8_t { kNone, kFull, kGradient };

/// The state of a run beside its parameters.
struct JointClock {
  std::int64_t done, steps, pairs, bad_index;
  float bad_value;
  JointHalt halt;
};

struct JointBlockOnGrid {
  std::int64_t begin, end;
  double rate, beta2;
  std::int64_t sparse_columns;
};
/// Factors of a block in one step, as AdamKernel has them.
struct AdamFactors {
  float step, inv_root, one_minus_beta2;
};

struct AdamFactorsOfStep {
  static constexpr const char* kName = "adam_factors";
  const JointClock* clock;
  const JointBlockOnGrid* block;
  double beta1, rate_decay;
  AdamFactors* factors;  // [blocks] out
  NGS_HD void operator()(std::int64_t b) const {
    const double decay = std::pow(rate_decay, double(clock->done) / double(clock->steps));
    const std::int64_t step = clock->done + 1;
    factors[b] = {float(block[b].rate * decay / adam_bias(beta1, step)),
                  float(1.0 / std::sqrt(adam_bias(block[b].beta2, step))), float(1.0 - block[b].beta2)};
  }
};

/// Halts the run where this step cannot be taken.
struct JudgeStep {
  static constexpr const char* kName = "judge_step";
  const std::int64_t* unusable;  // the first unusable gradient, or kNoIndex
  std::int64_t capacity;
  const std::int64_t* pairs;
  const float* grad;
  JointClock* clock;
  NGS_HD void operator()(std::int64_t) const {
    clock->pairs = *pairs;
    if (clock->halt != JointHalt::kNone) return;
    if (*pairs > capacity) {
      clock->halt = JointHalt::kFull;
      return;
    }
    if (*unusable != kNoIndex)
      clock->halt = JointHalt::kGradient, clock->bad_index = *unusable, clock->bad_value = grad[*unusable];
  }
};

/// Adam on element i of all blocks; halted: nothing.
struct JointAdam {
  static constexpr const char* kName = "joint_adam";
  AdamKernel<float> kernel;  // without the factors
  const JointClock* clock;
  const JointBlockOnGrid* block;
  const AdamFactors* factors;
  NGS_HD void operator()(std::int64_t i) const {
    if (clock->halt != JointHalt::kNone) return;
    std::int64_t b = 0;
    while (i >= block[b].end) ++b;
    if (!(block[b].rate > 0)) return;
    if (const std::int64_t columns = block[b].sparse_columns; columns > 0) {
      const std::int64_t row = i - (i - block[b].begin) % columns;
      bool touched = false;
      for (std::int64_t k = row; k < row + columns; ++k) touched = touched || kernel.grad[k] != 0.f;
      if (!touched) return;
    }
    AdamKernel<float> here = kernel;
    here.step = factors[b].step, here.inv_root = factors[b].inv_root, here.one_minus_beta2 = factors[b].one_minus_beta2;
    here.range(i, i + 1);
  }
};

struct CountStep {
  static constexpr const char* kName = "count_step";
  JointClock* clock;
  NGS_HD void operator()(std::int64_t) const {
    if (clock->halt == JointHalt::kNone) ++clock->done;
  }
};

template <class Grid>
class JointParameters {
 public:
  JointParameters(Grid& grid, const std::vector<JointBlock>& blocks, double rate_decay)
      : grid_(grid), blocks_(blocks), table_(table_of(blocks)), size_(table_.back().end), rate_decay_(rate_decay),
        block_(grid, table_), factors_(grid, std::int64_t(blocks.size())), clock_(grid, 1), value_(grid, size_),
        grad_(grid, size_), m_(grid, size_), v_(grid, size_) {
    grad_.zero();
  }

  void upload(std::int64_t done, std::int64_t steps) {
    m_.zero(), v_.zero();
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const JointBlock& block = blocks_[b];
      const auto put = [&](const auto& buffer, const float* host, std::size_t n) {
        if (n > 0) grid_.upload(buffer.data() + table_[b].begin, host, n * sizeof(float));
      };
      put(value_, block.value.data(), block.value.size());
      put(m_, block.moments->m.data(), block.moments->m.size()), put(v_, block.moments->v.data(), block.moments->v.size());
    }
    set_clock({done, steps, 0, 0, 0, JointHalt::kNone});
  }
  /// Moments of blocks that were never stepped stay as they are.
  void download() {
    const bool stepped = clock().done > 0;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const JointBlock& block = blocks_[b];
      if (!(block.rate > 0) || block.value.empty()) continue;
      const auto get = [&](const auto& buffer, float* host) {
        grid_.download(host, buffer.data() + table_[b].begin, block.value.size() * sizeof(float));
      };
      get(value_, block.value.data());
      if (!stepped) continue;
      block.moments->m.resize(block.value.size()), block.moments->v.resize(block.value.size());
      get(m_, block.moments->m.data()), get(v_, block.moments->v.data());
    }
  }

  JointClock clock() const {
    JointClock clock;
    clock_.to(&clock);
    return clock;
  }
  void set_clock(const JointClock& clock) { grid_.upload(clock_.data(), &clock, sizeof clock); }
  const JointClock* on_clock() const { return clock_.data(); }

  float* value(std::size_t block) const { return value_.data() + table_.at(block).begin; }
  float* grad(std::size_t block) const { return grad_.data() + table_.at(block).begin; }
  /// Null where the block is not trained.
  float* wanted(std::size_t block) const { return table_.at(block).rate > 0 ? grad(block) : nullptr; }
  /// The block that element i belongs to.
  std::size_t block_of(std::int64_t i) const {
    std::size_t b = 0;
    while (i >= table_[b].end) ++b;
    return b;
  }
  std::int64_t begin(std::size_t block) const { return table_.at(block).begin; }

  /// `block` may be behind the last one: a run without a field has none after the Gaussians'.
  void clear_gradients_from(std::size_t block) {
    const std::int64_t n = block < table_.size() ? size_ - begin(block) : 0;
    if (n > 0) grid_.fill_zero(grad(block), std::size_t(n) * sizeof(float));
  }

  /// The step, unless something halts it.
  void step(const PairRoom& room) {
    constexpr double kBeta1 = AdamOptions{}.beta1;
    const DeviceBuffer<Grid, std::int64_t> unusable(grid_, 1);
    least_unusable_on_grid(grid_, grad_.data(), size_, adam_limit<float>(), unusable.data());
    grid_.each(1, JudgeStep{unusable.data(), room.capacity, room.most, grad_.data(), clock_.data()});
    grid_.each(std::int64_t(blocks_.size()),
               AdamFactorsOfStep{clock_.data(), block_.data(), kBeta1, rate_decay_, factors_.data()});
    const AdamKernel<float> kernel{value_.data(), grad_.data(), m_.data(), v_.data(), size_, 0, 0, float(1.0 - kBeta1), 0,
                                   float(AdamOptions{}.eps)};
    grid_.each(size_, JointAdam{kernel, clock_.data(), block_.data(), factors_.data()});
    grid_.each(1, CountStep{clock_.data()});
  }

 private:
  static std::vector<JointBlockOnGrid> table_of(const std::vector<JointBlock>& blocks) {
    std::vector<JointBlockOnGrid> table;
    std::int64_t at = 0;
    for (const JointBlock& b : blocks) {
      const std::int64_t end = at + std::int64_t(b.value.size());
      table.push_back({at, end, b.rate, b.beta2, b.sparse_columns});
      at = end;
    }
    return table;
  }
  Grid& grid_;
  std::vector<JointBlock> blocks_;
  std::vector<JointBlockOnGrid> table_;
  std::int64_t size_;
  double rate_decay_;
  DeviceBuffer<Grid, JointBlockOnGrid> block_;
  DeviceBuffer<Grid, AdamFactors> factors_;
  DeviceBuffer<Grid, JointClock> clock_;
  DeviceBuffer<Grid, float> value_, grad_, m_, v_;
};

}  // namespace ngs
