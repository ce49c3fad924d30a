#include "ngs/edit/extract/extract_stage.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/core/parse_number.h"
#include "ngs/math/elementary.h"
#include "ngs/math/median.h"
#include "ngs/math/union_find.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

[[noreturn]] void bad_rule(const std::string& rule, const std::string& expected) {
  throw Error(ErrorCode::kUsage, "rule = " + rule + ", expected " + expected);
}

double rule_value(const std::string& rule, std::size_t colon, double low, double high) {
  double value = 0;
  if (!parse_number(std::string_view(rule).substr(colon + 1), value) || !(value >= low && value <= high)) {
    char range[64];
    std::snprintf(range, sizeof range, "a number in [%g, %g] after the colon", low, high);
    bad_rule(rule, range);
  }
  return value;
}

std::vector<std::uint32_t> rows_where(std::size_t n, const auto& chosen) {
  std::vector<std::uint32_t> rows;
  for (std::size_t i = 0; i < n; ++i)
    if (chosen(i)) rows.push_back(std::uint32_t(i));
  return rows;
}

Rows<const float, 3> as_rows(const std::vector<float>& positions) {
  return {positions.data(), std::int64_t(positions.size() / 3)};
}

struct RowsByVisibility {
  std::vector<std::uint32_t> seen, unseen;
};

float largest_scale(const GaussianCloud& cloud, std::uint32_t i) {
  const float* s = &cloud.log_scale[i * 3ull];
  return exp_of(std::max({s[0], s[1], s[2]}));
}

/// Median of the distances to neighbour k (k = 0: the nearest); 0 without neighbours.
float median_spacing(const KnnGraph& graph, std::size_t k) {
  std::vector<float> dist2;
  for (std::size_t q = k; q < graph.dist2.size(); q += std::size_t(graph.neighbours)) dist2.push_back(graph.dist2[q]);
  return dist2.empty() ? 0 : float(std::sqrt(upper_median({dist2.begin(), dist2.end()})));
}

/// Distance within which the neighbours of Gaussian i vote.
float reach_of(const GaussianCloud& cloud, std::uint32_t i, float spacing) {
  return std::max(float(kVoteReach) * spacing, float(kOwnVoteReach) * largest_scale(cloud, i));
}

/// The members of `rows` within `margin` of the bounding box of the object's seen Gaussians. Every other row is farther
/// than `margin` from all of them.
std::vector<std::uint32_t> rows_near(const GaussianCloud& cloud, const std::vector<float>& object, float spacing,
                                     const std::vector<std::uint32_t>& rows) {
  std::array<float, 3> low, high;
  for (std::size_t a = 0; a < 3; ++a) low[a] = high[a] = object[a];
  for (std::size_t k = 0; k < object.size(); ++k) {
    low[k % 3] = std::min(low[k % 3], object[k]);
    high[k % 3] = std::max(high[k % 3], object[k]);
  }
  std::vector<std::uint32_t> inside;
  for (const std::uint32_t i : rows) {
    const float* p = &cloud.position[i * 3ull];
    const float margin = reach_of(cloud, i, spacing);
    bool is_inside = true;
    for (std::size_t a = 0; a < 3; ++a) is_inside &= p[a] >= low[a] - margin && p[a] <= high[a] + margin;
    if (is_inside) inside.push_back(i);
  }
  return inside;
}

/// An unseen Gaussian becomes object if more than half of its nearest seen Gaussians are object and within reach.
void label_unseen_by_neighbours(const Exec& exec, const ExtractOptions& options, const GaussianCloud& cloud,
                                const RowsByVisibility& rows, Extraction& out) {
  std::vector<std::uint32_t> objects;
  for (const std::uint32_t i : rows.seen)
    if (out.object[i]) objects.push_back(i);
  if (rows.unseen.empty() || objects.empty()) return;
  const std::vector<float> object = gather_column(exec, cloud.position, 3, objects);
  const KnnGraph among = nearest_others(exec, as_rows(object), options.unseen_neighbours);
  const float spacing = median_spacing(among, std::size_t(std::max(1, among.neighbours) - 1));
  const std::vector<std::uint32_t> candidates = rows_near(cloud, object, spacing, rows.unseen);
  const std::vector<float> points = gather_column(exec, cloud.position, 3, rows.seen),
                           queries = gather_column(exec, cloud.position, 3, candidates);
  const KnnGraph graph = nearest_points(exec, as_rows(points), as_rows(queries), options.unseen_neighbours);
  const auto voters = std::size_t(graph.neighbours);
  for (std::size_t q = 0; q < candidates.size(); ++q) {
    const float reach = reach_of(cloud, candidates[q], spacing);
    std::size_t votes = 0;
    for (std::size_t k = q * voters; k < (q + 1) * voters; ++k)
      votes += out.object[rows.seen[graph.index[k]]] && std::sqrt(graph.dist2[k]) <= reach;
    out.object[candidates[q]] = 2 * votes > voters;
  }
}

void remove_small_components(const Exec& exec, const ExtractOptions& options, const ExtractInput& input,
                             Extraction& out) {
  const std::vector<std::int32_t> component =
      connected_components(exec, input.cloud, out.object, options.component_neighbours);
  std::vector<std::int64_t> size;
  std::vector<std::uint8_t> is_fixed;
  for (std::size_t i = 0; i < component.size(); ++i) {
    if (component[i] < 0) continue;
    const std::size_t p = std::size_t(component[i]);
    if (p >= size.size()) {
      size.resize(p + 1);
      is_fixed.resize(p + 1);
    }
    ++size[p];
    is_fixed[p] |= !input.fixed.empty() && input.fixed[i] == 1;
  }
  out.components = std::int64_t(size.size());
  const auto is_small = [&](std::size_t p) { return size[p] < options.min_component && !is_fixed[p]; };
  for (std::size_t p = 0; p < size.size(); ++p) out.removed_components += is_small(p);
  for (std::size_t i = 0; i < component.size(); ++i)
    if (component[i] >= 0 && is_small(std::size_t(component[i]))) {
      out.object[i] = 0;
      ++out.removed;
    }
}

}  // namespace

