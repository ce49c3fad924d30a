#pragma once
// A session of ngs-studio on the tiny scene: its strokes, answers and command lines.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/process.h"
#include "support/skip.h"
#include "support/studio_server.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"

// A test case that is skipped where ngs-studio was not built.
#define NGS_STUDIO_CASE(body, name)                                                                       \
  static void body();                                                                                     \
  TEST_CASE(name) {                                                                                       \
    if (!::ngs::test::has_studio()) return ::ngs::test::skip("no cpp-httplib: ngs-studio was not built"); \
    body();                                                                                               \
  }                                                                                                       \
  static void body()
#define STUDIO_CASE(name) NGS_STUDIO_CASE(DOCTEST_ANONYMOUS(studio_body_), name)

namespace ngs::test {

using Json = nlohmann::json;

inline constexpr const char* kModel = "scene/scene.json";

/// A folder with the tiny scene.
struct Place {
  Place() { write_tiny_scene(dir.path() + "/scene"); }
  TempDir dir;
};

inline Json json_of(const StudioServer::Answer& answer) {
  INFO(answer.body);
  REQUIRE(answer.status >= 200);
  REQUIRE(answer.status < 300);
  return Json::parse(answer.body);
}

/// A folder with the model of the tiny scene alone.
struct SplatFolder : TempDir {
  SplatFolder() { write("model.ply", strict_ply_bytes(tiny_scene().cloud)); }
};

/// A session of ngs-studio on the tiny scene, in the folder "visit".
struct Visit {
  Place place;
  StudioServer server{place.dir.path(), {kModel, "-o", "visit"}};
  Json state = json_of(server.get("/api/state"));
};

inline std::string camera_of(const Json& state, std::size_t view) {
  Json camera = state["views"][view]["camera"];
  camera["width"] = 192;
  camera["height"] = 144;
  return camera.dump();
}

/// A point in the middle, on the ball, and a stroke along the top, on the wall.
inline std::string strokes(const std::string& camera, int object = 1) {
  return R"({"object":)" + std::to_string(object) + R"(,"camera":)" + camera +
         R"(,"strokes":[{"label":"object","radius_px":6,"points":[[96,72]]},)"
         R"({"label":"background","radius_px":5,"points":[[8,8],[184,8]]}]})";
}

inline Json finished_job(const StudioServer& server) {
  Json job;
  do {
    job = json_of(server.get("/api/job"));
  } while (job["state"] == "running");
  return job;
}

/// Starts a job, which must end well.
inline void run_job(const StudioServer& server, const std::string& name, const std::string& request = "{}") {
  CHECK(server.post("/api/" + name, request).status == 202);
  const Json job = finished_job(server);
  INFO(job.dump());
  REQUIRE(job["state"] == "done");
}

inline std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words(1);
  for (const char c : line) {
    if (c == ' ')
      words.emplace_back();
    else
      words.back() += c;
  }
  return words;
}

inline void run_tool(const std::string& folder, std::vector<std::string> argv) {
  succeeded(test::run_tool(std::move(argv), folder));
}

}  // namespace ngs::test
