// ngs-studio: corrections by hand, several objects, and what happens when Refine or opening fails.
#include <doctest/doctest.h>

#include <filesystem>
#include <map>

#include "ngs/io/ply/gaussian_ply.h"
#include "support/studio_place.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using test::StudioServer, test::Place, test::camera_of, test::finished_job, test::json_of, test::Json, test::kModel,
    test::run_job, test::run_tool, test::strokes, test::words_of;

std::int64_t rows_of(const std::string& path) { return io::read_gaussian_ply(path).cloud.size(); }

}  // namespace

STUDIO_CASE("edits by hand are counted, undone, reopened, exported and repeated by the printed commands") {
  const Place place;
  Json left;
  const std::string folder = place.dir.path() + "/visit/object-1/";
  {
    StudioServer server(place.dir.path(), {kModel, "-o", "visit"});
    const std::string camera = camera_of(json_of(server.get("/api/state")), 0);
    const auto count = [](const Json& state) { return state["objects"][0]["gaussians"].get<std::int64_t>(); };
    const std::int64_t marked = count(json_of(server.post("/api/strokes", strokes(camera))));
    const std::string lasso = R"({"object":1,"camera":)" + camera + R"(,"outline":[[0,0],[96,0],[96,144],[0,144]],)";
    const Json taken = json_of(server.post("/api/edit", lasso + R"("action":"take"})"));
    CHECK(count(taken) < marked);
    CHECK(taken["answer"]["change"] == count(taken) - marked);
    const Json ball = json_of(server.post("/api/edit", R"({"object":1,"action":"add","camera":)" + camera +
                                                           R"(,"ball":{"x":96,"y":72,"radius_px":10}})"));
    CHECK(count(ball) > count(taken));
    for (const char* action : {"grow", "shrink", "invert"})
      json_of(server.post("/api/edit", std::string(R"({"object":1,"action":")") + action + "\"}"));
    CHECK(server.post("/api/edit", R"({"object":1,"action":"melt"})").status == 400);
    CHECK(server.post("/api/edit", lasso + R"("action":"take","depth":1})").status == 400);
    CHECK(server.post("/api/edit", lasso + R"("action":"take","visible_only":1})").status == 400);
    json_of(server.post("/api/undo", "{}"));
    left = json_of(server.get("/api/state"));
    CHECK(left["objects"][0]["edits"] == 4);
    CHECK(server.quit() == 0);
  }
  StudioServer again(place.dir.path(), {kModel, "-o", "visit"});
  CHECK(json_of(again.get("/api/state"))["objects"] == left["objects"]);
  run_job(again, "export");
  const Json done = json_of(again.get("/api/state"));
  CHECK(rows_of(folder + "object.ply") == done["objects"][0]["gaussians"]);
  CHECK(rows_of(folder + "background.ply") == 374 - done["objects"][0]["gaussians"].get<std::int64_t>());
  std::map<std::string, std::string> exported;
  for (const char* name : {"labelled.ply", "object.ply", "background.ply"}) {
    exported[name] = test::read_bytes(folder + name);
    fs::remove(folder + name);
  }
  for (std::size_t line = 1; line < done["commands"].size(); ++line)
    run_tool(place.dir.path(), words_of(done["commands"][line]));
  run_tool(place.dir.path(), words_of(done["commands"][0]));
  for (const auto& [name, bytes] : exported) {
    CAPTURE(name);
    CHECK(test::read_bytes(folder + name) == bytes);
    CHECK(test::read_bytes(place.dir.path() + "/visit-again/object-1/" + name) == bytes);
  }
}

STUDIO_CASE("a locked object keeps its Gaussians, a hidden one waits, and several objects have one background") {
  const test::Visit visit;
  const auto& [place, server, state] = visit;
  const std::string camera = camera_of(state, 0);
  json_of(server.post("/api/strokes", strokes(camera)));
  CHECK(json_of(server.post("/api/objects", R"({"id":1,"locked":true})"))["objects"][0]["locked"] == true);
  CHECK(server.post("/api/strokes", strokes(camera)).status == 409);
  json_of(server.post("/api/objects", R"({"add":{"name":"left"}})"));
  const Json both = json_of(server.post("/api/edit", R"({"object":2,"action":"add","camera":)" + camera +
                                                         R"(,"outline":[[0,0],[110,0],[110,144],[0,144]]})"));
  run_job(server, "export");
  const std::string folder = place.dir.path() + "/visit/";
  const auto first = both["objects"][0]["gaussians"].get<std::int64_t>(),
             second = both["objects"][1]["gaussians"].get<std::int64_t>();
  CHECK(second > 0);
  CHECK(rows_of(folder + "object-2/object.ply") == second);
  CHECK(rows_of(folder + "background.ply") == 374 - first - second);
  json_of(server.post("/api/objects", R"({"id":2,"hidden":true})"));
  json_of(server.post("/api/objects", R"({"id":1,"locked":false})"));
  const auto refused = server.post("/api/strokes", strokes(camera));
  CHECK(refused.status == 409);
  CHECK(refused.body.find("is hidden") != std::string::npos);
}

STUDIO_CASE("Refine that finds nothing keeps the selection, with one sentence and no command") {
  const test::Visit visit;
  const auto& [place, server, state] = visit;
  const std::string camera = camera_of(state, 0);
  const Json marked = json_of(server.post("/api/strokes", strokes(camera)));
  fs::remove_all(place.dir.path() + "/scene/images");  // ngs cut cannot read the pictures
  CHECK(server.post("/api/refine", R"({"quality":"draft"})").status == 202);
  const Json job = finished_job(server);
  INFO(job.dump());
  CHECK(job["state"] == "done");
  CHECK(job["note"].get<std::string>().find("your selection") != std::string::npos);
  CHECK(job["note"].get<std::string>().find("--") == std::string::npos);
  const Json after = json_of(server.get("/api/state"));
  CHECK(after["objects"][0]["refined"] == false);
  CHECK(after["objects"][0]["gaussians"] == marked["objects"][0]["gaussians"]);
}

STUDIO_CASE("a splat that cannot be opened leaves no folder") {
  const test::TempDir dir;
  dir.write("film.mp4", "not a splat");
  const test::ProcessResult result =
      test::run_process({.argv = {NGS_TOOL_DIR "/ngs-studio", "film.mp4", "--no-browser"}, .folder = dir.path()});
  CHECK(result.exit_code == 3);
  CHECK_FALSE(fs::exists(dir.path() + "/film-studio"));
}

}  // namespace ngs
