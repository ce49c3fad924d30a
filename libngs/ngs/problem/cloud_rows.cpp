#include "ngs/problem/cloud_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ngs/backend/for_each.h"
#include "ngs/core/rng.h"
#include "ngs/math/quat.h"
#include "ngs/math/stable.h"

namespace ngs {
namespace {

void gather_moments(const std::vector<CloudRow>& rows, int width, std::vector<float>& moments) {
  if (moments.empty()) return;
  std::vector<float> out(rows.size() * std::size_t(width), 0.f);
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (rows[r].origin == RowOrigin::kKept)
      std::copy_n(moments.begin() + std::ptrdiff_t(rows[r].source * width), width,
                  out.begin() + std::ptrdiff_t(r * std::size_t(width)));
  moments = std::move(out);
}

void move_by(GaussianCloud& cloud, std::size_t r, Vec3<double> offset) {
  float* p = &cloud.position[r * 3];
  p[0] += float(offset.x);
  p[1] += float(offset.y);
  p[2] += float(offset.z);
}

/// Turns a copy of the parent into a child: samples the position from the parent and shrinks the scales.
void place_child(GaussianCloud& cloud, std::size_t r, const CloudRow& row, std::uint64_t seed) {
  const float* s = &cloud.log_scale[r * 3];
  const std::uint64_t draw = 2 * std::uint64_t(row.source) + (row.origin == RowOrigin::kChild1);
  double local[3];
  for (std::uint64_t k = 0; k < 3; ++k)
    local[k] = std::exp(double(s[k])) * rng_normal(seed, RngStream::kSplit, 3 * draw + k);
  move_by(cloud, r, axes_of_quaternion(&cloud.rotation[r * 4]) * Vec3<double>{local[0], local[1], local[2]});
  for (std::size_t k = 0; k < 3; ++k) cloud.log_scale[r * 3 + k] -= float(std::log(kSplitShrink));
}

/// Two normal densities at ±d with deviation s have the joint variance d² + s². With the parent's deviation 1 and
/// d = 0.75, s = sqrt(1 - d²). The integrals of optical depth along the axis add up to the parent's if each half has
/// 1 / (2 s) of its peak.
void place_half(GaussianCloud& cloud, std::size_t r, RowOrigin half) {
  constexpr double kShift = 0.75;
  const double shrink = std::sqrt(1 - kShift * kShift);
  float* s = &cloud.log_scale[r * 3];
  const auto axis = std::size_t(std::max_element(s, s + 3) - s);
  double local[3] = {0, 0, 0};
  local[axis] = (half == RowOrigin::kHalf0 ? kShift : -kShift) * std::exp(double(s[axis]));
  move_by(cloud, r, axes_of_quaternion(&cloud.rotation[r * 4]) * Vec3<double>{local[0], local[1], local[2]});
  s[axis] += float(std::log(shrink));
  const double depth = softplus(double(cloud.logit_opacity[r])) / (2 * shrink);  // -log(1 - opacity) of one half
  cloud.logit_opacity[r] = float(std::log(std::max(std::expm1(depth), 1e-300)));
}

/// Calls f(object, column) for every column, in parallel.
template <class F>
void for_each_label_column(const Exec& exec, std::size_t objects, const F& f) {
  constexpr std::size_t kColumns = std::size(kLabelColumns);
  for_each_task(exec, std::int64_t(objects * kColumns), [&](std::int64_t task) {
    f(std::size_t(task) / kColumns, kLabelColumns[std::size_t(task) % kColumns]);
  });
}

template <class Row>
LabelColumn gather_label_column(const LabelColumn& column, const std::vector<Row>& rows) {
  LabelColumn part(rows.size(), 0.f);
  for (std::size_t r = 0; r < rows.size(); ++r) part[r] = column[std::size_t(source_of(rows[r]))];
  return part;
}

}  // namespace

void edit_column(const Exec& exec, const std::vector<CloudRow>& rows, int width, std::vector<float>& values) {
  values = gather_column(exec, values, width, rows);
}

void edit_rows(const Exec& exec, const std::vector<CloudRow>& rows, std::uint64_t seed, GaussianCloud& cloud) {
  edit_column(exec, rows, 3, cloud.position);
  edit_column(exec, rows, 4, cloud.rotation);
  edit_column(exec, rows, 3, cloud.log_scale);
  edit_column(exec, rows, 1, cloud.logit_opacity);
  edit_column(exec, rows, 3, cloud.sh_dc);
  edit_column(exec, rows, cloud.rest_count() * 3, cloud.sh_rest);
  cloud.usable = gather_column(exec, cloud.usable, 1, rows);
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (rows[r].origin >= RowOrigin::kHalf0)
      place_half(cloud, r, rows[r].origin);
    else if (rows[r].origin >= RowOrigin::kChild0)
      place_child(cloud, r, rows[r], seed);
}

GaussianCloud gather_rows(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::int64_t>& rows) {
  GaussianCloud part;
  part.origin = cloud.origin;
  part.sh_degree = cloud.sh_degree;
  part.antialiased = cloud.antialiased;
  part.position = gather_column(exec, cloud.position, 3, rows);
  part.rotation = gather_column(exec, cloud.rotation, 4, rows);
  part.log_scale = gather_column(exec, cloud.log_scale, 3, rows);
  part.logit_opacity = gather_column(exec, cloud.logit_opacity, 1, rows);
  part.sh_dc = gather_column(exec, cloud.sh_dc, 3, rows);
  part.sh_rest = gather_column(exec, cloud.sh_rest, cloud.rest_count() * 3, rows);
  part.usable = gather_column(exec, cloud.usable, 1, rows);
  return part;
}

void scatter_rows(const Exec& exec, const GaussianCloud& part, const std::vector<std::int64_t>& rows,
                  GaussianCloud& cloud) {
  scatter_column(exec, part.position, 3, rows, cloud.position);
  scatter_column(exec, part.rotation, 4, rows, cloud.rotation);
  scatter_column(exec, part.log_scale, 3, rows, cloud.log_scale);
  scatter_column(exec, part.logit_opacity, 1, rows, cloud.logit_opacity);
  scatter_column(exec, part.sh_dc, 3, rows, cloud.sh_dc);
  scatter_column(exec, part.sh_rest, cloud.rest_count() * 3, rows, cloud.sh_rest);
  scatter_column(exec, part.usable, 1, rows, cloud.usable);
}

void edit_moments(const std::vector<CloudRow>& rows, int width, AdamMoments& moments) {
  gather_moments(rows, width, moments.m);
  gather_moments(rows, width, moments.v);
}

double largest_scale(const GaussianCloud& cloud, std::int64_t row) {
  const float* s = &cloud.log_scale[std::size_t(row) * 3];
  return std::exp(double(std::max({s[0], s[1], s[2]})));
}

std::vector<LabelColumns> gather_labels(const Exec& exec, const std::vector<LabelColumns>& labels,
                                        const std::vector<std::int64_t>& rows) {
  std::vector<LabelColumns> part(labels.size());
  for_each_label_column(exec, labels.size(), [&](std::size_t k, LabelColumn LabelColumns::*column) {
    part[k].*column = gather_label_column(labels[k].*column, rows);
  });
  return part;
}

void scatter_labels(const Exec& exec, const std::vector<LabelColumns>& part, const std::vector<std::int64_t>& rows,
                    std::vector<LabelColumns>& labels) {
  for_each_label_column(exec, labels.size(), [&](std::size_t k, LabelColumn LabelColumns::*column) {
    for (std::size_t r = 0; r < rows.size(); ++r)
      (labels[k].*column)[std::size_t(rows[r])] = (std::as_const(part[k]).*column)[r];
  });
}

void edit_labels(const Exec& exec, const std::vector<CloudRow>& rows, std::vector<LabelColumns>& labels) {
  for_each_label_column(exec, labels.size(), [&](std::size_t k, LabelColumn LabelColumns::*column) {
    labels[k].*column = gather_label_column(labels[k].*column, rows);
  });
}

}  // namespace ngs
