#include "ngs/ops/splat/prepared_cloud.h"

#include "ngs/backend/for_each.h"
#include "ngs/ops/splat/cloud_view.h"

namespace ngs {

PreparedCloud::PreparedCloud(const Exec& exec, const CloudView<float>& cloud) : source_(cloud) {
  bounds.resize(std::size_t((cloud.size + kBlockRows - 1) / kBlockRows));
  const std::size_t rows = bounds.size() * kBlockRows;
  for (auto& column : position) column.resize(rows);
  for (auto& column : shape) column.resize(rows);
  for (auto* column : {&opacity, &two_cut, &log2_opacity, &scale_bound}) column->resize(rows);
  for_each_task(exec, blocks(), [&](std::int64_t block) {
    const std::int64_t end = std::min(cloud.size, (block + 1) * kBlockRows);
    for (std::int64_t i = block * kBlockRows; i < end; ++i) prepare_row(cloud, i);
    bounds[std::size_t(block)] = bounds_of(block);
  });
}

bool PreparedCloud::serves(const CloudView<float>& cloud) const {
  return cloud.size == source_.size && cloud.position == source_.position && cloud.rotation == source_.rotation &&
         cloud.log_scale == source_.log_scale && cloud.logit_opacity == source_.logit_opacity &&
         cloud.usable == source_.usable;
}

void PreparedCloud::update(const Exec& exec, const std::vector<std::int64_t>& rows) {
  std::vector<std::size_t> first;  // of each block's rows in `rows`
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (r == 0 || rows[r] / kBlockRows != rows[r - 1] / kBlockRows) first.push_back(r);
  first.push_back(rows.size());
  for_each_task(exec, std::int64_t(first.size()) - 1, [&](std::int64_t b) {
    const std::size_t begin = first[std::size_t(b)], end = first[std::size_t(b) + 1];
    for (std::size_t r = begin; r < end; ++r) prepare_row(source_, rows[r]);
    const std::int64_t block = rows[begin] / kBlockRows;
    bounds[std::size_t(block)] = bounds_of(block);
  });
}

void PreparedCloud::prepare_row(const CloudView<float>& cloud, std::int64_t i) {
  const auto row = std::size_t(i);
  const float* log_scale = cloud.log_scale + i * 3;
  ProjectionContext<float> ctx;
  gaussian_shape(cloud.rotation + i * 4, log_scale, ctx);
  for (std::size_t k = 0; k < 3; ++k) position[k][row] = cloud.position[row * 3 + k];
  for (std::size_t k = 0; k < 9; ++k) shape[k][row] = ctx.m.m[k];
  const float o = sigmoid(cloud.logit_opacity[i]);
  opacity[row] = cloud.usable && !cloud.usable[i] ? 0.f : o;
  two_cut[row] = two_cut_of(o), log2_opacity[row] = log2_opacity_of(o);
  scale_bound[row] = exp_at_least(max2(max2(log_scale[0], log_scale[1]), log_scale[2]));
}

BlockBounds PreparedCloud::bounds_of(std::int64_t block) const {
  BlockBounds b;
  for (auto i = std::size_t(block) * kBlockRows; i < std::size_t(block + 1) * kBlockRows; ++i) {
    if (!(opacity[i] >= float(kAlphaMin))) continue;
    for (std::size_t k = 0; k < 3; ++k)
      b.lo[k] = min2(b.lo[k], position[k][i]), b.hi[k] = max2(b.hi[k], position[k][i]);
    b.scale = max2(b.scale, scale_bound[i]);
  }
  return b;
}

std::shared_ptr<PreparedCloud> prepare_cloud(const Exec& exec, const GaussianCloud& cloud) {
  if (exec.device_ops) return nullptr;  // the device prepares rows itself
  return std::make_shared<PreparedCloud>(exec, cloud_view(cloud, 0, nullptr));
}

void update_prepared(const Exec& exec, const std::vector<std::int64_t>& rows, PreparedCloud& prepared) {
  prepared.update(exec, rows);
}

SplatOptions prepared_for(const Exec& exec, SplatOptions options, const GaussianCloud& cloud) {
  if (!options.prepared || !options.prepared->serves(cloud_view(cloud, 0, nullptr)))
    options.prepared = prepare_cloud(exec, cloud);
  return options;
}

}  // namespace ngs
