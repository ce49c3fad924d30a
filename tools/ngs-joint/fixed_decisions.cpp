#include "fixed_decisions.h"

#include "ngs/options/strict_json.h"
#include "shared/text/text_file.h"

namespace ngs::joint {
namespace {

/// What the report says of its method.
std::string method_of(const Json& report) {
  const Json options = report.is_object() ? report.value("options", Json()) : Json();
  const Json method = options.is_object() ? options.value("method", Json()) : Json();
  return method.is_string() ? method.get<std::string>() : "";
}

/// The report's list of decisions; an empty one where it has none.
Json effects_of(const Json& report) {
  const Json result = report.is_object() ? report.value("result", Json()) : Json();
  const Json effects = result.is_object() ? result.value("effects", Json()) : Json();
  return effects.is_array() ? effects : Json::array();
}

std::vector<FixedDecision> replayed(const std::string& path, const Options& options) {
  const Json report =
      parse_strict_json<Json>(cli::read_text_file(path, ErrorCode::kBadInput), path, ErrorCode::kBadInput);
  const std::string ran = method_of(report), wanted = method_name(options.choice.method);
  if (!ran.empty() && ran != wanted)  // what a method does not ask for it calls off
    throw Error(ErrorCode::kInconsistent, path + ": decisions of --method " + ran + ", expected those of " + wanted,
                "give the report of a run of this method");
  const std::vector<Effect> effects = options.pipeline.effects();
  std::vector<FixedDecision> verdicts;
  for (const Json& entry : effects_of(report)) {
    const Json name = entry.is_object() ? entry.value("name", Json()) : Json(),
               on = entry.is_object() ? entry.value("on", Json()) : Json();
    if (!name.is_string() || !on.is_boolean()) continue;
    if (const Effect* known = find_effect(effects, name.get<std::string>()))
      verdicts.push_back({known->name, on.get<bool>(), "--effects-from", "replayed"});
  }
  if (verdicts.empty())
    throw Error(ErrorCode::kBadInput, path + ": no decisions on effects, expected a report of ngs-joint",
                "write one: ngs-joint ... --report FILE");
  return verdicts;
}

}  // namespace

std::vector<FixedDecision> fixed_decisions_of(const Options& options, const std::string& effects_from) {
  std::vector<FixedDecision> verdicts;
  const auto rule_out = [&](std::string_view effect) { verdicts.push_back({effect, false, "part of --method ngs"}); };
  if (options.choice.method != Method::kNgs)  // the other methods are as their papers say
    for (const PassStage stage : {PassStage::kFocus, PassStage::kMend})
      for (const Effect& effect : options.pipeline.effects(stage)) rule_out(effect.name);
  if (options.choice.method == Method::kNgGs) {
    rule_out("contours");
    verdicts.push_back({"nerf", true, "--method ng-gs"});
  }
  for (FixedDecision& rule : options.pipeline.fixed_decisions(options.training)) verdicts.push_back(std::move(rule));
  if (!effects_from.empty())
    for (FixedDecision& verdict : replayed(effects_from, options)) verdicts.push_back(std::move(verdict));
  if (options.choice.method == Method::kNgGs) verdicts.push_back({"joint", true, "--method ng-gs"});
  return verdicts;
}

}  // namespace ngs::joint
