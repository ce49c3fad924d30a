#include "ngs/cut/passes/effect.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/error.h"
#include "ngs/core/formatted.h"

namespace ngs {
namespace {

/// Three digits, and no exponent of large ones.
std::string short_number(double value) {
  return formatted(std::abs(value) < 1000 || std::abs(value) >= 1e15 ? "%.3g" : "%.0f", value);
}

[[noreturn]] void throw_bad_entry(std::span<const Effect> effects, const std::string& entry) {
  std::string names = "all";
  for (const Effect& e : effects) names += ", " + std::string(e.name);
  throw Error(ErrorCode::kUsage, "--effect: '" + entry + "', expected NAME=auto|on|off", "NAME is one of " + names);
}

}  // namespace

const Effect* find_effect(std::span<const Effect> effects, std::string_view name) {
  for (const Effect& e : effects)
    if (e.name == name) return &e;
  return nullptr;
}

EffectSwitches::EffectSwitches(std::span<const Effect> effects, const std::vector<std::string>& entries) {
  for (const std::string& entry : entries) read(effects, entry);
  for (const Effect& e : effects)
    if (const Entry* own = find(e.name); own != nullptr && own->by_name && own->mode == Switch::kOn)
      require(effects, e);
}

EffectSwitches::Entry* EffectSwitches::find(std::string_view name) {
  const auto found = std::ranges::find(entries_, name, &Entry::name);
  return found == entries_.end() ? nullptr : &*found;
}

void EffectSwitches::set(std::string_view name, Switch mode, bool by_name) {
  if (Entry* entry = find(name))
    *entry = {name, mode, by_name};
  else
    entries_.push_back({name, mode, by_name});
}

void EffectSwitches::read(std::span<const Effect> effects, const std::string& entry) {
  const std::size_t equals = std::min(entry.find('='), entry.size());
  const std::string name = entry.substr(0, equals), value = entry.substr(std::min(equals + 1, entry.size()));
  const Effect* known = find_effect(effects, name);
  if ((known == nullptr && name != "all") || (value != "auto" && value != "on" && value != "off"))
    throw_bad_entry(effects, entry);
  const Switch mode = value == "auto" ? Switch::kAuto : value == "on" ? Switch::kOn : Switch::kOff;
  if (known == nullptr) {
    for (const Effect& e : effects) set(e.name, mode, false);
    return;
  }
  set(known->name, mode, true);
}

void EffectSwitches::require(std::span<const Effect> effects, const Effect& effect) {
  for (std::string_view need = effect.needs; !need.empty(); need = find_effect(effects, need)->needs) {
    const Entry* entry = find(need);
    if (entry == nullptr || entry->mode != Switch::kOff) continue;
    if (entry->by_name)
      throw Error(
          ErrorCode::kUsage,
          "--effect " + std::string(effect.name) + "=on: it needs " + std::string(need) + ", which is off by name",
          "--effect " + std::string(need) + "=on, or leave out one of them");
    set(need, Switch::kOn, false);
  }
}

Switch EffectSwitches::of(std::string_view name) const {
  const auto found = std::ranges::find(entries_, name, &Entry::name);
  return found == entries_.end() ? Switch::kAuto : found->mode;
}

std::string decision_reason(const Heuristic& heuristic, double measured) {
  return std::string(heuristic.measured) + ": " + short_number(measured) +
         (measured > heuristic.threshold ? " > " : " <= ") + short_number(heuristic.threshold);
}

}  // namespace ngs
