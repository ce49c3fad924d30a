#include "ngs/options/option_warnings.h"

#include <algorithm>
#include <utility>

#include "ngs/core/listed.h"

namespace ngs {
namespace {

/// Flags grouped by the reason why they are not used, both in the order of declaration.
class FlagsByReason {
 public:
  void add(const std::string& reason, const std::string& flag) {
    const auto known = std::ranges::find(lists_, reason, &std::pair<std::string, std::string>::first);
    if (known == lists_.end())
      lists_.emplace_back(reason, flag);
    else
      known->second += ", " + flag;
  }
  std::vector<std::string> texts() const {
    std::vector<std::string> texts;
    for (const auto& [reason, flags] : lists_) texts.push_back(flags + ": not used" + reason);
    return texts;
  }

 private:
  std::vector<std::pair<std::string, std::string>> lists_;
};

using IsOn = std::function<bool(std::string_view effect)>;

/// " with joint=off and contours=off" for "joint|contours" where neither is on; empty: the option is used.
std::string why_not_used(std::string_view effects, const IsOn& is_on) {
  if (effects.empty()) return {};
  for (const std::string_view condition : split(effects, ',')) {
    const std::vector<std::string_view> any_of = split(condition, '|');
    if (std::ranges::any_of(any_of, is_on)) continue;
    std::string all_off;
    for (const std::string_view effect : any_of)
      all_off += (all_off.empty() ? " with " : " and ") + std::string(effect) + "=off";
    return all_off;
  }
  return {};
}

}  // namespace

std::vector<std::string> unused_group_warnings(const OptionSet& options) {
  FlagsByReason unused;
  for (const OptionEntry* entry : options.changed())
    if (const std::string& needs = entry->group->needs; !is_used(*entry))
      unused.add(needs.empty() ? "" : " without " + needs, option_flag(entry->name));
  return unused.texts();
}

std::vector<std::string> unused_effect_warnings(const OptionSet& options, const IsOn& is_on) {
  FlagsByReason unused;
  for (const OptionEntry* entry : options.changed()) {
    const std::string reason = is_used(*entry) ? why_not_used(entry->effect, is_on) : "";
    if (!reason.empty()) unused.add(reason, option_flag(entry->name));
  }
  return unused.texts();
}

}  // namespace ngs
