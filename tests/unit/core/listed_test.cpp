#include "ngs/core/listed.h"

#include <doctest/doctest.h>

namespace ngs {

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
