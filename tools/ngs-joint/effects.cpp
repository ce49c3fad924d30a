#include "effects.h"

#include <span>

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

using FixedDecisions = std::vector<FixedDecision>;

std::string mode_of(const Effect& effect, const FixedDecisions& fixed) {
  for (const FixedDecision& decision : fixed)
    if (decision.name == effect.name) return decision.on ? "on" : "off";
  return effect.always.empty() ? "auto" : "on";
}

std::string row(std::string name, std::string mode, std::string_view help) {
  name.resize(23, ' '), mode.resize(6, ' ');
  return name + mode + std::string(help) + "\n";
}

std::string part_rows(std::span<const Effect> parts, const FixedDecisions& fixed) {
  std::string text;
  for (const Effect& part : parts) text += row("    " + std::string(part.name), mode_of(part, fixed), part.help);
  return text;
}

/// One line per switch value, with the names of the parts that have it.
std::string part_names(std::span<const Effect> parts, const FixedDecisions& fixed) {
  std::string text;
  for (const char* mode : {"auto", "on", "off"}) {
    std::string names;
    for (const Effect& part : parts)
      if (mode_of(part, fixed) == mode) names += (names.empty() ? "" : " ") + std::string(part.name);
    if (!names.empty()) text += row("    parts", mode, names);
  }
  return text;
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

std::string effects_help(const Options& options, bool in_full) {
  const FixedDecisions fixed = fixed_decisions_of(options, "");
  std::string text = "effects: --effect NAME=auto|on|off; auto: decided from the scene (--explain lists why)\n";
  for (const std::unique_ptr<Pass>& pass : options.pipeline.passes()) {
    if (pass->traits.stage != PassStage::kRepair && !options.runs_passes()) continue;
    const std::vector<Effect> effects = pass->effects();
    const auto parts = std::span(effects).subspan(1);
    text += row("  " + std::string(effects[0].name), mode_of(effects[0], fixed), effects[0].help);
    text += in_full ? part_rows(parts, fixed) : part_names(parts, fixed);
  }
  return text;
}

}  // namespace ngs::joint
