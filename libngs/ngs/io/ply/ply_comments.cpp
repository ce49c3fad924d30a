// Positions far from 0: double columns are read relative to the model's centre; a comment records the origin.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/io/ply/gaussian_columns.h"
#include "ngs/io/ply/ply_scan.h"

namespace ngs::io {
namespace {

using Origin = std::array<double, 3>;
constexpr double kFar = 8;        // half extents
constexpr double kAbsurd = 1e30;  // beyond any coordinate

struct Extent {
  Origin middle{};
  double half_side = 0, distance = 0;

  void add_axis(std::size_t axis, double low, double high) {
    middle[axis] = double(float(0.5 * (low + high)));
    half_side = std::max(half_side, 0.5 * (high - low));
    distance = std::max(distance, std::abs(0.5 * (low + high)));
  }
  bool is_far() const { return distance > kFar * half_side; }
};

}  // namespace

std::optional<Origin> far_origin(const std::array<PlyColumn, 3>& position, std::int64_t rows) {
  if (std::ranges::none_of(position, [](const PlyColumn& c) { return c.type == PlyType::kFloat64; })) return {};
  Extent all, bulk;  // both, because one distant row would hide that the others are far from 0
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<double> values;
    for (std::int64_t i = 0; i < rows; ++i)
      if (const double v = position[a].value(i); std::abs(v) < kAbsurd) values.push_back(v);
    if (values.empty()) return {};
    const auto value_at = [&](std::size_t index) {
      std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(index), values.end());
      return values[index];
    };
    const std::size_t tenth = (values.size() - 1) / 10;
    const double low = value_at(tenth), high = value_at(values.size() - 1 - tenth);
    bulk.add_axis(a, low, high);
    const auto [least, most] = std::ranges::minmax_element(values);
    all.add_axis(a, *least, *most);
  }
  if (all.is_far()) return all.middle;
  return bulk.is_far() ? std::optional(bulk.middle) : std::nullopt;
}

std::string origin_comment(const Origin& origin) {
  char text[96];
  std::snprintf(text, sizeof text, "%.17g %.17g %.17g", origin[0], origin[1], origin[2]);
  return std::string(kOriginComment) + text;
}

std::optional<Origin> origin_in(const std::vector<std::string>& comments) {
  for (const std::string& comment : comments) {
    Origin origin;
    if (!comment.starts_with(kOriginComment)) continue;
    const std::string numbers = comment.substr(kOriginComment.size());
    if (std::sscanf(numbers.c_str(), "%lf %lf %lf", &origin[0], &origin[1], &origin[2]) != 3) continue;
    if (std::ranges::all_of(origin, [](double v) { return std::abs(v) < kAbsurd; })) return origin;
  }
  return std::nullopt;
}

std::string rule_comment(const BoundaryRule& rule) {
  const nlohmann::ordered_json json{
      {"tau", rule.tau}, {"criterion", kCriterionNames[std::size_t(rule.criterion)]}, {"exclusive", rule.exclusive}};
  return std::string(kRuleComment) + json.dump();
}

std::optional<BoundaryRule> rule_in(const std::vector<std::string>& comments, const std::string& file) {
  const auto found =
      std::ranges::find_if(comments, [](const std::string& comment) { return comment.starts_with(kRuleComment); });
  if (found == comments.end()) return std::nullopt;
  const auto json = nlohmann::json::parse(found->substr(kRuleComment.size()), nullptr, false);
  BoundaryRule rule;
  const auto has = [&](const char* key, auto is_type) { return json.contains(key) && (json[key].*is_type)(); };
  if (json.is_object() && has("tau", &nlohmann::json::is_number) && has("criterion", &nlohmann::json::is_string) &&
      has("exclusive", &nlohmann::json::is_boolean)) {
    const auto criterion = std::ranges::find(kCriterionNames, json["criterion"].get<std::string>());
    rule.tau = json["tau"].get<double>();
    rule.exclusive = json["exclusive"].get<bool>();
    rule.criterion = Criterion(criterion - kCriterionNames.begin());
    if (rule.tau >= 0 && rule.tau < 1 && criterion != kCriterionNames.end()) return rule;
  }
  throw Error(ErrorCode::kBadInput,
              file + ": comment \"" + printable(*found) +
                  R"(", expected ngs-boundary {"tau": T in [0, 1), "criterion": "pooled", )"
                  R"("between-views" or "relative-diff", "exclusive": true or false})",
              "write the file again: ngs-variance scene.json -o boundary.ply");
}

}  // namespace ngs::io
