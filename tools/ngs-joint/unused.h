#pragma once
// Options that say something which the chosen method does not listen to.
#include "chain.h"
#include "decide.h"

namespace ngs::joint {

/// Of --effect only these act on the methods beside the paper's: they mend what any method is given.
inline constexpr std::string_view kMendingEffects[] = {"exposure", "mask-outliers", "floaters", "components"};

/// "--quality, --effect sh=off": what was given, beside the defaults, and is not used; empty: nothing.
std::string unused_flags(const Declared& declared, const Paths& paths);

/// Warns of what --method paper was given for effects that are decided to be off.
void warn_unused(cli::Run& run, const Declared& declared, const Decisions& decisions);

}  // namespace ngs::joint
