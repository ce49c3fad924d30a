#include "fixed_decisions.h"

#include "ngs/options/strict_json.h"
#include "shared/text/text_file.h"

namespace ngs::joint {
namespace {

/// The method recorded in the report; empty: none.
std::string method_of(const Json& report) {
  const Json options = report.is_object() ? report.value("options", Json()) : Json();
  const Json method = options.is_object() ? options.value("method", Json()) : Json();
  return method.is_string() ? method.get<std::string>() : "";
}

/// The decisions recorded in the report; empty if there are none.
Json effects_of(const Json& report) {
  const Json result = report.is_object() ? report.value("result", Json()) : Json();
  const Json effects = result.is_object() ? result.value("effects", Json()) : Json();
  return effects.is_array() ? effects : Json::array();
}

std::vector<FixedDecision> replayed(const std::string& path, const Options& options) {
  const Json report =
      parse_strict_json<Json>(cli::read_text_file(path, ErrorCode::kBadInput), path, ErrorCode::kBadInput);
  const std::string ran = method_of(report), wanted = method_name(options.choice.method);
  if (!ran.empty() && ran != wanted)  // effects that a method does not use are recorded as off
    throw Error(ErrorCode::kInconsistent, path + ": decisions of --method " + ran + ", expected those of " + wanted,
                "give the report of a run of this method");
  const std::vector<Effect> effects = options.pipeline.effects();
  std::vector<FixedDecision> decisions;
  for (const Json& entry : effects_of(report)) {
    const Json name = entry.is_object() ? entry.value("name", Json()) : Json(),
               on = entry.is_object() ? entry.value("on", Json()) : Json();
    if (!name.is_string() || !on.is_boolean()) continue;
    if (const Effect* known = find_effect(effects, name.get<std::string>()))
      decisions.push_back({known->name, on.get<bool>(), "--effects-from", "replayed"});
  }
  if (decisions.empty())
    throw Error(ErrorCode::kBadInput, path + ": no decisions on effects, expected a report of ngs-joint",
                "write one: ngs-joint ... --report FILE");
  return decisions;
}

}  // namespace

std::vector<FixedDecision> fixed_decisions_of(const Options& options, const std::string& effects_from) {
  std::vector<FixedDecision> decisions;
  const auto fix_off = [&](std::string_view effect) { decisions.push_back({effect, false, "part of --method ngs"}); };
  if (options.choice.method != Method::kNgs)  // the other methods run as published
    for (const PassStage stage : {PassStage::kCrop, PassStage::kRepair})
      for (const Effect& effect : options.pipeline.effects(stage)) fix_off(effect.name);
  if (options.choice.method == Method::kNgGs) {
    fix_off(kContoursEffect);
    decisions.push_back({kNerfEffect, true, "--method ng-gs"});
  }
  for (FixedDecision& decision : options.pipeline.fixed_decisions(options.training))
    decisions.push_back(std::move(decision));
  if (!effects_from.empty())
    for (FixedDecision& decision : replayed(effects_from, options)) decisions.push_back(std::move(decision));
  if (options.choice.method == Method::kNgGs) decisions.push_back({kJointEffect, true, "--method ng-gs"});
  return decisions;
}

}  // namespace ngs::joint
