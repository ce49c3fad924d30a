#pragma once
// Pairs the files of two folders that follow different naming rules. Names are relative paths without a leading "./"; a
// parent folder ("view/object.png") is part of the name.
//
// Rules are applied in this order, each to the names that are still unpaired. A rule pairs two names only if its key is
// unique in both folders:
// clang-format off
//   stem    the path without its extension is equal
//   affix   equal after lower case and without double extensions (IMG_1.JPG.png), the prefixes mask_ gt_ pred_ frame_
//           and the suffixes _mask _gt _pred _label _seg _object _rgb
//   number  the last number is equal (12 = 00012), in the same folder
// clang-format on
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

/// Throws kInconsistent if two files of one folder have the same stem (a.png and a.jpg).
NameMatch match_names(std::span<const std::string> predicted, std::span<const std::string> truth);

}  // namespace ngs::io
