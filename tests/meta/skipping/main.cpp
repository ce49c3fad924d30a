// A suite of one case that passes, one that fails and three whose needs are absent, one of which fails before.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include "support/skip.h"

TEST_CASE("a case that passes") { CHECK(true); }

TEST_CASE("a case that fails") { CHECK(false); }

TEST_CASE("a case that finds nothing to work on") { return ngs::test::skip("no scene"); }

TEST_CASE("a case that finds nothing in one of its parts") {
  SUBCASE("the part that runs") { CHECK(true); }
  SUBCASE("the part that does not") { return ngs::test::skip("no program"); }
}

TEST_CASE("a case that fails before it finds nothing") {
  CHECK(false);
  return ngs::test::skip("no processor");
}
