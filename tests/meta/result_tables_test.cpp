// tests/bench/results_table: from the lines of a question to its table.
#include <doctest/doctest.h>

#include <sstream>

#include "ngs/core/error.h"
#include "results_table/collect.h"
#include "results_table/markers.h"
#include "results_table/readers.h"
#include "results_table/table.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

using Cells = std::vector<std::string>;

results::Result collected(const std::string& lines) {
  std::istringstream text(lines);
  return results::collect(text);
}

// Two methods on two splits; two label columns, so that each method has its own reference line.
const std::string kLines =
    "meta\tquestion\tshown\nmeta\ttitle\tA title\nmeta\tcommit\tabc1234\nmeta\tmachine\ttwo cores\n"
    "meta\tcommand\ttests/bench/results.sh shown\nmeta\tdefaults\t0123456789abcdef\nmeta\tseconds\t119.6\n"
    "column\tmethod\t\tmethod\tlabel\ncolumn\twithout\t\twithout\tlabel\n"
    "column\tIoU\t\tiou\tmean\t4\ncolumn\tof b\t\tiou\tmean\t2\trun=b\ncolumn\teach\t\tiou\teach\t2\n"
    "column\twall\ts\twall_s\tmedian\t1\ncolumn\tchange\t\tiou\tchange\t2\ncolumn\ttimes\t\twall_s\tratio\t1\n"
    "column\tleast\t\twall_s\tleast\t0\ncolumn\tmost\t\twall_s\tmost\t2g\n"
    "row\tmethod=x\twithout=-\trun=a\tiou=0.5\twall_s=1\nrow\tmethod=x\twithout=-\trun=b\tiou=0.75\twall_s=2\n"
    "row\tmethod=x\twithout=q\trun=a\tiou=0.25\twall_s=6\nrow\tmethod=x\twithout=q\trun=b\tiou=0.5\twall_s=1.2e5\n"
    "row\tmethod=y\twithout=-\trun=a\tiou=0.1\n";

}  // namespace

TEST_CASE("table cells: rows with equal labels share a line, changes refer to the first line of a method") {
  const std::vector<Cells> cells = results::cells_of(collected(kLines));
  REQUIRE(cells.size() == 4);
  CHECK(cells[0] == Cells{"method", "without", "IoU", "of b", "each", "wall s", "change", "times", "least", "most"});
  CHECK(cells[1] == Cells{"x", "-", "0.6250", "0.75", "0.50, 0.75", "1.5", "", "", "1", "2"});
  CHECK(cells[2] == Cells{"x", "q", "0.3750", "0.50", "0.25, 0.50", "60003.0", "-0.25", "40002.0x", "6", "1.2e5"});
  CHECK(cells[3] == Cells{"y", "-", "0.1000", "", "0.10", "", "", "", "", ""});
}

TEST_CASE("a result is unchanged after writing and reading") {
  const test::TempDir dir;
  const results::Result result = collected(kLines);
  const std::string text = results::text_of(result);
  CHECK(results::text_of(results::read_result(dir.write("shown.json", text))) == text);
  CHECK(text.find("\"seconds\": 120,") != std::string::npos);
  CHECK_THROWS_AS(results::read_result(dir.write("other.json", "{}")), Error);
}

TEST_CASE("a table shows commit, machine and command, and whether defaults have changed since") {
  const results::Result result = collected(kLines);
  const std::string same = results::markdown_of(result, "0123456789abcdef");
  CHECK(same.find("| method | without | IoU |") == 0);
  CHECK(same.find("|---|---|---:|") != std::string::npos);
  CHECK(same.find("A title. Commit `abc1234`, two cores, 2 min: `tests/bench/results.sh shown`.\n") !=
        std::string::npos);
  CHECK(same.find("have changed since") == std::string::npos);
  CHECK(results::markdown_of(result, "fedcba9876543210").find("default options have changed since") !=
        std::string::npos);
  results::Result without_options = result;
  without_options.defaults.clear();
  CHECK(results::markdown_of(without_options, "fedcba9876543210").find("have changed since") == std::string::npos);
}

TEST_CASE("a single value aggregates the rows that match all conditions") {
  const results::Result result = collected(kLines);
  CHECK(results::value_of(result, "iou", results::Show::kMean, {{"method", "x"}}) == doctest::Approx(0.5));
  CHECK(results::value_of(result, "iou", results::Show::kMax, {{"method", "x"}, {"run", "a"}}) == doctest::Approx(0.5));
  CHECK_THROWS_AS(results::value_of(result, "iou", results::Show::kMean, {{"method", "z"}}), Error);
  CHECK_THROWS_AS(results::value_of(result, "iou", results::Show::kEach, {}), Error);
}

