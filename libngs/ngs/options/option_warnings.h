#pragma once
// Warnings about given options that are not used. Without them, a sweep over an unused option would be an unexplained
// flat line. One text per reason, in the order of declaration.
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/options/option_set.h"

namespace ngs {

/// "--cob-rounds, --cob-views: not used without --method cob", for groups that do not apply.
std::vector<std::string> unused_group_warnings(const OptionSet& options);

/// "--hash-levels, --mlp-hidden: not used with nerf=off", for effects that are off according to `is_on`.
std::vector<std::string> unused_effect_warnings(const OptionSet& options,
                                                const std::function<bool(std::string_view effect)>& is_on);

}  // namespace ngs
