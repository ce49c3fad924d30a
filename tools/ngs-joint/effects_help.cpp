#include "effects_help.h"

#include <span>

#include "fixed_decisions.h"

namespace ngs::joint {
namespace {

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
