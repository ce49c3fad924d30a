#include <algorithm>
#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/io/ply/gaussian_columns.h"
#include "ngs/io/ply/ply_scan.h"

namespace ngs::io {

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
    rule.tau = json["tau"].get<double>(), rule.exclusive = json["exclusive"].get<bool>();
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
