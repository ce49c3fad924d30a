#pragma once
// Pairs the files of two folders whose authors named them by different rules. Names are relative paths
// without leading "./"; a folder in front ("view/object.png") belongs to the name.
//
// Rules, the strict ones first; a later rule sees only what the earlier ones left over, and pairs two names
// only where its key is unique on both sides:
//   stem    the path without its extension is the same
//   affix   the same after lower case, double extensions (IMG_1.JPG.png) and mask_/gt_/pred_/frame_,
//           _mask/_gt/_pred/_label/_seg/_object/_rgb are taken off
//   number  the same last number, 12 = 00012, in the same folder
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ngs::io {

struct NamePair {
  std::size_t predicted = 0, truth = 0;  // indices into the two lists
  std::string_view rule;
};

struct NameMatch {
  std::vector<NamePair> pairs;  // by the truth's name
  std::vector<std::size_t> unmatched_predicted, unmatched_truth;
};

/// Throws kInconsistent where two files of one folder have the same stem (a.png and a.jpg).
NameMatch match_names(std::span<const std::string> predicted, std::span<const std::string> truth);

/// Which of `names` (sorted) the rule "every:N:K" or "all" selects: index % N == K. Throws kUsage for another
/// rule.
std::vector<std::size_t> select_every(std::string_view rule, std::size_t count);

}  // namespace ngs::io
