#include "ngs/ops/optim/adam.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/optim/adam_kernels.h"

namespace ngs {
namespace {

constexpr std::int64_t kChunk = 1 << 15;

template <class T>
std::int64_t find_unusable(const Exec& exec, std::span<const T> values, T limit) {
  const std::int64_t n = std::int64_t(values.size()), chunks = (n + kChunk - 1) / kChunk;
  std::vector<std::int64_t> first(std::size_t(chunks), -1);
  for_each_index(exec, chunks, [&](std::int64_t chunk) {
    const std::int64_t begin = chunk * kChunk, end = std::min(n, begin + kChunk);
    using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    Bits most = 0;  // magnitudes sort like their bits, NaN last; so the usual case vectorises
    for (std::int64_t i = begin; i < end; ++i)
      most = std::max(most, std::bit_cast<Bits>(values[std::size_t(i)]) & (~Bits(0) >> 1));
    if (most <= std::bit_cast<Bits>(limit)) return;
    for (std::int64_t i = end - 1; i >= begin; --i)
      if (!(std::abs(values[std::size_t(i)]) <= limit)) first[std::size_t(chunk)] = i;
  });
  for (const std::int64_t i : first)
    if (i >= 0) return i;
  return -1;
}

[[noreturn]] void throw_unusable(std::string_view name, std::int64_t index, double value, double limit) {
  throw Error(ErrorCode::kNumeric,
              std::string(name) + ": gradient " + std::to_string(index) + " is " + std::to_string(value) +
                  ", expected a finite value below " + std::to_string(limit),
              "lower the learning rate, or look for non-finite values in the inputs: ngs-scene check");
}

template <class T>
AdamKernel<T> adam_kernel(const AdamOptions& o, std::int64_t step, const AdamBlock<T>& block,
                          const AdamMomentSpans<T>& moments) {
  const auto& [name, value, grad] = block;
  const auto& [m, v] = moments;
  NGS_CHECK(value.size() == grad.size() && value.size() == m.size() && value.size() == v.size(),
            "adam_step: value, grad, m and v must have one length");
  NGS_CHECK(step >= 1, "adam_step: the first step is 1");
  const double bias1 = adam_bias(o.beta1, step), bias2 = adam_bias(o.beta2, step);
  const std::int64_t n = std::int64_t(value.size());
  NGS_CHECK(o.sparse_columns <= 0 || n % o.sparse_columns == 0, "adam_step: the block is not a whole number of rows");
  return {value.data(),     grad.data(),      m.data(), v.data(), n, T(o.lr / bias1), T(1.0 / std::sqrt(bias2)),
          T(1.0 - o.beta1), T(1.0 - o.beta2), T(o.eps)};
}

template <class T>
void step_block(const Exec& exec, const AdamOptions& o, std::int64_t step, const AdamBlock<T>& block,
                const AdamMomentSpans<T>& moments) {
  const AdamKernel<T> kernel = adam_kernel(o, step, block, moments);
  const T limit = adam_limit<T>();
  const std::int64_t bad = find_unusable<T>(exec, block.grad, limit);
  if (bad >= 0) throw_unusable(block.name, bad, double(block.grad[std::size_t(bad)]), double(limit));
  if (o.sparse_columns > 0) {
    for_each_index(exec, kernel.n / o.sparse_columns, SparseAdamKernel<T>{kernel, o.sparse_columns});
  } else {
    for_each_index(exec, (kernel.n + kernel.kChunk - 1) / kernel.kChunk, kernel);
  }
}

}  // namespace

void adam_step(const Exec& exec, const AdamOptions& options, std::int64_t step, const AdamBlock<float>& block,
               AdamMoments& moments) {
  const AdamGroup group{options, block, moments};
  adam_step(exec, step, {&group, 1});
}

void adam_step(const Exec& exec, std::int64_t step, std::span<const AdamGroup> groups) {
  NGS_CHECK(groups.size() <= AdamBlocks::kMax, "adam_step: at most 24 groups");
  AdamBlocks blocks;
  for (const auto& [options, block, moments] : groups) {
    if (moments.m.empty()) moments.m.assign(block.value.size(), 0.f);
    if (moments.v.empty()) moments.v.assign(block.value.size(), 0.f);
    const AdamMomentSpans<float> spans{moments.m, moments.v};
    if (exec.device_ops)
      blocks.add(adam_kernel(options, step, block, spans), options.sparse_columns);
    else
      step_block<float>(exec, options, step, block, spans);
  }
  if (!exec.device_ops) return;
  const auto bad = exec.device_ops->loss.adam(blocks, adam_limit<float>());
  if (bad.index >= 0)
    throw_unusable(groups[bad.block].block.name, bad.index, double(bad.value), double(adam_limit<float>()));
}

void adam_step(const Exec& exec, const AdamOptions& options, std::int64_t step, const AdamBlock<double>& block,
               const AdamMomentSpans<double>& moments) {
  step_block<double>(exec, options, step, block, moments);
}

std::int64_t first_unusable(const Exec& exec, std::span<const float> values, float limit) {
  return find_unusable<float>(exec, values, limit);
}
std::int64_t first_unusable(const Exec& exec, std::span<const double> values, double limit) {
  return find_unusable<double>(exec, values, limit);
}

}  // namespace ngs
