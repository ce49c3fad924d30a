#include "decide.h"

#include <algorithm>
#include <cmath>

#include "ngs/options/strict_json.h"
#include "shared/text_file.h"

namespace ngs::joint {
namespace {

/// kInconsistent where another method ran than `method`: what it does not ask for it calls off.
std::vector<EffectVerdict> replayed(const std::string& path, Method method) {
  const Json report = parse_strict_json<Json>(cli::read_text_file(path, ErrorCode::kBadInput), path, ErrorCode::kBadInput);
  const Json options = report.is_object() ? report.value("options", Json()) : Json();
  const Json ran = options.is_object() ? options.value("method", Json()) : Json();
  if (ran.is_string() && ran != method_name(method))
    throw Error(ErrorCode::kInconsistent,
                path + ": decisions of --method " + ran.get<std::string>() + ", expected those of " + method_name(method),
                "give the report of a run of this method");
  const Json* effects = nullptr;
  if (report.is_object() && report.contains("result") && report["result"].is_object() &&
      report["result"].contains("effects"))
    effects = &report["result"]["effects"];
  std::vector<EffectVerdict> verdicts;
  for (std::size_t i = 0; effects != nullptr && effects->is_array() && i < effects->size(); ++i) {
    const Json& entry = (*effects)[i];
    if (!entry.is_object() || !entry.contains("name") || !entry["name"].is_string() ||
        !entry.contains("on") || !entry["on"].is_boolean())
      continue;
    if (const EffectInfo* known = find_effect(entry["name"].get<std::string>()))
      verdicts.push_back({known->name, entry["on"].get<bool>(), "--effects-from", "replayed"});
  }
  if (verdicts.empty())
    throw Error(ErrorCode::kBadInput, path + ": no decisions on effects, expected a report of ngs-joint",
                "write one: ngs-joint ... --report FILE");
  return verdicts;
}

}  // namespace

Decisions::Decisions(const Settings& settings, std::vector<EffectVerdict> ruled, const std::string& effects_from)
    : settings_(settings), verdicts_(std::move(ruled)) {
  if (effects_from.empty()) return;
  for (EffectVerdict& verdict : replayed(effects_from, settings.run.method)) verdicts_.push_back(std::move(verdict));
}

void Decisions::decide(cli::Run& run, EffectPhase phase, const Problem& input) {
  const EffectSetup setup{settings_.joint, settings_.edge, settings_.sample, settings_.rbf, input};
  for (EffectDecision& d : decide_effects(run.exec(), run.monitor(), setup, phase, verdicts_, all_)) {
    if (d.measured) run.info(decision_line(d));
    all_.push_back(std::move(d));
  }
  run.result()["effects"] = json();
}

bool Decisions::on(std::string_view name) const {
  for (const EffectDecision& d : all_)
    if (d.effect->name == name) return d.on;
  throw std::logic_error("an effect is asked for before it is decided");
}

std::optional<bool> Decisions::said(std::string_view name) const {
  const std::string_view needs = find_effect(name)->needs;
  if (!needs.empty() && said(needs) == false) return false;
  const std::optional<EffectDecision> settled =
      settled_decision(*find_effect(name), settings_.joint.effect, verdicts_, all_);
  return settled ? std::optional(settled->on) : std::nullopt;
}

void Decisions::warn_of_needs(cli::Run& run) const {
  const auto asked = [&](std::string_view name) {  // by its own name: all=on means all that can be
    return std::ranges::find(settings_.joint.effect, std::string(name) + "=on") != settings_.joint.effect.end() &&
           mode_of(name, settings_.joint.effect) == EffectMode::kOn;
  };
  for (const EffectDecision& d : all_)
    if (!d.on && asked(d.effect->name))
      run.monitor().warn("--effect " + std::string(d.effect->name) + "=on: it is off, because it " + d.reason +
                         ", which is off; --effect " + std::string(d.effect->needs) + "=on");
}

Settings Decisions::settled() const {
  Settings settled = settings_;
  settled.joint.effect = decided_entries(all_);
  return settled;
}

Json Decisions::json() const {
  Json table = Json::array();
  for (const EffectDecision& d : all_) {
    Json entry = {{"name", d.effect->name}, {"mode", d.mode}, {"on", d.on}, {"reason", d.reason}};
    entry["measured"] = d.measured && std::isfinite(*d.measured) ? Json(*d.measured) : Json();
    entry["threshold"] = d.effect->on == OnWhere::kAlways ? Json() : Json(d.effect->threshold);
    entry["saving"] = d.on ? "" : d.effect->saves;
    table.push_back(std::move(entry));
  }
  return table;
}

std::string decision_table(const Decisions& decisions) {
  std::string text;
  for (const Json& d : decisions.json()) {
    std::string name = d["name"].get<std::string>(), state = d["on"].get<bool>() ? "on" : "off";
    name.resize(std::max<std::size_t>(name.size(), 14), ' '), state.resize(4, ' ');
    text += name + state + d["mode"].get<std::string>() + ": " + d["reason"].get<std::string>() + "\n";
  }
  return text;
}

std::string effects_help() {
  std::string text = "effects (--effect NAME=auto|on|off, all=...; --explain decides them for a scene):\n";
  for (const EffectInfo& e : effect_registry()) {
    std::string name = "  " + std::string(e.name);
    name.resize(18, ' ');
    text += name + std::string(e.help) + (e.on == OnWhere::kAlways ? "" : "; auto") + "\n";
  }
  return text;
}

}  // namespace ngs::joint
