#include "ngs/io/formats/splat_table.h"

#include <algorithm>

#include "ngs/core/check.h"
#include "ngs/math/curve_order.h"
#include "ngs/math/elementary.h"
#include "ngs/scene/precision/local_origin.h"

namespace ngs::io {
namespace {

constexpr std::size_t kColumnsWithoutRest = 14, kMaxColumns = kColumnsWithoutRest + 45;

}  // namespace

PlyTable splat_table(std::int64_t count, int sh_degree) {
  std::vector<PlyProperty> properties;
  const auto add = [&](std::string name) { properties.push_back({.name = std::move(name)}); };
  for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2"}) add(name);
  for (int k = 0; k < 3 * sh_rest_count(sh_degree); ++k) add("f_rest_" + std::to_string(k));
  for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"}) add(name);
  PlyTable table;
  table.set_properties(std::move(properties));
  table.rows = count;
  table.owned.resize(std::size_t(count) * table.row_bytes);
  return table;
}

void store_row(PlyTable& table, std::int64_t i, const SplatRow& row) {
  const std::size_t coefficients = (table.properties.size() - kColumnsWithoutRest) / 3;
  float values[kMaxColumns];
  float* at = std::copy(row.position.begin(), row.position.end(), values);
  at = std::copy(row.sh_dc.begin(), row.sh_dc.end(), at);
  for (std::size_t channel = 0; channel < 3; ++channel)
    for (std::size_t k = 0; k < coefficients; ++k) *at++ = row.sh_rest[k * 3 + channel];
  *at++ = row.logit_opacity;
  at = std::copy(row.log_scale.begin(), row.log_scale.end(), at);
  std::copy(row.rotation.begin(), row.rotation.end(), at);
  std::memcpy(table.owned.data() + std::size_t(i) * table.row_bytes, values, table.row_bytes);
}

SplatSelection select_rows(const GaussianCloud& cloud, const std::vector<std::uint8_t>& keep) {
  NGS_CHECK(keep.empty() || std::int64_t(keep.size()) == cloud.size(), "keep has one entry per Gaussian");
  SplatSelection selection{cloud, {}, 0, {}, {}};
  if (!needs_local_origin(cloud)) selection.shift = cloud.origin;
  for (std::int64_t i = 0; i < cloud.size(); ++i) {
    if (!keep.empty() && !keep[std::size_t(i)]) continue;
    if (cloud.usable[std::size_t(i)])
      selection.rows.push_back(i);
    else
      ++selection.left_out;
  }
  return selection;
}

SplatRow load_row(const SplatSelection& model, std::int64_t i) {
  const GaussianCloud& cloud = model.cloud;
  const std::size_t r = std::size_t(i), rest = std::size_t(cloud.rest_count()) * 3;
  SplatRow row;
  for (std::size_t a = 0; a < 3; ++a) row.position[a] = float(model.shift[a] + double(cloud.position[r * 3 + a]));
  std::copy_n(&cloud.sh_dc[r * 3], 3, row.sh_dc.begin());
  std::copy_n(cloud.sh_rest.data() + r * rest, rest, row.sh_rest.begin());
  row.logit_opacity = cloud.logit_opacity[r];
  std::copy_n(&cloud.log_scale[r * 3], 3, row.log_scale.begin());
  double length = 0;
  for (std::size_t k = 0; k < 4; ++k) length = portable_hypot(length, double(cloud.rotation[r * 4 + k]));
  for (std::size_t k = 0; k < 4; ++k)
    row.rotation[k] = length > 0 ? float(double(cloud.rotation[r * 4 + k]) / length) : k == 0 ? 1.f : 0.f;
  if (model.turn) model.turn(row);
  return row;
}

SplatSelection along_morton_curve(const SplatSelection& model) {
  std::vector<float> points;
  for (const std::int64_t i : model.rows)
    points.insert(points.end(), &model.cloud.position[std::size_t(i) * 3],
                  &model.cloud.position[std::size_t(i) * 3] + 3);
  SplatSelection sorted{model.cloud, {}, model.left_out, model.shift, model.turn};
  for (const std::uint32_t k : curve_order(points)) sorted.rows.push_back(model.rows[k]);
  return sorted;
}

}  // namespace ngs::io
