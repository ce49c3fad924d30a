#include "ngs/ops/splat/prepared/prepared_cloud.h"

#include <algorithm>

#include "ngs/backend/for_each.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/splat/cloud_view.h"
#include "ngs/ops/splat/prepared/curve_blocks.h"

namespace ngs {
namespace {

/// Prefetch distance in rows: neighbours along the curve are scattered in the cloud.
constexpr std::size_t kPrefetchRows = 16;

void prefetch_row(const CloudView<float>& cloud, std::size_t i) {
  __builtin_prefetch(cloud.position + 3 * i);
  __builtin_prefetch(cloud.rotation + 4 * i);
  __builtin_prefetch(cloud.log_scale + 3 * i);
  __builtin_prefetch(cloud.logit_opacity + i);
}

}  // namespace

void BlockBounds::cover(const BlockBounds& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    lo[k] = min2(lo[k], other.lo[k]);
    hi[k] = max2(hi[k], other.hi[k]);
  }
  scale = max2(scale, other.scale);
}

PreparedCloud::PreparedCloud(const Exec& exec, const CloudView<float>& cloud) : source_(cloud) {
  if (exec.device_ops) {
    on_device_ = exec.device_ops->splat.resident(cloud);
    return;
  }
  row = parallel_curve_order(exec, {cloud.position, std::size_t(3 * cloud.size)});
  bounds.resize((row.size() + kBlockRows - 1) / kBlockRows);
  const std::size_t places = bounds.size() * kBlockRows;
  for (auto& column : position) column.resize(places);
  for (auto& column : shape) column.resize(places);
  for (auto* column : {&opacity, &max_mahalanobis2, &log2_opacity, &scale_bound}) column->resize(places);
  for_each_task(exec, blocks(), [&](std::int64_t block) {
    const auto begin = std::size_t(block) * kBlockRows, end = std::min(row.size(), begin + kBlockRows);
    for (std::size_t place = begin; place < end; ++place) {
      if (place + kPrefetchRows < row.size()) prefetch_row(source_, row[place + kPrefetchRows]);
      prepare_place(place);
    }
    for (std::size_t place = end; place < begin + kBlockRows; ++place) clear_place(place);
    bounds[std::size_t(block)] = bounds_of(block);
  });
  bound_groups();
}

PreparedCloud::~PreparedCloud() = default;

bool PreparedCloud::serves(const CloudView<float>& cloud) const { return !on_device_ && is_from(cloud); }

DeviceCloud* PreparedCloud::on_device(const CloudView<float>& cloud) const {
  const bool same_colours = cloud.sh_dc == source_.sh_dc && cloud.sh_rest == source_.sh_rest;
  return is_from(cloud) && same_colours ? on_device_.get() : nullptr;
}

bool PreparedCloud::is_from(const CloudView<float>& cloud) const {
  return cloud.size == source_.size && cloud.position == source_.position && cloud.rotation == source_.rotation &&
         cloud.log_scale == source_.log_scale && cloud.logit_opacity == source_.logit_opacity &&
         cloud.usable == source_.usable;
}

void PreparedCloud::update(const Exec& exec, const std::vector<std::int64_t>& rows) {
  if (on_device_) {
    on_device_.reset();
    on_device_ = exec.device_ops->splat.resident(source_);
    return;
  }
  if (place_of_.empty()) {
    place_of_.resize(row.size());
    for (std::size_t place = 0; place < row.size(); ++place) place_of_[row[place]] = std::uint32_t(place);
  }
  std::vector<std::uint8_t> changed(bounds.size(), 0);
  for (const std::int64_t i : rows) changed[place_of_[std::size_t(i)] / kBlockRows] = 1;
  for_each_index(exec, std::int64_t(rows.size()),
                 [&](std::int64_t r) { prepare_place(place_of_[std::size_t(rows[std::size_t(r)])]); });
  for_each_index(exec, blocks(), [&](std::int64_t block) {
    if (changed[std::size_t(block)]) bounds[std::size_t(block)] = bounds_of(block);
  });
  bound_groups();
}

void PreparedCloud::prepare_place(std::size_t place) {
  const auto i = std::size_t(row[place]);
  const float* log_scale = source_.log_scale + i * 3;
  ProjectionContext<float> ctx;
  gaussian_shape(source_.rotation + i * 4, log_scale, ctx);
  for (std::size_t k = 0; k < 3; ++k) position[k][place] = source_.position[i * 3 + k];
  for (std::size_t k = 0; k < 9; ++k) shape[k][place] = ctx.m.m[k];
  const float o = sigmoid(source_.logit_opacity[i]);
  opacity[place] = source_.usable && !source_.usable[i] ? 0.f : o;
  max_mahalanobis2[place] = max_mahalanobis2_of(o);
  log2_opacity[place] = log2_opacity_of(o);
  scale_bound[place] = exp_at_least(max2(max2(log_scale[0], log_scale[1]), log_scale[2]));
}

void PreparedCloud::clear_place(std::size_t place) {
  for (auto& column : position) column[place] = 0;
  for (auto& column : shape) column[place] = 0;
  opacity[place] = max_mahalanobis2[place] = log2_opacity[place] = scale_bound[place] = 0;
}

BlockBounds PreparedCloud::bounds_of(std::int64_t block) const {
  BlockBounds b;
  for (auto i = std::size_t(block) * kBlockRows; i < std::size_t(block + 1) * kBlockRows; ++i) {
    if (!(opacity[i] >= float(kAlphaMin))) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      b.lo[k] = min2(b.lo[k], position[k][i]);
      b.hi[k] = max2(b.hi[k], position[k][i]);
    }
    b.scale = max2(b.scale, scale_bound[i]);
  }
  return b;
}

void PreparedCloud::bound_groups() {
  group_bounds.assign((bounds.size() + kGroupBlocks - 1) / kGroupBlocks, BlockBounds());
  for (std::size_t block = 0; block < bounds.size(); ++block) group_bounds[block / kGroupBlocks].cover(bounds[block]);
}

CloudOnHost on_host(const CloudView<float>& cloud, const SplatOptions& options) {
  return {cloud, options.prepared ? options.prepared->on_device(cloud) : nullptr};
}

std::shared_ptr<PreparedCloud> prepare_cloud(const Exec& exec, const GaussianCloud& cloud) {
  return std::make_shared<PreparedCloud>(exec, cloud_view(cloud, 0, nullptr));
}

void update_prepared(const Exec& exec, const std::vector<std::int64_t>& rows, PreparedCloud& prepared) {
  prepared.update(exec, rows);
}

SplatOptions prepared_for(const Exec& exec, SplatOptions options, const GaussianCloud& cloud) {
  const CloudView<float> view = cloud_view(cloud, 0, nullptr);
  const bool ready = options.prepared &&
                     (exec.device_ops ? options.prepared->on_device(view) != nullptr : options.prepared->serves(view));
  if (!ready) options.prepared = prepare_cloud(exec, cloud);
  return options;
}

SplatOptions prepared_for_device(const Exec& exec, SplatOptions options, const GaussianCloud& cloud) {
  return exec.device_ops ? prepared_for(exec, std::move(options), cloud) : options;
}

}  // namespace ngs
