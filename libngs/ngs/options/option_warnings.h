#pragma once
// What people should hear about the options they gave: that nothing listens. A sweep over an option
// that nothing listens to would otherwise be a flat line without a word. One text per reason, in the order of
// declaration.
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/options/option_set.h"

namespace ngs {

/// "--cob-rounds, --cob-views: not used, only --method cob listens", of groups that are not listened to.
std::vector<std::string> unheard_warnings(const OptionSet& options);

/// "--hash-levels, --mlp-hidden: not used with nerf=off", of effects of which `is_on` says that they are off.
std::vector<std::string> without_effect_warnings(const OptionSet& options,
                                                 const std::function<bool(std::string_view effect)>& is_on);

}  // namespace ngs
