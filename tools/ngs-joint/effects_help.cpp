#include "effects_help.h"

#include <span>

#include "fixed_decisions.h"

namespace ngs::joint {
namespace {

using Rules = std::vector<FixedDecision>;

std::string mode_of(const Effect& effect, const Rules& rules) {
  for (const FixedDecision& rule : rules)
    if (rule.name == effect.name) return rule.on ? "on" : "off";
  return effect.always.empty() ? "auto" : "on";
}

std::string row(std::string name, std::string mode, std::string_view help) {
  name.resize(23, ' '), mode.resize(6, ' ');
  return name + mode + std::string(help) + "\n";
}

std::string part_rows(std::span<const Effect> parts, const Rules& rules) {
  std::string text;
  for (const Effect& part : parts) text += row("    " + std::string(part.name), mode_of(part, rules), part.help);
  return text;
}

/// A line for each mode, with the names of the parts that have it.
std::string part_names(std::span<const Effect> parts, const Rules& rules) {
  std::string text;
  for (const char* mode : {"auto", "on", "off"}) {
    std::string names;
    for (const Effect& part : parts)
      if (mode_of(part, rules) == mode) names += (names.empty() ? "" : " ") + std::string(part.name);
    if (!names.empty()) text += row("    parts", mode, names);
  }
  return text;
}

}  // namespace

std::string effects_help(const Options& options, bool in_full) {
  const Rules rules = fixed_decisions_of(options, "");
  std::string text = "effects: --effect NAME=auto|on|off; auto: where the scene calls for it (--explain lists why)\n";
  for (const std::unique_ptr<Pass>& pass : options.pipeline.passes()) {
    if (pass->stage() != PassStage::kMend && !options.runs_passes()) continue;
    const std::vector<Effect> effects = pass->effects();
    const auto parts = std::span(effects).subspan(1);
    text += row("  " + std::string(effects[0].name), mode_of(effects[0], rules), effects[0].help);
    text += in_full ? part_rows(parts, rules) : part_names(parts, rules);
  }
  return text;
}

}  // namespace ngs::joint