ExtractRule parse_extract_rule(const std::string& rule) {
  const std::size_t colon = rule.find(':');
  const std::string kind = rule.substr(0, colon);
  if (rule == "sa3d") return {.cut = 0.3 / 1.3, .inclusive = false, .on_prob = true};
  const bool known = kind == "threshold" || kind == "flash" || kind == "flash-l2" || kind == "cob";
  if (!known || colon == std::string::npos) bad_rule(rule, "threshold:T, flash:GAMMA, flash-l2:GAMMA, sa3d or cob:T");
  if (kind == "threshold") return {.cut = rule_value(rule, colon, 0, 1), .inclusive = true, .on_prob = false};
  if (kind == "cob") return {.cut = rule_value(rule, colon, 0, 1), .inclusive = false, .on_prob = false};
  const double gamma = rule_value(rule, colon, -1, 1);
  if (kind == "flash") return {.cut = 0.5 * (1 + gamma), .inclusive = false, .on_prob = true};
  // a0/|a| + gamma < a1/|a| with the 2-norm: the pair lies beyond 45° + asin(gamma/√2) on its circle.
  const double t = std::tan(std::atan(1.0) + std::asin(gamma / std::sqrt(2.0)));
  return {.cut = t / (1 + t), .inclusive = false, .on_prob = true};
}

std::vector<std::int32_t> connected_components(const Exec& exec, const GaussianCloud& cloud,
                                               const std::vector<std::uint8_t>& member, int neighbours) {
  const std::size_t n = std::size_t(cloud.size());
  NGS_CHECK(member.size() == n, "one entry per Gaussian");
  const std::vector<std::uint32_t> rows = rows_where(n, [&](std::size_t i) { return member[i] && cloud.usable[i]; });
  const std::vector<float> points = gather_column(exec, cloud.position, 3, rows);
  const KnnGraph graph = nearest_others(exec, as_rows(points), neighbours);
  const std::size_t neighbours_each = std::size_t(graph.neighbours);

  const float spacing = median_spacing(graph, 0);
  UnionFind sets(rows.size());
  for (std::size_t q = 0; q < rows.size(); ++q)
    for (std::size_t k = 0; k < neighbours_each; ++k) {
      const std::uint32_t other = graph.index[q * neighbours_each + k];
      const float reach = 3 * std::max(spacing, largest_scale(cloud, rows[q]) + largest_scale(cloud, rows[other]));
      if (std::sqrt(graph.dist2[q * neighbours_each + k]) <= reach) sets.join(std::uint32_t(q), other);
    }
  std::vector<std::int32_t> component(n, -1);
  std::int32_t next = 0;
  for (std::size_t q = 0; q < rows.size(); ++q) {
    const std::uint32_t root = sets.root(std::uint32_t(q));
    component[rows[q]] = root == q ? next++ : component[rows[root]];
  }
  return component;
}

Extraction extract_object(const Exec& exec, const ExtractOptions& options, const ExtractInput& input) {
  const ExtractRule rule = parse_extract_rule(options.rule);
  const bool wants_prob = options.score == ScoreColumn::kAuto ? rule.on_prob : options.score == ScoreColumn::kProb;
  const LabelColumns& labels = input.labels;
  const LabelColumn& score = (wants_prob && !labels.prob.empty()) || labels.label.empty() ? labels.prob : labels.label;
  const std::size_t n = std::size_t(input.cloud.size());
  if (score.size() != n)
    throw Error(ErrorCode::kBadInput, "the model has neither ngs_label nor ngs_prob, expected a labelled model",
                "label it first: ngs-variance scene.json -o boundary.ply");
  NGS_CHECK(labels.views.empty() || labels.views.size() == n, "ngs_views has one entry per Gaussian");
  NGS_CHECK(input.fixed.empty() || (input.fixed.size() == n && labels.label.size() == n), "ngs_fixed needs ngs_label");

  const auto is_fixed = [&](std::size_t i) { return !input.fixed.empty() && input.fixed[i] == 1; };
  const auto is_unseen = [&](std::size_t i) { return !labels.views.empty() && labels.views[i] == 0 && !is_fixed(i); };
  Extraction out;
  out.object.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    if (!input.cloud.usable[i])
      ++out.unusable;
    else if (is_fixed(i)) {
      out.object[i] = is_set(labels.label[i]);
      ++out.fixed;
    } else if (!is_unseen(i))
      out.object[i] = rule.inclusive ? score[i] >= rule.cut : score[i] > rule.cut;
    else
      out.object[i] = options.unseen == UnseenRule::kObject;
  }
  const RowsByVisibility rows{rows_where(n, [&](std::size_t i) { return input.cloud.usable[i] && !is_unseen(i); }),
                              rows_where(n, [&](std::size_t i) { return input.cloud.usable[i] && is_unseen(i); })};
  if (options.unseen == UnseenRule::kKnn) label_unseen_by_neighbours(exec, options, input.cloud, rows, out);
  out.unseen = std::int64_t(rows.unseen.size());
  for (const std::uint32_t i : rows.unseen) out.unseen_to_object += out.object[i];
  if (options.min_component > 0) remove_small_components(exec, options, input, out);
  out.objects = std::count(out.object.begin(), out.object.end(), std::uint8_t(1));
  return out;
}

}  // namespace ngs
