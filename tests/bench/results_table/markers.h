#pragma once
// Generated blocks of a markdown page:  <!-- result: QUESTION -->  generated text  <!-- /result -->, each marker on its
// own line.
#include <functional>
#include <string>
#include <vector>

namespace ngs::results {

/// The questions of the blocks of `page`, in order. Throws kBadInput for unbalanced markers.
std::vector<std::string> blocks_of(const std::string& page);

/// `page` with the text of each block replaced by `text(QUESTION)`, which must end with a newline.
std::string with_blocks(const std::string& page, const std::function<std::string(const std::string&)>& text);

/// `page` without the text of its blocks: the hand-written part.
std::string without_blocks(const std::string& page);

}  // namespace ngs::results
