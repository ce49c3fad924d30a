#include "ngs/make/fit/fit_density.h"

#include <algorithm>

#include "ngs/math/stable.h"
#include "ngs/problem/cloud_rows.h"

namespace ngs {
namespace {

/// Gaussians whose mean gradient reaches the threshold; those with the largest gradients if max_gaussians limits them.
std::vector<std::int64_t> candidates(const FitState& state, const DensityRule& rule) {
  std::vector<std::int64_t> chosen;
  const auto mean = [&](std::int64_t i) {
    const float views = state.gradient_views[std::size_t(i)];
    return views > 0 ? double(state.gradient_sum[std::size_t(i)]) / double(views) : 0.0;
  };
  const std::int64_t n = state.cloud.size(), most_new = std::max<std::int64_t>(0, rule.max_gaussians - n);
  for (std::int64_t i = 0; i < n; ++i)
    if (mean(i) >= rule.gradient) chosen.push_back(i);
  if (std::int64_t(chosen.size()) > most_new) {
    std::sort(chosen.begin(), chosen.end(), [&](std::int64_t a, std::int64_t b) {
      const double ga = mean(a), gb = mean(b);
      return ga != gb ? ga > gb : a < b;
    });
    chosen.resize(std::size_t(most_new));
    std::sort(chosen.begin(), chosen.end());
  }
  return chosen;
}

std::vector<CloudRow> plan_rows(const FitState& state, const DensityRule& rule, DensityChange& change) {
  const GaussianCloud& cloud = state.cloud;
  const std::vector<std::int64_t> chosen = candidates(state, rule);
  std::vector<std::uint8_t> is_split(std::size_t(cloud.size()), 0);
  std::vector<CloudRow> clones, children, rows;
  for (const std::int64_t i : chosen) {
    if (largest_scale(cloud, i) <= rule.dense_scale) {
      clones.push_back({i, RowOrigin::kClone});
    } else {
      is_split[std::size_t(i)] = 1;
      children.push_back({i, RowOrigin::kChild0});
      children.push_back({i, RowOrigin::kChild1});
    }
  }
  for (std::int64_t i = 0; i < cloud.size(); ++i)
    if (!is_split[std::size_t(i)]) rows.push_back({i, RowOrigin::kKept});
  rows.insert(rows.end(), clones.begin(), clones.end());
  rows.insert(rows.end(), children.begin(), children.end());
  change.cloned = std::int64_t(clones.size());
  change.split = std::int64_t(children.size()) / 2;

  const float faint = logit(float(rule.min_opacity));
  std::vector<CloudRow> remaining;
  for (const CloudRow row : rows) {
    const bool child = row.origin >= RowOrigin::kChild0;
    const double scale = largest_scale(cloud, row.source) / (child ? kSplitShrink : 1);
    const bool too_large = rule.max_scale > 0 && scale > rule.max_scale;
    if (cloud.logit_opacity[std::size_t(row.source)] >= faint && !too_large) remaining.push_back(row);
  }
  if (remaining.empty()) remaining.push_back(rows.front());
  change.pruned = std::int64_t(rows.size() - remaining.size());
  return remaining;
}

}  // namespace

DensityChange densify_and_prune(const Exec& exec, FitState& state, const DensityRule& rule, std::uint64_t seed) {
  DensityChange change;
  const std::vector<CloudRow> rows = plan_rows(state, rule, change);
  for (std::size_t g = 0; g < kGaussianGroups; ++g) edit_moments(rows, group_width(state.cloud, g), state.moments[g]);
  edit_rows(exec, rows, seed, state.cloud);
  state.gradient_sum.assign(rows.size(), 0.f);
  state.gradient_views.assign(rows.size(), 0.f);
  return change;
}

}  // namespace ngs
