#pragma once
// Names close enough to a mistyped one to be worth suggesting.
#include <string>
#include <string_view>
#include <vector>

namespace ngs {

/// Insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b`.
int edit_distance(std::string_view a, std::string_view b);

/// At most three of `candidates`, nearest first, ties in their order: within a third of the length in edits,
/// or the same beginning.
std::vector<std::string> near_matches(std::string_view name, const std::vector<std::string>& candidates);

/// "did you mean 'a' or 'b'?"; without a near match, "known: x, y, z".
std::string suggestion(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace ngs
