#include "ngs/cut/passes/decisions.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ngs {
namespace {

/// The measured value. Its time is reported as a stage with the effect's name.
double measured_by(const Effect& effect, SceneProbe& probe) {
  if (probe.problem().monitor == nullptr) return effect.heuristic.measure(probe);
  const auto timed = probe.problem().monitor->scope(std::string(effect.name));
  return effect.heuristic.measure(probe);
}

/// Null: not decided.
template <class All>
auto found_in(All& all, std::string_view name) -> decltype(all.data()) {
  const auto found = std::ranges::find_if(all, [&](const Decision& d) { return d.effect->name == name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace

Decisions::Decisions(std::vector<Effect> effects, EffectSwitches switches, std::vector<FixedDecision> fixed)
    : effects_(std::move(effects)), switches_(std::move(switches)), fixed_(std::move(fixed)) {}

const Decision* Decisions::find(std::string_view name) const { return found_in(all_, name); }

/// Precedence: off if a needed effect is off; then the switch of --effect; then the first fixed decision; then "always
/// on". Null: the heuristic decides.
std::optional<Decision> Decisions::decision_without_heuristic(const Effect& e) const {
  if (const Decision* need = find(e.needs); need != nullptr && !need->on)
    return Decision{&e, "auto", false, "needs " + std::string(e.needs)};
  if (const Switch mode = switches_.of(e.name); mode != Switch::kAuto) {
    const bool on = mode == Switch::kOn;
    return Decision{&e, on ? "on" : "off", on, "--effect"};
  }
  for (const FixedDecision& d : fixed_)
    if (d.name == e.name) return Decision{&e, d.mode, d.on, d.reason};
  if (!e.always.empty()) return Decision{&e, "auto", true, "always: " + std::string(e.always)};
  return std::nullopt;
}

bool Decisions::decide(const std::vector<Effect>& some, SceneProbe& probe) {
  bool measured_any = false;
  for (const Effect& one : some) {
    const Effect& e = *find_effect(effects_, one.name);
    if (std::optional<Decision> known = decision_without_heuristic(e)) {
      all_.push_back(std::move(*known));
      continue;
    }
    if (e.heuristic.possible != nullptr && !e.heuristic.possible(probe.problem())) {
      all_.push_back({&e, "auto", false, std::string(e.heuristic.impossible), std::nan("")});
      continue;
    }
    measured_any = true;
    const double measured = measured_by(e, probe);
    if (probe.stopped()) break;
    all_.push_back({&e, "auto", measured > e.heuristic.threshold, decision_reason(e.heuristic, measured), measured});
  }
  return measured_any;
}

bool Decisions::is_fixed(std::string_view name) const {
  return switch_of(name) != Switch::kAuto ||
         std::ranges::any_of(fixed_, [&](const FixedDecision& v) { return v.name == name; });
}

void Decisions::abort(std::string_view name, std::string reason) {
  if (Decision* decision = found_in(all_, name)) {
    decision->on = false;
    decision->aborted = true;
    decision->reason = std::move(reason);
  }
}

bool Decisions::on(std::string_view name) const {
  const Decision* decision = find(name);
  if (decision == nullptr) throw std::logic_error("an effect is used before it is decided");
  return decision->on;
}

std::optional<bool> Decisions::on_if_known(std::string_view name) const {
  if (const Decision* decision = find(name)) return decision->on;
  const Effect& e = *find_effect(effects_, name);
  if (!e.needs.empty() && on_if_known(e.needs) == false) return false;
  const std::optional<Decision> decision = decision_without_heuristic(e);
  return decision ? std::optional(decision->on) : std::nullopt;
}

bool Decisions::may_be_on(std::string_view name, const Problem& problem) const {
  if (const std::optional<bool> known = on_if_known(name)) return *known;
  const auto& possible = find_effect(effects_, name)->heuristic.possible;
  return !possible || possible(problem);
}

Json Decisions::json() const {
  Json table = Json::array();
  for (const Decision& d : all_) {
    Json entry = {{"name", d.effect->name}, {"mode", d.mode}, {"on", d.on}, {"reason", d.reason}};
    entry["measured"] = d.measured && std::isfinite(*d.measured) ? Json(*d.measured) : Json();
    entry["threshold"] = d.effect->always.empty() ? Json(d.effect->heuristic.threshold) : Json();
    entry["saving"] = d.on ? "" : d.effect->saves;
    table.push_back(std::move(entry));
  }
  return table;
}

std::string Decisions::table() const {
  std::size_t widest = 0;
  for (const Decision& d : all_) widest = std::max(widest, d.effect->name.size());
  std::string text;
  for (const Decision& d : all_) {
    std::string name(d.effect->name);
    name.resize(widest + 2, ' ');
    text += name + (d.on ? "on  " : "off ") + d.mode + ": " + d.reason + "\n";
  }
  return text;
}

std::string decision_line(const Decision& d) {
  return d.mode + ": " + std::string(d.effect->name) + "=" + (d.on ? "on" : "off") + " (" + d.reason + ")" +
         (d.on || d.effect->saves.empty() ? "" : ", leaves out " + std::string(d.effect->saves));
}

}  // namespace ngs
