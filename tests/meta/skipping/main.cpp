// A suite with one passing case, one failing case and three cases without their dependencies, one of which fails first.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include "support/skip.h"

TEST_CASE("a case that passes") { CHECK(true); }

TEST_CASE("a case that fails") { CHECK(false); }

TEST_CASE("a case without its input") { return ngs::test::skip("no scene"); }

TEST_CASE("a case without the input of a subcase") {
  SUBCASE("the subcase that runs") { CHECK(true); }
  SUBCASE("the subcase that is skipped") { return ngs::test::skip("no program"); }
}

TEST_CASE("a case that fails before it is skipped") {
  CHECK(false);
  return ngs::test::skip("no processor");
}
