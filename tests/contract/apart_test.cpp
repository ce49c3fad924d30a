// Four things on a table, cut out in runs apart and joined, against one run of all.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "ngs/io/ply/gaussian_ply.h"
#include "support/mutations.h"
#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

using Json = nlohmann::json;
using Words = std::vector<std::string>;

test::ProcessResult tool(const test::TempDir& dir, Words argv) {
  argv[0] = std::string(NGS_TOOL_DIR "/") + argv[0];
  argv.insert(argv.end(), {"-q", "-w"});
  return test::run_process({.argv = argv,
                            .environment = {{"NGS_THREADS", "2"}},
                            .folder = dir.path(),
                            .input = {},
                            .signal_after = {}});
}

Json done(const test::TempDir& dir, const Words& argv) {
  const test::ProcessResult result = tool(dir, argv);
  INFO(argv[0] << ": " << result.err);
  REQUIRE(result.exit_code == 0);
  return Json::parse(result.out);
}

/// Few steps and samples, but rounds of edges that halve Gaussians.
Words joint(Words more) {
  Words argv{"ngs-joint", "s.json", "b.ply", "--rows", "8", "--cols", "8", "--depth-samples", "2",
             "--mlp-hidden", "16", "--hash-levels", "2", "--hash-log2-table", "8", "--smooth-points", "32",
             "--effect", "nerf=on", "--steps", "6", "--contour-epochs", "2", "--contour-split", "1"};
  argv.insert(argv.end(), more.begin(), more.end());
  return argv;
}

/// The scene, and the paper's method in two runs apart: part0.ply, part1.ply.
const test::TempDir& table() {
  static const test::TempDir dir;
  static const bool made = [] {
    done(dir, {"ngs-synth", "table", "-o", "scene", "--views", "8", "--width-px", "128", "--height-px", "96",
               "--fit-steps", "150", "--fit-max-gaussians", "2500"});
    done(dir, {"ngs-scene", "import", "scene", "--ply", "scene/point_cloud.ply", "--images", "scene/images",
               "--masks", "scene/labels", "--mask-mode", "label", "--object-id", "a=1", "--object-id", "b=6",
               "--object-id", "c=19", "--object-id", "d=20", "--no-align-views", "-o", "s.json"});
    done(dir, {"ngs-variance", "s.json", "-o", "b.ply"});
    done(dir, joint({"--apart", "0/2", "-o", "part0.ply"}));
    done(dir, joint({"--apart", "1/2", "-o", "part1.ply"}));
    return true;
  }();
  CHECK(made);
  return dir;
}

const LabelColumns& object(const io::GaussianPly& ply, const std::string& name) {
  for (const io::NamedLabels& o : ply.objects)
    if (o.object == name) return o.columns;
  throw std::logic_error("no object " + name);
}

}  // namespace

TEST_CASE("objects that do not meet are found, and labels of methods that move nothing join to the bytes of one run") {
  const test::TempDir& dir = table();
  const Json plan = done(dir, joint({"-o", "x.ply", "-n"}))["plan"];
  CHECK(plan["groups"] == 4);
  CHECK(plan["objects_that_meet"] == Json::parse(R"([["a"], ["b"], ["c"], ["d"]])"));
  done(dir, joint({"--method", "sa3d", "-o", "all.ply"}));
  Words merge{"ngs-joint", "merge", "b.ply"};
  for (const char* shard : {"2/3", "0/3", "1/3"}) {
    merge.push_back(std::string("sa3d") + shard[0] + ".ply");
    done(dir, joint({"--method", "sa3d", "--apart", shard, "-o", merge.back()}));
  }
  merge.insert(merge.end(), {"-o", "joined.ply"});
  CHECK(done(dir, merge)["result"]["changed"] == 0);
  CHECK(test::read_bytes(dir.file("joined.ply")) == test::read_bytes(dir.file("all.ply")));
}

TEST_CASE("runs apart move and halve Gaussians of their own objects only, and join in any order") {
  const test::TempDir& dir = table();
  const Json result = done(dir, {"ngs-joint", "merge", "b.ply", "part0.ply", "part1.ply", "-o", "l.ply"})["result"];
  CHECK(result["changed"].get<int>() > 20);
  CHECK(result["added"].get<int>() > 20);
  done(dir, {"ngs-joint", "merge", "b.ply", "part1.ply", "part0.ply", "-o", "again.ply"});
  CHECK(test::read_bytes(dir.file("l.ply")) == test::read_bytes(dir.file("again.ply")));

  const io::GaussianPly model = io::read_gaussian_ply(dir.file("b.ply")),
                        joined = io::read_gaussian_ply(dir.file("l.ply")),
                        part = io::read_gaussian_ply(dir.file("part0.ply"));
  CHECK(joined.cloud.size() == model.cloud.size() + result["added"].get<std::int64_t>());
  CHECK(joined.source_row.empty());
  CHECK(joined.apart_of.empty());
  REQUIRE(joined.objects.size() == 4);
  // Part 0 has the objects a and c; what it moved is theirs, and what is another's it left.
  REQUIRE(part.objects.size() == 2);
  std::int64_t moved = 0, of_others = 0;
  for (std::size_t r = 0; r < part.source_row.size(); ++r) {
    const auto i = std::size_t(part.source_row[r]);
    if (std::memcmp(&part.cloud.position[r * 3], &model.cloud.position[i * 3], 12) == 0) continue;
    ++moved;
    for (const char* name : {"b", "d"}) of_others += object(model, name).prob[i] > 0.5f;
  }
  CHECK(moved > 20);
  CHECK(of_others == 0);
  const auto extracted = [&](const Words& select) {
    Words argv{"ngs-extract", "l.ply", "--object", "part.ply"};
    argv.insert(argv.end(), select.begin(), select.end());
    return done(dir, argv)["result"]["object"].get<int>();
  };
  const int a = extracted({"--select", "a"}), c = extracted({"--select", "c"}), both = extracted({"--select", "c", "--select", "a"});
  CHECK(std::min(a, c) > 0);
  CHECK(both > std::max(a, c));
  CHECK(both <= a + c);
}

