// count-tests.awk: numbers of passed, failed and skipped cases.
#include <doctest/doctest.h>

#include "support/process.h"
#include "support/source_tree.h"

namespace ngs {
namespace {

/// Output of count-tests.awk for suites with these outputs.
std::string counted(const std::vector<std::pair<std::string, std::string>>& suites) {
  test::ProcessSpec spec{.argv = {"awk", "-f", NGS_SOURCE_DIR "/tests/ci/count-tests.awk"}, .input = "<testsuite>\n"};
  for (const auto& [name, output] : suites)
    spec.input +=
        "<testcase name=\"" + name + "\" classname=\"" + name + "\">\n<system-out>" + output + "</system-out>\n";
  return test::succeeded(test::run_process(spec)).out;
}

std::string doctest_line(const std::string& counts) { return "[doctest] test cases: " + counts + "\n"; }

}  // namespace

TEST_CASE("a case without its dependencies counts as skipped with a reason; after a failed check it counts as failed") {
  const test::ProcessResult suite = test::run_command({NGS_TOOL_DIR "/ngs_skipping"});
  CHECK(suite.exit_code == 1);
  const std::string text = counted({{"some", suite.out}});
  INFO(suite.out);
  CHECK(text.find("some              5 cases      1 passed      2 failed      2 skipped\n") != std::string::npos);
  CHECK(text.find("total             5 cases      1 passed      2 failed      2 skipped\n") != std::string::npos);
  CHECK(text.find("skipped: a case without its input: no scene\n") != std::string::npos);
  CHECK(text.find("skipped: a case without the input of a subcase: no program\n") != std::string::npos);
  CHECK(text.find("no processor") == std::string::npos);
}

TEST_CASE("counts of several suites add up, including filtered cases and checks of scripts") {
  const std::string text = counted(
      {{"unit", "skipped: one: no photo\nskipped cases: 1\n" + doctest_line("  9 |  9 passed | 0 failed | 0 skipped")},
       {"grad", doctest_line(" 4 | \033[32m3 passed\033[0m | 1 failed | 5 skipped")},
       {"contract_part1",
        "skipped: two: no wine\nskipped cases: 1\n" + doctest_line("  3 |  3 passed | 0 failed | 7 skipped")},
       {"clients", "12 checks passed, 1 failed, 2 skipped\n"},
       {"studio_page", "7 checks passed, 0 failed, 0 skipped\n"}});
  CHECK(text ==
        "unit              9 cases      8 passed      0 failed      1 skipped\n"
        "grad              4 cases      3 passed      1 failed      5 skipped\n"
        "contract_part1      3 cases      2 passed      0 failed      1 skipped\n"
        "clients          15 cases     12 passed      1 failed      2 skipped\n"
        "studio_page       7 cases      7 passed      0 failed      0 skipped\n"
        "total            38 cases     32 passed      2 failed      9 skipped\n"
        "skipped: one: no photo\n"
        "skipped: two: no wine\n");
}

}  // namespace ngs
