#pragma once
// All trainable parameters in one flat vector, so that optimiser, checkpoints and clipping are plain loops. Layers
// store only offsets.
#include <span>
#include <string>
#include <vector>

#include "ngs/core/check.h"

namespace ngs {

struct ParamBlock {
  std::string name;                 // e.g. "film.0.weight"
  std::vector<std::int64_t> shape;  // row-major
  std::size_t offset = 0, size = 0;
};

struct ParamStore {
  std::vector<float> values, grads;  // one length
  std::vector<ParamBlock> blocks;    // in order of their offsets, without gaps

  /// Appends a block of zeros; returns its offset.
  std::size_t add(std::string name, std::vector<std::int64_t> shape) {
    std::size_t size = 1;
    for (const std::int64_t n : shape) {
      NGS_CHECK(n >= 0, "a block has no negative side");
      size *= std::size_t(n);
    }
    const std::size_t offset = values.size();
    blocks.push_back({std::move(name), std::move(shape), offset, size});
    values.resize(offset + size, 0.f);
    grads.resize(offset + size, 0.f);
    return offset;
  }
  const ParamBlock& block(std::string_view name) const {
    for (const ParamBlock& b : blocks)
      if (b.name == name) return b;
    NGS_CHECK(false, "no parameter block " + std::string(name));
    return blocks.front();
  }
  std::span<float> value_of(const ParamBlock& b) { return {values.data() + b.offset, b.size}; }
  std::span<const float> value_of(const ParamBlock& b) const { return {values.data() + b.offset, b.size}; }
  std::span<float> grad_of(const ParamBlock& b) { return {grads.data() + b.offset, b.size}; }
};

}  // namespace ngs
