#pragma once
// Generated blocks of a markdown page:  <!-- result: QUESTION -->  what is generated  <!-- /result -->, each marker a
// line.
#include <functional>
#include <string>
#include <vector>

namespace ngs::results {

/// The questions of the blocks of `page`, in order. Throws kBadInput where a marker has no partner.
std::vector<std::string> blocks_of(const std::string& page);

/// `page` with what stands in each block replaced by `text(QUESTION)`, which ends with a line's end.
std::string with_blocks(const std::string& page, const std::function<std::string(const std::string&)>& text);

/// `page` without its blocks: what is written by hand.
std::string without_blocks(const std::string& page);

}  // namespace ngs::results
