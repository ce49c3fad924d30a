#include "support/hinted_flags.h"

#include <doctest/doctest.h>

namespace ngs {

TEST_CASE("complete commands of a hint are found, up to prose; mentions and placeholders are not") {
  using Commands = std::vector<std::vector<std::string>>;
  const auto of = [](const std::string& hint) { return test::hinted_commands("ngs-joint: hint: " + hint + "\n"); };
  CHECK(of("label it first: ngs-variance scene.json -o boundary.ply") ==
        Commands{{"ngs-variance", "scene.json", "-o", "boundary.ply"}});
  CHECK(of("to convert: ngs-extract '/a b/it'\\''s.ply' --activated --object-ply converted.ply.") ==
        Commands{{"ngs-extract", "/a b/it's.ply", "--activated", "--object-ply", "converted.ply"}});
  CHECK(of("ngs-scene import /c/d -o scene.json, then ngs-fit scene.json -o model.ply") ==
        Commands{{"ngs-scene", "import", "/c/d", "-o", "scene.json"}, {"ngs-fit", "scene.json", "-o", "model.ply"}});
  CHECK(of("ngs-sample scene.json boundary.ply -o queries.ply writes them") ==
        Commands{{"ngs-sample", "scene.json", "boundary.ply", "-o", "queries.ply"}});
  CHECK(of("lower the threshold (ngs-variance scene.json -o b.ply --tau 0.4), or leave it") ==
        Commands{{"ngs-variance", "scene.json", "-o", "b.ply", "--tau", "0.4"}});
  for (const char* incomplete :
       {"write it with ngs-extract --object-ply", "ngs-scene orbit MODEL -o DIR/scene.json", "ngs-fit makes a splat",
        "ngs-scene import ... --ply model.ply", "give a place: ngs-extract a.ply --around X,Y,Z,R", "see --help",
        "label the other object: ngs-variance scene.json --object NAME -o boundary.ply",
        "npx @playcanvas/splat-transform a.sog b.ply", "ngs-scene check SCENE --sheet masks.html"})
    CHECK_MESSAGE(of(incomplete).empty(), incomplete);
  CHECK(test::hinted_commands("ngs-joint: error: run ngs-variance scene.json -o b.ply\n").empty());
}

}  // namespace ngs
