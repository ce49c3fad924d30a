#include "ngs/cut/passes/resumed_decisions.h"

#include <algorithm>

namespace ngs {
namespace {

constexpr const char* kMode = "resumed";

std::string text_of(std::string_view effect, bool on) { return std::string(effect) + (on ? "=on" : "=off"); }

bool holds(const Json& list, const std::string& text) {
  return list.is_array() && std::find(list.begin(), list.end(), Json(text)) != list.end();
}

}  // namespace

Json stored_decisions(const Pipeline& pipeline, const Decisions& decisions) {
  const std::vector<Effect> redecided = pipeline.decided_again_on_resume();
  Json kept = Json::array();
  for (const Decision& d : decisions.all())
    if (find_effect(redecided, d.effect->name) == nullptr) kept.push_back(text_of(d.effect->name, d.on || d.aborted));
  return kept;
}

void repeat_decisions(const Pipeline& pipeline, PassRun& run, const Json& effects, const Json& skipped) {
  const std::vector<Effect> redecided = pipeline.decided_again_on_resume();
  for (const Effect& effect : run.decisions.effects()) {
    if (find_effect(redecided, effect.name) != nullptr) continue;
    if (holds(skipped, std::string(effect.name))) {
      skip_for_time(run, effect.name);
    } else {
      for (const bool on : {false, true})
        if (holds(effects, text_of(effect.name, on))) run.decisions.fix({effect.name, on, "--resume", kMode});
    }
  }
}

}  // namespace ngs
