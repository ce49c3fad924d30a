// Evidence parts: the objects of their columns, the scene that they were made from, and the path of that scene.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <filesystem>

#include "ngs/io/scene/evidence_file.h"
#include "support/process.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// The tiny scene with label maps of two objects: 'ball', and 'other' for everything else.
struct Case {
  test::TempDir dir;
  std::string scene = path("scene.json"), part = path("part.evidence"), out = path("merged.ply");

  explicit Case(const std::string& folder = {}) {
    test::write_tiny_scene(dir.path());
    if (!folder.empty()) fs::create_directories(path(folder));
    import(scene, {"other=0", "ball=7"});
  }
  std::string path(const std::string& name) const { return dir.path() + "/" + name; }
  test::ProcessResult run(const Words& argv, const std::string& folder = {}, const std::string& input = {}) const {
    return test::run_tool(argv, folder.empty() ? dir.path() : folder, {}, input);
  }
  void good(const Words& argv) const { test::succeeded(run(argv)); }
  void import(const std::string& to, const Words& objects) const {
    Words argv{"ngs-scene", "import",           "sparse",  "--ply",  "model.ply",
               "--images",  "images",           "--masks", "labels", "--mask-mode",
               "label",     "--no-align-views", "-w",      "-o",     to};
    for (const std::string& object : objects) argv.insert(argv.end(), {"--object-id", object});
    good(argv);
  }
  /// Writes parts of the ball only, after `change` was applied to them.
  template <class Change>
  void write_part(Change&& change) const {
    good({"ngs-variance", scene, "--object", "ball", "--allow-empty", "-w", "--partial", part});
    io::EvidencePart forged = io::read_evidence(part);
    change(forged);
    io::write_evidence(part, forged);
  }
  test::ProcessResult merge(const Words& more = {}) const {
    return run(test::joined({"ngs-variance", "merge", part, "-w", "-o", out}, more));
  }
};

}  // namespace

TEST_CASE("ngs-variance merge labels the object of the parts, not the first object of the scene") {
  const Case c;
  c.write_part([](io::EvidencePart&) {});
  c.good({"ngs-variance", c.scene, "--object", "ball", "-o", c.path("whole.ply")});
  const test::ProcessResult merged = test::succeeded(c.merge());
  CHECK(merged.out.find("\"name\": \"ball\"") != std::string::npos);
  CHECK(test::read_bytes(c.out) == test::read_bytes(c.path("whole.ply")));
}

TEST_CASE(
    "ngs-variance merge rejects parts without objects, with objects that the scene lacks, and with one object twice") {
  const Case c;
  const auto with_columns = [](io::EvidencePart& part, const Words& names) {
    part = {Evidence(part.evidence.gaussians, int(names.size())),
            part.model_hash,
            part.scene_path,
            part.made_with,
            names,
            part.views};
  };
  const std::pair<Words, std::string> forged[] = {{{}, "the parts have no object"},
                                                  {{"cube"}, "no object 'cube'"},
                                                  {{"other", "ball", "cube"}, "no object 'cube'"},
                                                  {{"ball", "ball"}, "object 'ball' is in the parts twice"}};
  for (const auto& [names, message] : forged) {
    c.write_part([&, n = names](io::EvidencePart& part) { with_columns(part, n); });
    test::refused(c.merge(), 4, message);
    CHECK_FALSE(fs::exists(c.out));
  }
}

TEST_CASE("ngs-variance merge rejects a scene that the parts were not made from") {
  const Case c;
  c.write_part([](io::EvidencePart&) {});
  c.import(c.path("another.json"), {"room=0", "ball=7"});
  test::refused(c.merge({"--scene", c.path("another.json")}), 4, "another.json: is scene ");
  fs::copy(c.scene, c.path("same.json"));
  CHECK(c.merge({"--scene", c.path("same.json")}).exit_code == 0);
}

TEST_CASE("evidence on stdout names its scene by an absolute path, evidence from stdin from the working directory") {
  const Case c("elsewhere");
  const test::ProcessResult piped =
      test::succeeded(c.run({"ngs-variance", "scene.json", "--object", "ball", "--partial", "-"}));
  c.dir.write("elsewhere/part.evidence", piped.out);
  CHECK(fs::equivalent(io::read_evidence(c.path("elsewhere/part.evidence")).scene_path, c.scene));
  test::succeeded(c.run({"ngs-variance", "merge", "-", "-o", c.out}, "/", piped.out));

  c.write_part([](io::EvidencePart&) {
  });  // a part in a file has a scene path relative to its folder, which a pipe does not have
  test::succeeded(c.run({"ngs-variance", "merge", "-", "-w", "-o", c.out}, {}, test::read_bytes(c.part)));
}

TEST_CASE("merging parts whose scene was read from a pipe requires --scene") {
  const Case c;
  test::succeeded(c.run({"ngs-variance", "-", "--object", "ball", "--partial", c.part}, {}, test::read_bytes(c.scene)));
  test::refused(c.merge(), 2, "--scene scene.json");
  CHECK(c.merge({"--scene", c.scene}).exit_code == 0);
}

TEST_CASE("a scene or model path inside a file is rejected before opening unless it is a regular file") {
  const Case c;
  c.write_part([](io::EvidencePart&) {});
  fs::remove(c.path("model.ply"));
  REQUIRE(mkfifo(c.path("model.ply").c_str(), 0600) == 0);
  for (const Words& argv : {Words{"ngs-variance", c.scene, "-o", c.out},
                            {"ngs-variance", "merge", c.part, "-o", c.out},
                            {"ngs-scene", "check", c.scene}}) {
    CAPTURE(argv[0]);
    test::refused(c.run(argv), 3, "model.ply: not a regular file, expected one");
  }
  fs::remove(c.scene);
  REQUIRE(mkfifo(c.scene.c_str(), 0600) == 0);
  test::refused(c.merge(), 3, "scene.json: not a regular file, expected one");
}

}  // namespace ngs
