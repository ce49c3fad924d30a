#pragma once
// Scratch memory of the tile kernels: one per thread; grows, never shrinks.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "ngs/ops/splat/tile_types.h"

namespace ngs {

/// The first 64-byte aligned element of `memory`, if S allows it; allocate kLinePad elements more.
template <class S>
inline constexpr std::size_t kLinePad = 64 / sizeof(S) + 1;
template <class S>
S* line_aligned(std::vector<S>& memory) {
  if (64 % sizeof(S) != 0) return memory.data();
  const auto address = reinterpret_cast<std::uintptr_t>(memory.data());
  return memory.data() + (64 - address % 64) % 64 / sizeof(S);
}

template <class S>
class TapeMemory : public Tape<S> {
 public:
  TapeMemory() {
    this->grow = [](Tape<S>& tape, int lanes) { static_cast<TapeMemory&>(tape).enlarge(std::size_t(2 * lanes)); };
  }
  TapeMemory(const TapeMemory&) = delete;
  TapeMemory& operator=(const TapeMemory&) = delete;

 private:
  void enlarge(std::size_t per_contribution) {
    this->lane_capacity = std::max<std::size_t>(std::size_t(1) << 15, 2 * this->lane_capacity);
    std::vector<S> larger(this->lane_capacity + kLinePad<S>);
    S* to = line_aligned(larger);
    std::copy_n(this->lanes, this->size * per_contribution, to);
    lane_memory_ = std::move(larger);
    this->lanes = to;
    row_memory_.resize(this->lane_capacity / 2);
    this->row = row_memory_.data();
    this->span_capacity = std::max<std::size_t>(1024, 2 * this->span_capacity);
    span_memory_.resize(this->span_capacity);
    this->span = span_memory_.data();
  }

  std::vector<S> lane_memory_;
  std::vector<std::uint8_t> row_memory_;
  std::vector<typename Tape<S>::Span> span_memory_;
};

template <class S>
struct TileScratch {
  std::vector<S> memory;
  TapeMemory<S> tape;
  S* values(std::size_t n) {
    if (memory.size() < n + kLinePad<S>) memory.resize(n + kLinePad<S>);
    return line_aligned(memory);
  }
};

}  // namespace ngs
