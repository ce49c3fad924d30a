// The stability suite's own checks and report files.
#include <doctest/doctest.h>

#include <fstream>

#include "support/schema_check.h"
#include "support/stability.h"

namespace ngs {
namespace {

test::HardResult result(double budget, const test::Textbook& naive, std::vector<std::pair<double, double>> ratios) {
  test::HardResult r;
  r.kernel = "rbf";
  r.name = "weights";
  r.hard = {"distance", {}, budget, naive};
  r.draws = 1;
  for (const auto& [ours, theirs] : ratios) {
    r.hard.values.push_back(double(r.hard.values.size()));
    r.sweep.emplace_back();
    r.sweep.back().ours_ratio(ours);
    r.sweep.back().naive_ratio(theirs);
  }
  return r;
}

}  // namespace

TEST_CASE("a case fails if ngs exceeds the budget or if the textbook form never does") {
  CHECK(result(2, "printed", {{1, 1}, {1.5, 1e6}}).passed());
  CHECK_FALSE(result(2, "printed", {{1, 1}, {2.5, 1e6}}).passed());
  CHECK_FALSE(result(2, "printed", {{1, 1}, {1, 1.9}}).passed());
  CHECK(result(0, "not applicable: exact", {{0, 0}}).passed());
  CHECK_FALSE(result(2, "printed", {{NAN, 1}, {1, 1e6}}).passed());
  CHECK(result(2, "printed", {{1, 1}, {1, NAN}}).passed());
}

TEST_CASE("a case fails if its textbook form fails at every hardness") {
  CHECK_FALSE(result(0, "printed", {{0, NAN}}).passed());
  CHECK_FALSE(result(2, "printed", {{1, 1e6}, {1, 9e6}}).passed());
  CHECK(result(2, "printed", {{1, 1e5}, {1, 1e6}}).passed());
  CHECK(result(0, "printed", {{0, 0}, {0, NAN}}).passed());
  test::HardResult uncompared = result(0, "printed", {{0, NAN}});
  uncompared.sweep.emplace_back().ours_ratio(0);
  CHECK_FALSE(uncompared.passed());
}

TEST_CASE("a case fails if the textbook form's error is below the pinned size") {
  CHECK(result(2, {"printed", 5e5}, {{1, 1}, {1, 1e6}}).passed());
  CHECK_FALSE(result(2, {"printed", 5e5}, {{1, 1}, {1, 1e5}}).passed());
  CHECK_FALSE(result(0, {"printed", test::kWrong}, {{0, 0}, {0, 1e6}}).passed());
}

TEST_CASE("stability.json satisfies its schema, infinities included") {
  nlohmann::json schema = nlohmann::json::parse(std::ifstream(NGS_SOURCE_DIR "/data-schema/stability.schema.json"));
  std::vector<test::HardResult> all{result(2, "printed", {{1, 1}, {1, INFINITY}}),
                                    result(0, "not applicable: exact", {{0, 0}})};
  all[1].hard.values[0] = -INFINITY;
  nlohmann::json document = test::stability_document(all);
  CHECK(test::schema_violations(schema, document) == "");
  CHECK(document["cases"][0]["sweep"][1]["textbook_ratio"] == "inf");
  CHECK(document["cases"][1]["sweep"][0]["textbook_ratio"].is_null());
  document["cases"][0].erase("budget");
  CHECK(test::schema_violations(schema, document) != "");
}

}  // namespace ngs
