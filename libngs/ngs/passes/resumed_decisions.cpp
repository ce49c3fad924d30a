#include "ngs/passes/resumed_decisions.h"

#include <algorithm>

#include "ngs/passes/pipeline.h"

namespace ngs {
namespace {

constexpr const char* kMode = "resumed";
constexpr const char* kWhole = "contours";  // what is decided anew, with all that belongs to it

std::string text_of(std::string_view effect, bool on) { return std::string(effect) + (on ? "=on" : "=off"); }

bool holds(const Json& list, const std::string& text) {
  return list.is_array() && std::find(list.begin(), list.end(), Json(text)) != list.end();
}

}  // namespace

Json kept_decisions(const Decisions& decisions) {
  Json kept = Json::array();
  for (const EffectDecision& d : decisions.all())
    if (!belongs_to(decisions.effects(), d.effect->name, kWhole))
      kept.push_back(text_of(d.effect->name, d.on || d.broken_off));
  return kept;
}

void repeat_decisions(PassRun& run, const Json& effects, const Json& left_out) {
  for (const Effect& effect : run.decisions.effects()) {
    if (belongs_to(run.decisions.effects(), effect.name, kWhole)) continue;
    if (holds(left_out, std::string(effect.name))) {
      leave_out_for_time(run, effect.name);
    } else {
      for (const bool on : {false, true})
        if (holds(effects, text_of(effect.name, on))) run.decisions.rule({effect.name, on, "--resume", kMode});
    }
  }
}

}  // namespace ngs
