// Under --time-budget rounds of edges have to earn their place: what ended further from the masks is undone.
#include <doctest/doctest.h>

#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

using Json = nlohmann::json;

/// Runs ngs-joint on the tiny scene with `more`; its result is OUT.ply, the report's "result" comes back. The
/// walk is held where the contour is rendered, so that what the round does is its training's work.
Json joint(const test::TempDir& dir, const std::string& out, const std::vector<std::string>& more) {
  const std::string& fixture = test::fixture_folder();
  Json run = {"ngs-joint",
              fixture + "/scene.json",
              fixture + "/boundary.ply",
              "--steps",
              "4",
              "--effect",
              "nerf=off",
              "--effect",
              "split=off",
              "--edge-shape",
              "1000",
              "--edge-visits",
              "2",
              "--edge-rounds",
              "1",
              "-o",
              dir.path() + "/" + out + ".ply",
              "--report",
              dir.path() + "/" + out + ".json"};
  for (const std::string& word : more) run.push_back(word);
  const test::ProcessResult result = test::run_process(test::command(run));
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  return Json::parse(test::read_bytes(dir.path() + "/" + out + ".json")).at("result");
}

}  // namespace

TEST_CASE("under a budget a round of edges that ends far from the masks is undone, and only such a one") {
  const test::TempDir dir;
  const std::vector<std::string> ruinous{"--effect", "edges=on", "--edge-rate", "30"};
  joint(dir, "before", {"--effect", "edges=off"});
  const auto bytes = [&](const std::string& name) {
    return test::read_bytes(dir.path() + "/" + name + ".ply");
  };

  const Json unasked = joint(dir, "ruined", ruinous);  // without a budget the round is taken as it is
  CHECK(unasked.at("edge_rounds") == 1);
  CHECK(bytes("ruined") != bytes("before"));

  std::vector<std::string> budgeted = ruinous;
  budgeted.insert(budgeted.end(), {"--time-budget", "1h"});
  const Json undone = joint(dir, "undone", budgeted);
  CHECK(undone.at("edge_rounds_undone") == 1);
  CHECK_FALSE(undone.contains("edge_rounds"));
  CHECK(bytes("undone") == bytes("before"));

  const Json kept = joint(dir, "kept", {"--effect", "edges=on", "--time-budget", "1h"});
  CHECK(kept.at("edge_rounds") == 1);
  CHECK_FALSE(kept.contains("edge_rounds_undone"));
  CHECK(bytes("kept") != bytes("before"));
}

}  // namespace ngs
