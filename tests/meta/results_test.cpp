// All measurements in tables of README.md and BENCHMARKS.md come from tests/bench/results/, by results_table.py.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "support/process.h"
#include "support/python.h"
#include "support/schema_check.h"
#include "support/skip.h"
#include "support/source_tree.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

using Json = nlohmann::json;
using Words = std::vector<std::string>;

const std::string kTop = NGS_SOURCE_DIR;

test::ProcessResult tables(const Words& words, const std::string& input = "") {
  return test::run_process(
      {.argv = test::joined({"python3", kTop + "/tests/bench/results_table.py"}, words), .input = input});
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

const std::string kTable =
    "| method | without | IoU | of b | each | wall s | change | times | least | most |\n"
    "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|\n"
    "| x | - | 0.6250 | 0.75 | 0.50, 0.75 | 1.5 | | | 1 | 2 |\n"
    "| x | q | 0.3750 | 0.50 | 0.25, 0.50 | 60003.0 | -0.25 | 40002.0x | 6 | 1.2e5 |\n"
    "| y | - | 0.1000 | | 0.10 | | | | | |\n\n"
    "A title. Commit `abc1234`, two cores, 2 min: `tests/bench/results.sh shown`.";

}  // namespace

TEST_CASE("every result satisfies its schema") {
  const Json schema = Json::parse(test::read_bytes(kTop + "/data-schema/result.schema.json"));
  const auto files = test::source_files({"tests/bench/results"}, {".json"});
  REQUIRE_FALSE(files.empty());
  for (const test::SourceFile& file : files) {
    INFO(file.path);
    Json result = Json::parse(file.text);
    CHECK(test::schema_violations(schema, result) == "");
    result["columns"][0]["show"] = "guess";
    CHECK(test::schema_violations(schema, result) != "");
  }
}

TEST_CASE("pages and help have the results of all questions and no other measurements; else results.sh --write") {
  if (test::python_with("json").empty()) return test::skip("no python3");
  const test::ProcessResult check = test::succeeded(test::run_process(
      {.argv = {"bash", kTop + "/tests/bench/results.sh", "--check"}, .environment = {{"NGS_BIN", NGS_TOOL_DIR}}}));
  const test::TempDir dir;
  const std::string results = kTop + "/tests/bench/results";
  for (const char* row : {"| flash | 0.9636 |", "| bce | 1.5 s |", "| x | +.0019 |", "| y | 2.04x |"})
    CHECK(tables({"check", results, dir.write("page.md", row), "--"}).err.find(row) != std::string::npos);
  const std::string other = "| `--tau 0.6` | §5.8, 2 options |\n0.9636\n";
  CHECK(tables({"check", results, dir.write("page.md", other), "--"}).err.find("those of the questions") !=
        std::string::npos);
}

TEST_CASE("a table has a line for rows with equal labels, changes against the first line of a method, and its source") {
  if (test::python_with("json").empty()) return test::skip("no python3");
  const test::TempDir dir;
  const std::string file = dir.write("shown.json", tables({"collect"}, kLines).out);
  CHECK(Json::parse(test::read_bytes(file))["seconds"] == 120);
  CHECK(tables({"table", file, "0123456789abcdef"}).out == kTable + "\n");
  CHECK(tables({"table", file, "f"}).out == kTable + " Tools' default options have changed since.\n");
  CHECK(tables({"value", file, "iou", "mean", "method=x"}).out == "0.5\n");
  CHECK(tables({"value", file, "iou", "most", "method=x", "run=a"}).out == "0.5\n");
  CHECK(tables({"value", file, "iou", "mean", "method=z"}).exit_code != 0);
  CHECK(tables({"value", file, "iou", "each"}).exit_code != 0);
}

TEST_CASE("rows read scores, times, benchmarks and stability; invalid lines and blocks are errors") {
  if (test::python_with("json").empty()) return test::skip("no python3");
  const test::TempDir dir;
  const std::string metrics = dir.write("m.json", R"({"mean": {"iou": 0.123456789, "biou": 0.2, "biou_005": 0.3}})");
  const std::string report = dir.write("r.json", R"({"stages": {"wall_s": 1.5, "cpu_s": 2.5, "max_rss_mib": 64}})");
  const std::string benchmark = dir.write("b.json", R"({"benchmarks": [
    {"run_name": "evidence_view/v4", "aggregate_name": "mean", "cpu_time": 9},
    {"run_name": "evidence_view/v4", "aggregate_name": "median", "cpu_time": 8, "pairs/s": 7e8}]})");
  const std::string stability = dir.write("s.json", R"({"cases": [
    {"kernel": "rbf", "budget": 2, "passed": true, "textbook": "printed",
     "sweep": [{"ratio": 1, "textbook_ratio": 40}, {"ratio": 1.5, "textbook_ratio": 7}]},
    {"kernel": "rbf", "budget": 2, "passed": false, "textbook": "printed",
     "sweep": [{"ratio": 3, "textbook_ratio": "inf"}]},
    {"kernel": "rbf", "budget": 0, "passed": true, "textbook": "not applicable: exact",
     "sweep": [{"ratio": 0, "textbook_ratio": null}]}]})");
  const test::ProcessResult read =
      tables({"collect"}, "row\tmethod=x\tscores=" + metrics + "\ttimes=" + report + "\nrows\tbenchmark\t" + benchmark +
                              "\nrows\tstability\t" + stability + "\n");
  INFO(read.err);
  for (const char* row :
       {R"({"method":"x","iou":0.1234568,"biou":0.2,"biou_005":0.3,"wall_s":1.5,"cpu_s":2.5,"peak_mib":64.0})",
        R"({"kernel":"evidence view","isa":"v4","cpu_ms":8.0,"mega_pairs_s":700.0})",
        R"({"kernel":"rbf","cases":3,"exact":1,"failed":1,"textbook":2,"textbook_wrong":1,"worst_ratio":3.0,)"
        R"("textbook_ratio":40.0})"})
    CHECK(read.out.find(row) != std::string::npos);
  for (const std::string lines :
       {"rwo\tmethod=x\n", "row\tmethod\n", "meta\tcolour\tred\n", "column\tIoU\t\tiou\tmean\n",
        "column\tIoU\t\tiou\taverage\t4\n", "column\tIoU\t\tiou\tmean\t4\nrow\tiou=high\n",
        "row\tmethod=x\trun=a\nrow\tmethod=x\trun=a\n", "row\tscores=/no/such/file\n", "rows\tnovels\tfile\n"}) {
    INFO(lines);
    CHECK(tables({"collect"}, lines).exit_code != 0);
  }
  for (const char* page :
       {"<!-- result: a -->\n", "<!-- /result -->\n", "<!-- result: a -->\n<!-- result: b -->\n<!-- /result -->\n"})
    CHECK(tables({"page", dir.write("page.md", page), dir.path(), "x"}).err.find("block") != std::string::npos);
}

}  // namespace ngs