TEST_CASE("invalid lines are errors") {
  for (const char* lines :
       {"rwo\tmethod=x\n", "row\tmethod\n", "meta\tcolour\tred\n", "column\tIoU\t\tiou\tmean\n",
        "column\tIoU\t\tiou\taverage\t4\n", "column\tIoU\t\tiou\tmean\t4\nrow\tiou=high\n",
        "row\tmethod=x\trun=a\nrow\tmethod=x\trun=a\n", "row\tscores=/no/such/file\n", "rows\tnovels\tfile\n"}) {
    INFO(lines);
    CHECK_THROWS_AS(collected(lines), Error);
  }
}

TEST_CASE("rows read scores and times from files of the tools") {
  const test::TempDir dir;
  const std::string metrics =
      dir.write("metrics.json", R"({"mean": {"iou": 0.123456789, "biou": 0.2, "biou_005": 0.3}})");
  const std::string report =
      dir.write("report.json", R"({"stages": {"wall_s": 1.5, "cpu_s": 2.5, "max_rss_mib": 64}})");
  const results::Result result = collected("row\tmethod=x\tscores=" + metrics + "\ttimes=" + report + "\n");
  CHECK(result.rows.dump() ==
        R"([{"method":"x","iou":0.1234568,"biou":0.2,"biou_005":0.3,"wall_s":1.5,"cpu_s":2.5,"peak_mib":64.0}])");
  CHECK_THROWS_AS(collected("row\tmethod=x\tscores=" + report + "\n"), Error);
}

TEST_CASE("benchmark rows contain medians, stability rows the worst ratios per kernel") {
  const test::TempDir dir;
  const std::string benchmark = dir.write("benchmark.json", R"({"benchmarks": [
    {"run_name": "evidence_view/v4", "aggregate_name": "mean", "cpu_time": 9},
    {"run_name": "evidence_view/v4", "aggregate_name": "median", "cpu_time": 8, "pairs/s": 7e8},
    {"run_name": "volume", "aggregate_name": "median", "cpu_time": 2}]})");
  CHECK(results::Json(results::read_rows("benchmark", benchmark)).dump() ==
        R"([{"kernel":"evidence view","isa":"v4","cpu_ms":8.0,"mega_pairs_s":700.0},)"
        R"({"kernel":"volume","isa":"-","cpu_ms":2.0}])");

  const std::string stability = dir.write("stability.json", R"({"cases": [
    {"kernel": "rbf", "budget": 2, "passed": true, "textbook": "printed",
     "sweep": [{"ratio": 1, "textbook_ratio": 40}, {"ratio": 1.5, "textbook_ratio": 7}]},
    {"kernel": "rbf", "budget": 2, "passed": false, "textbook": "printed",
     "sweep": [{"ratio": 3, "textbook_ratio": "inf"}]},
    {"kernel": "rbf", "budget": 0, "passed": true, "textbook": "not applicable: exact",
     "sweep": [{"ratio": 0, "textbook_ratio": null}]}]})");
  CHECK(results::Json(results::read_rows("stability", stability)).dump() ==
        R"([{"kernel":"rbf","cases":3,"exact":1,"failed":1,"textbook":2,"textbook_wrong":1,)"
        R"("worst_ratio":3.0,"textbook_ratio":40.0}])");
}

TEST_CASE("blocks of a page are replaced completely, other text is unchanged") {
  const std::string page =
      "above\n<!-- result: a -->\nold\n\nolder\n<!-- /result -->\nbetween\n<!-- result: b -->\n<!-- /result -->\n";
  CHECK(results::blocks_of(page) == Cells{"a", "b"});
  CHECK(results::with_blocks(page, [](const std::string& q) { return "new " + q + "\n"; }) ==
        "above\n<!-- result: a -->\nnew a\n<!-- /result -->\nbetween\n<!-- result: b -->\nnew b\n<!-- /result -->\n");
  CHECK(results::without_blocks(page).find("old") == std::string::npos);
  for (const char* broken :
       {"<!-- result: a -->\n", "<!-- /result -->\n", "<!-- result: a -->\n<!-- result: b -->\n<!-- /result -->\n"}) {
    INFO(broken);
    CHECK_THROWS_AS(results::blocks_of(broken), Error);
  }
}

TEST_CASE("the help header contains the same cells in aligned columns") {
  const std::string header = results::help_header_of(collected(
      "meta\tquestion\tq\nmeta\ttitle\tA title\ncolumn\tquality\t\tmethod\tlabel\ncolumn\tIoU\t\tiou\tmean\t2\n"
      "row\tmethod=draft\tiou=0.5\nrow\tmethod=high\tiou=0.25\n"));
  CHECK(header.find("    \"  quality   IoU\\n\"\n    \"  draft    0.50\\n\"\n    \"  high     0.25\\n\";\n") !=
        std::string::npos);
}

}  // namespace ngs