TEST_CASE("parts that changed one and the same Gaussian are refused with the way out") {
  const test::TempDir& dir = table();
  const io::GaussianPly model = io::read_gaussian_ply(dir.file("b.ply"));
  // A Gaussian that part 1 moved: part 0 has it moved too.
  const io::GaussianPly part1 = io::read_gaussian_ply(dir.file("part1.ply")),
                        part0 = io::read_gaussian_ply(dir.file("part0.ply"));
  std::size_t row = 0, at = 0;
  while (part1.cloud.position[row * 3] == model.cloud.position[std::size_t(part1.source_row[row]) * 3]) ++row;
  while (part0.source_row[at] != part1.source_row[row]) ++at;
  std::filesystem::copy(dir.file("part0.ply"), dir.file("spoilt.ply"));
  test::apply_mutation({{"poke", dir.file("spoilt.ply")}, {"property", "y"}, {"row", at}, {"value", 0.25}});
  const test::ProcessResult refused =
      tool(dir, {"ngs-joint", "merge", "b.ply", "spoilt.ply", "part1.ply", "-o", "none.ply"});
  CHECK(refused.exit_code == 4);
  CHECK(refused.err.find("spoilt.ply and part1.ply: both changed 1 Gaussians of the model, expected none") !=
        std::string::npos);
  CHECK(refused.err.find("hint: run their objects together") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(dir.file("none.ply")));
}

TEST_CASE("parts of different objects that were made with different options are refused") {
  const test::TempDir& dir = table();
  done(dir, joint({"--method", "sa3d", "--apart", "1/2", "-o", "other1.ply"}));
  const test::ProcessResult refused = tool(dir, {"ngs-joint", "merge", "b.ply", "part0.ply", "other1.ply", "-o", "none.ply"});
  INFO(refused.err);
  CHECK(refused.exit_code == 4);
  CHECK(refused.err.find("other1.ply: made with ngs ") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(dir.file("none.ply")));
}

TEST_CASE("an object left out by every part keeps the model's labels, with a warning") {
  const test::TempDir& dir = table();
  const test::ProcessResult result = tool(dir, {"ngs-joint", "merge", "b.ply", "part1.ply", "-o", "half.ply"});
  REQUIRE(result.exit_code == 0);
  CHECK(result.out.find("object 'a' is in no part") != std::string::npos);
  const io::GaussianPly model = io::read_gaussian_ply(dir.file("b.ply")),
                        half = io::read_gaussian_ply(dir.file("half.ply"));
  const std::vector<float>&given = object(model, "a").prob, &kept = object(half, "a").prob;
  std::size_t same = 0;
  for (const float p : kept) same += std::find(given.begin(), given.end(), p) != given.end();
  CHECK(same == kept.size());
}

TEST_CASE("one object of several starts from its own labels, not from their union") {
  const test::TempDir& dir = table();
  done(dir, joint({"--objects", "a", "--effect", "contours=off", "-o", "a.ply"}));
  const io::GaussianPly model = io::read_gaussian_ply(dir.file("b.ply")), a = io::read_gaussian_ply(dir.file("a.ply"));
  std::int64_t of_others = 0;
  for (std::size_t i = 0; i < a.labels.label.size(); ++i)
    of_others += a.labels.label[i] > 0.5f && object(model, "a").prob[i] < 0.01f;
  CHECK(of_others == 0);
}

TEST_CASE("a label threshold that the heaviest of several objects overrules is named") {
  const test::TempDir& dir = table();
  const Words words{"ngs-variance", "s.json", "--label-threshold", "0.9", "-o", "t.ply"};
  const auto warned = [&](Words more) {
    more.insert(more.begin(), words.begin(), words.end());
    return done(dir, more)["warnings"].dump().find("--label-threshold is not used") != std::string::npos;
  };
  CHECK(warned({}));
  CHECK(test::read_bytes(dir.file("t.ply")) == test::read_bytes(dir.file("b.ply")));
  CHECK_FALSE(warned({"--no-exclusive"}));
  CHECK(test::read_bytes(dir.file("t.ply")) != test::read_bytes(dir.file("b.ply")));
  CHECK_FALSE(warned({"--object", "a"}));
}

}  // namespace ngs
