#include "ngs/ops/field/hash_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/core/rng.h"
#include "ngs/ops/device/device_ops.h"

namespace ngs {
namespace {

// Queries per task. A task encodes them level by level: their rows stay in the cache, all tables need not fit.
constexpr std::int64_t kQueriesPerTask = 512;

void check_config(const HashGridConfig& c) {
  NGS_CHECK(c.levels >= 1 && c.levels <= kMaxHashLevels, "levels in [1, 16]");
  NGS_CHECK(are_hash_features(c.features), "features is 1, 2, 4 or 8");
  NGS_CHECK(c.log2_table >= 3 && c.log2_table <= 24, "log2_table in [3, 24]");
  NGS_CHECK(c.base_resolution >= 2 && c.max_resolution >= c.base_resolution && c.max_resolution <= kMaxHashResolution,
            "2 <= base_resolution <= max_resolution <= 65536");
}

}  // namespace

HashBox<float> hash_box(Rows<const float, 3> points, double pad) {
  double low[3], high[3], side = 0;
  for (int a = 0; a < 3; ++a) {
    low[a] = std::numeric_limits<double>::infinity();
    high[a] = -low[a];
    for (std::int64_t i = 0; i < points.n; ++i) {
      low[a] = std::min(low[a], double(points.row(i)[a]));
      high[a] = std::max(high[a], double(points.row(i)[a]));
    }
    if (points.n == 0) low[a] = high[a] = 0;
    side = std::max(side, high[a] - low[a] + 2 * pad);
  }
  const float inv = side > 0 ? float(1 / side) : 0.f;
  return {{float((low[0] + high[0]) / 2), float((low[1] + high[1]) / 2), float((low[2] + high[2]) / 2)},
          {inv, inv, inv}};
}

std::vector<HashLevel> hash_levels(const HashGridConfig& c) {
  check_config(c);
  const double growth = c.levels > 1 ? std::log2(double(c.max_resolution) / c.base_resolution) / (c.levels - 1) : 0;
  std::vector<HashLevel> levels;
  std::uint64_t offset = 0;
  for (int l = 0; l < c.levels; ++l) {
    const double scale = std::exp2(growth * l) * c.base_resolution - 1;
    HashLevel level;
    level.scale = float(scale);
    level.resolution = std::uint32_t(std::ceil(double(level.scale))) + 1;
    const std::uint64_t vertices = std::uint64_t(level.resolution) * level.resolution * level.resolution;
    const std::uint64_t table = std::uint64_t(1) << c.log2_table;
    level.size = std::uint32_t(std::min((vertices + 7) / 8 * 8, table));
    level.dense = vertices <= level.size;
    level.offset = std::uint32_t(offset);
    offset += level.size;
    levels.push_back(level);
  }
  return levels;
}

std::size_t add_hash_grid(ParamStore& store, const std::string& prefix, const HashGridConfig& config,
                          std::uint64_t seed) {
  constexpr double kInit = 1e-4;
  const std::vector<HashLevel> levels = hash_levels(config);
  const std::int64_t entries = std::int64_t(levels.back().offset) + levels.back().size;
  const std::size_t offset = store.add(prefix + ".table", {entries, config.features});
  for (std::size_t i = offset; i < store.values.size(); ++i)
    store.values[i] = float(kInit * (2 * rng_uniform(seed, RngStream::kHashInit, i - offset) - 1));
  return offset;
}

HashGrid::HashGrid(const HashGridConfig& config, const HashBox<float>& box, std::size_t offset)
    : config_(config), box_(box), offset_(offset), levels_(hash_levels(config)) {}

HashGridView<float> HashGrid::view(const ParamStore& store, Rows<const float, 3> points) const {
  return {levels_.data(), config_.levels, box_, store.values.data() + offset_, points};
}

void HashGrid::forward(const Exec& exec, const ParamStore& store, Rows<const float, 3> points,
                       std::vector<float>& out) const {
  out.resize(std::size_t(points.n) * std::size_t(config_.outputs()));
  if (exec.device_ops)
    return exec.device_ops->field.hash_forward({view(store, points), config_.features, entries()}, out);
  with_hash_features(config_.features, [&](auto features) {
    const HashForward<float, features> kernel{view(store, points), out.data()};
    for_each_task(exec, (points.n + kQueriesPerTask - 1) / kQueriesPerTask, [&](std::int64_t task) {
      const std::int64_t end = std::min(points.n, (task + 1) * kQueriesPerTask);
      for (int l = 0; l < config_.levels; ++l)
        for (std::int64_t q = task * kQueriesPerTask; q < end; ++q) kernel.at(l, q);
    });
  });
}

void HashGrid::backward(const Exec& exec, ParamStore& store, Rows<const float, 3> points,
                        const std::vector<float>& grad_out) const {
  NGS_CHECK(grad_out.size() == std::size_t(points.n) * std::size_t(config_.outputs()), "one gradient row per point");
  if (exec.device_ops)
    return exec.device_ops->field.hash_backward({view(store, points), config_.features, entries()}, grad_out,
                                                store.grads.data() + offset_);
  with_hash_features(config_.features, [&](auto features) {
    for_each_task(
        exec, config_.levels,
        HashBackwardTable<float, features>{view(store, points), grad_out.data(), store.grads.data() + offset_});
  });
}

}  // namespace ngs
