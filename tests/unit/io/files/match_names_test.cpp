#include "ngs/io/files/match_names.h"

#include <doctest/doctest.h>

#include "ngs/core/error.h"

namespace ngs {
namespace {

using Names = std::vector<std::string>;

std::string described(const Names& predicted, const Names& truth) {
  const io::NameMatch match = io::match_names(predicted, truth);
  std::string text;
  for (const io::NamePair& pair : match.pairs)
    text += predicted[pair.predicted] + "=" + truth[pair.truth] + "(" + std::string(pair.rule) + ") ";
  for (std::size_t i : match.unmatched_predicted) text += "-" + predicted[i] + " ";
  for (std::size_t i : match.unmatched_truth) text += "+" + truth[i] + " ";
  return text;
}

TEST_CASE("names are paired by stem, whatever the extension and order") {
  CHECK(described({"b.png", "a.jpg", "c.png"}, {"a.png", "b.png"}) == "a.jpg=a.png(stem) b.png=b.png(stem) -c.png ");
  CHECK(described({}, {"a.png"}) == "+a.png ");
  CHECK(described({}, {}).empty());
}

TEST_CASE("names are paired without double extensions and common affixes") {
  CHECK(described({"IMG_4027.JPG.png"}, {"IMG_4027_mask.png"}) == "IMG_4027.JPG.png=IMG_4027_mask.png(affix) ");
  CHECK(described({"0003_label.png"}, {"frame_0003.png"}) == "0003_label.png=frame_0003.png(affix) ");
  CHECK(described({"mask_a.png"}, {"A.png"}) == "mask_a.png=A.png(affix) ");
}

TEST_CASE("numbers are paired where they are unique on both sides") {
  CHECK(described({"00012.png", "7.png"}, {"view012.png", "view7.png"}) ==
        "00012.png=view012.png(number) 7.png=view7.png(number) ");
  // 12 occurs twice among the predictions: the name stays unpaired.
  CHECK(described({"a12.png", "b12.png"}, {"view12.png"}) == "-a12.png -b12.png +view12.png ");
  CHECK(described({"left.png"}, {"right.png"}) == "-left.png +right.png ");
}

TEST_CASE("a parent folder is part of the name") {
  CHECK(described({"v1/apple.png", "v2/apple.png"}, {"v2/apple.png", "v1/apple.png"}) ==
        "v1/apple.png=v1/apple.png(stem) v2/apple.png=v2/apple.png(stem) ");
  CHECK(described({"v1/001.png"}, {"v2/1.png"}) == "-v1/001.png +v2/1.png ");
}

TEST_CASE("two files with the same stem are rejected") {
  CHECK_THROWS_AS(io::match_names(Names{"a.png", "a.jpg"}, Names{"a.png"}), Error);
}

}  // namespace
}  // namespace ngs
