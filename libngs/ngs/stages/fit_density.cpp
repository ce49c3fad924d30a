#include "ngs/stages/fit_density.h"

#include <algorithm>
#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/core/rng.h"
#include "ngs/math/quat.h"
#include "ngs/math/stable.h"

namespace ngs {
namespace {

constexpr double kSplitShrink = 1.6;

enum class Origin : std::uint8_t { kKept, kClone, kChild0, kChild1 };
struct Row {
  std::int64_t source;
  Origin origin;
};

double largest_scale(const GaussianCloud& cloud, std::int64_t i) {
  const float* s = &cloud.log_scale[std::size_t(i) * 3];
  return std::exp(double(std::max({s[0], s[1], s[2]})));
}

/// Gaussians whose mean gradient asks for more of them, those with the largest gradients first if there is no
/// room for all.
std::vector<std::int64_t> candidates(const FitState& state, const DensityRule& rule) {
  std::vector<std::int64_t> chosen;
  const auto mean = [&](std::int64_t i) {
    const float views = state.gradient_views[std::size_t(i)];
    return views > 0 ? double(state.gradient_sum[std::size_t(i)]) / double(views) : 0.0;
  };
  const std::int64_t n = state.cloud.size(), room = std::max<std::int64_t>(0, rule.max_gaussians - n);
  for (std::int64_t i = 0; i < n; ++i)
    if (mean(i) >= rule.gradient) chosen.push_back(i);
  if (std::int64_t(chosen.size()) > room) {
    std::sort(chosen.begin(), chosen.end(), [&](std::int64_t a, std::int64_t b) {
      const double ga = mean(a), gb = mean(b);
      return ga != gb ? ga > gb : a < b;
    });
    chosen.resize(std::size_t(room));
    std::sort(chosen.begin(), chosen.end());
  }
  return chosen;
}

std::vector<Row> plan_rows(const FitState& state, const DensityRule& rule, DensityChange& change) {
  const GaussianCloud& cloud = state.cloud;
  const std::vector<std::int64_t> chosen = candidates(state, rule);
  std::vector<std::uint8_t> is_split(std::size_t(cloud.size()), 0);
  std::vector<Row> clones, children, rows;
  for (const std::int64_t i : chosen) {
    if (largest_scale(cloud, i) <= rule.dense_scale) {
      clones.push_back({i, Origin::kClone});
    } else {
      is_split[std::size_t(i)] = 1;
      children.push_back({i, Origin::kChild0}), children.push_back({i, Origin::kChild1});
    }
  }
  for (std::int64_t i = 0; i < cloud.size(); ++i)
    if (!is_split[std::size_t(i)]) rows.push_back({i, Origin::kKept});
  rows.insert(rows.end(), clones.begin(), clones.end());
  rows.insert(rows.end(), children.begin(), children.end());
  change.cloned = std::int64_t(clones.size()), change.split = std::int64_t(children.size()) / 2;

  const float faint = logit(float(rule.min_opacity));
  std::vector<Row> left;
  for (const Row row : rows) {
    const bool child = row.origin >= Origin::kChild0;
    const double scale = largest_scale(cloud, row.source) / (child ? kSplitShrink : 1);
    const bool too_large = rule.max_scale > 0 && scale > rule.max_scale;
    if (cloud.logit_opacity[std::size_t(row.source)] >= faint && !too_large) left.push_back(row);
  }
  if (left.empty()) left.push_back(rows.front());
  change.pruned = std::int64_t(rows.size() - left.size());
  return left;
}

void gather(const Exec& exec, const std::vector<Row>& rows, int columns, std::vector<float>& values) {
  std::vector<float> out(rows.size() * std::size_t(columns));
  for_each_index(exec, std::int64_t(rows.size()), [&](std::int64_t r) {
    const auto source = std::size_t(rows[std::size_t(r)].source) * std::size_t(columns);
    std::copy_n(values.begin() + std::ptrdiff_t(source), columns, out.begin() + std::ptrdiff_t(r * columns));
  });
  values = std::move(out);
}

void gather_moments(const std::vector<Row>& rows, int columns, std::vector<float>& moments) {
  if (moments.empty()) return;
  std::vector<float> out(rows.size() * std::size_t(columns), 0.f);
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (rows[r].origin == Origin::kKept)
      std::copy_n(moments.begin() + std::ptrdiff_t(rows[r].source * columns), columns,
                  out.begin() + std::ptrdiff_t(r * std::size_t(columns)));
  moments = std::move(out);
}

/// Moves a gathered copy of its parent to a place drawn from the parent, and shrinks it.
void place_child(GaussianCloud& cloud, std::size_t r, const Row& row, std::uint64_t seed) {
  const float *q = &cloud.rotation[r * 4], *s = &cloud.log_scale[r * 3];
  double inv;
  const Mat3<double> turn =
      rotation_matrix(normalised(Vec4<double>{double(q[0]), double(q[1]), double(q[2]), double(q[3])}, inv));
  const std::uint64_t draw = 2 * std::uint64_t(row.source) + (row.origin == Origin::kChild1);
  double local[3];
  for (std::uint64_t k = 0; k < 3; ++k)
    local[k] = std::exp(double(s[k])) * rng_normal(seed, RngStream::kSplit, 3 * draw + k);
  const Vec3<double> offset = turn * Vec3<double>{local[0], local[1], local[2]};
  float* p = &cloud.position[r * 3];
  p[0] += float(offset.x), p[1] += float(offset.y), p[2] += float(offset.z);
  for (std::size_t k = 0; k < 3; ++k) cloud.log_scale[r * 3 + k] -= float(std::log(kSplitShrink));
}

}  // namespace

DensityChange densify_and_prune(const Exec& exec, FitState& state, const DensityRule& rule, std::uint64_t seed) {
  DensityChange change;
  const std::vector<Row> rows = plan_rows(state, rule, change);
  GaussianCloud& cloud = state.cloud;
  const int rest = cloud.rest_count() * 3;
  std::vector<float>* values[kFitGroups] = {&cloud.position, &cloud.rotation, &cloud.log_scale,
                                            &cloud.logit_opacity, &cloud.sh_dc, &cloud.sh_rest};
  const int columns[kFitGroups] = {3, 4, 3, 1, 3, rest};
  for (std::size_t g = 0; g < kFitGroups; ++g) {
    gather(exec, rows, columns[g], *values[g]);
    gather_moments(rows, columns[g], state.moments[g].m);
    gather_moments(rows, columns[g], state.moments[g].v);
  }
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (rows[r].origin >= Origin::kChild0) place_child(cloud, r, rows[r], seed);
  cloud.usable.assign(rows.size(), 1);
  state.gradient_sum.assign(rows.size(), 0.f);
  state.gradient_views.assign(rows.size(), 0.f);
  return change;
}

}  // namespace ngs
