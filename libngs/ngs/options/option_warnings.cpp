#include "ngs/options/option_warnings.h"

#include <algorithm>
#include <utility>

namespace ngs {
namespace {

/// Flags by the reason why they are not used, both in the order in which they come.
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

/// " with joint=off and contours=off" for "joint|contours".
std::string with_all_off(std::string effects) {
  for (std::size_t at = effects.find('|'); at != effects.npos; at = effects.find('|', at)) effects.replace(at, 1, "=off and ");
  return " with " + effects + "=off";
}

}  // namespace

std::string renamed_warning(const OptionEntry& entry) {
  return option_flag(entry.was) + " is now called " + option_flag(entry.name);
}

std::vector<std::string> unheard_warnings(const OptionSet& options) {
  FlagsByReason unheard;
  for (const OptionEntry* entry : options.given())
    if (const std::string& listener = entry->group->listener; !is_heard(*entry))
      unheard.add(listener.empty() ? "" : ", only " + listener + " listens", option_flag(entry->name));
  return unheard.texts();
}

std::vector<std::string> without_effect_warnings(const OptionSet& options,
                                                 const std::function<bool(std::string_view effect)>& is_on) {
  FlagsByReason without_effect;
  for (const OptionEntry* entry : options.given())
    if (const std::string missing = missing_effects(*entry, is_on); is_heard(*entry) && !missing.empty())
      without_effect.add(with_all_off(missing), option_flag(entry->name));
  return without_effect.texts();
}

}  // namespace ngs
