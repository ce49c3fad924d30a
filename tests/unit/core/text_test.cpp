#include <doctest/doctest.h>

#include "ngs/core/folded_name.h"
#include "ngs/core/listed.h"

namespace ngs {

TEST_CASE("names in composed and decomposed form, and in either case, fold to one name") {
  const char* const alike[][2] = {{"G\xc3\xbcl.PNG", "gu\xcc\x88l.png"},                     // Latin: one mark
                                  {"\xe1\xba\xad", "a\xcc\xa3\xcc\x82"},                     // Vietnamese: two marks
                                  {"\xd0\xb9", "\xd0\xb8\xcc\x86"},                          // Cyrillic
                                  {"\xe3\x81\x8c", "\xe3\x81\x8b\xe3\x82\x99"},              // kana
                                  {"\xed\x95\x9c", "\xe1\x84\x92\xe1\x85\xa1\xe1\x86\xab"},  // Hangul with a tail
                                  {"\xea\xb0\x80", "\xe1\x84\x80\xe1\x85\xa1"}};             // and without
  for (const auto& pair : alike) {
    CAPTURE(pair[0]);
    CHECK(folded_name(pair[0]) == folded_name(pair[1]));
    CHECK(folded_name(folded_name(pair[0])) == folded_name(pair[0]));
  }
  CHECK(folded_name("a.png") != folded_name("\xc3\xa4.png"));
}

TEST_CASE("lower_case changes ASCII letters only") { CHECK(lower_case("Ä_B1.PNG") == "Ä_b1.png"); }

TEST_CASE("other scripts, emoji and bytes that are not UTF-8 stay as they are") {
  for (const char* name :
       {"", "a b.png", "\xe7\x85\xa7\xe7\x89\x87", "\xf0\x9f\x90\xa6.png", "\xff\xfe", "\xc3", "x\xe3\x81", "\x80\x80"})
    CHECK(folded_name(name) == name);
}

TEST_CASE("listed names the first and counts the others") {
  CHECK(listed({"a", "b", "c"}, 3) == "a, b, c");
  CHECK(listed({"a", "b", "c"}, 1) == "a and 2 more");
  CHECK(listed({}, 2).empty());
}

TEST_CASE("split keeps empty parts") {
  using Parts = std::vector<std::string_view>;
  CHECK(split("a,,b", ',') == Parts{"a", "", "b"});
  CHECK(split("a,", ',') == Parts{"a", ""});
  CHECK(split("", ',') == Parts{""});
}

}  // namespace ngs
