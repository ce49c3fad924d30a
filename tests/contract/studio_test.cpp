// ngs-studio as seen by a browser: its responses, its errors, and that its files equal those of the command line.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "ngs/io/ply/gaussian_ply.h"
#include "support/studio_place.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using test::StudioServer, test::Place, test::camera_of, test::finished_job, test::Json, test::json_of, test::kModel,
    test::run_tool, test::strokes, test::words_of;

}  // namespace

STUDIO_CASE("a session on the page selects, corrects and undoes, and can be closed and reopened") {
  const Place place;
  Json left;
  {
    StudioServer server(place.dir.path(), {kModel, "-o", "visit"});
    const Json state = json_of(server.get("/api/state"));
    CHECK(state["gaussians"] == 374);
    CHECK(state["views"].size() == 6);
    CHECK(state["objects"][0]["gaussians"] == 0);
    const Json marked = json_of(server.post("/api/strokes", strokes(camera_of(state, 0))));
    CHECK(marked["version"] > state["version"]);
    CHECK(marked["objects"][0]["gaussians"] == marked["answer"]["gaussians"]);
    CHECK(marked["answer"]["gaussians"] > 40);
    CHECK(marked["answer"]["coverage"] > 0.01);
    CHECK(marked["undo"] == 1);
    const Json undone = json_of(server.post("/api/undo", "{}"));
    CHECK(undone["objects"][0]["gaussians"] == 0);
    CHECK(undone["redo"] == 1);
    CHECK(json_of(server.post("/api/redo", ""))["objects"] == marked["objects"]);
    CHECK(server.post("/api/redo", "{}").status == 409);
    json_of(server.post("/api/objects", R"({"add":{"name":"wall \u00e9"}})"));
    CHECK(json_of(server.post("/api/objects", R"({"active":1})"))["active"] == 1);
    const auto frame = server.post("/api/frame", R"({"camera":)" + camera_of(state, 0) + R"(,"moving":true})");
    CHECK(frame.status == 200);
    CHECK(frame.headers.find("Content-Type: image/jpeg") != std::string::npos);
    CHECK(frame.headers.find("X-Ngs-Ms: ") != std::string::npos);
    CHECK(frame.body.starts_with("\xff\xd8\xff"));
    const Json log = json_of(server.get("/api/log"));
    CHECK(log["strokes"]["n"] == 1);
    CHECK(log["frames"]["moving"]["n"] == 1);
    CHECK(log["frames"]["still"]["n"] == 0);
    left = json_of(server.get("/api/state"));
    CHECK(server.quit() == 0);
  }
  StudioServer again(place.dir.path(), {kModel, "-o", "visit"});
  const Json state = json_of(again.get("/api/state"));
  CHECK(state["objects"] == left["objects"]);
  CHECK(state["undo"] == 0);
}

STUDIO_CASE("exported files equal those of the printed commands, and those of a replay") {
  const test::Visit visit;
  const auto& [place, server, state] = visit;
  CHECK(server.post("/api/export", "{}").status == 409);
  for (const std::size_t view : {0u, 3u}) json_of(server.post("/api/strokes", strokes(camera_of(state, view))));
  run_job(server, "export");
  const Json done = json_of(server.get("/api/state"));
  const std::string top = place.dir.path() + "/visit/";
  std::map<std::string, std::string> exported;
  for (const Json& file : done["export"]["files"]) exported[file] = test::read_bytes(top + file.get<std::string>());
  CHECK(exported.size() == 6);  // three splats, strokes.json, two masks
  for (const auto& [file, bytes] : exported) CHECK_FALSE(bytes.empty());

  for (const char* name : {"labelled.ply", "object.ply", "background.ply", "boundary.ply", "flash.ply"})
    fs::remove(top + "object-1/" + name);
  for (std::size_t line = 1; line < done["commands"].size(); ++line)
    run_tool(place.dir.path(), words_of(done["commands"][line]));
  for (const auto& [name, bytes] : exported) {
    const std::string& file = name;
    CAPTURE(file);
    CHECK(test::read_bytes(top + file) == bytes);
  }
  run_tool(place.dir.path(), words_of(done["commands"][0]));
  for (const auto& [name, bytes] : exported) {
    const std::string& file = name;
    CAPTURE(file);
    CHECK(test::read_bytes(place.dir.path() + "/visit-again/" + file) == bytes);
  }
}

STUDIO_CASE("the export has exactly the Gaussians that the page counts, if most of the scene is unseen") {
  const Place place;
  GaussianCloud museum = test::tiny_scene().cloud;
  test::add_unseen(museum);
  place.dir.write("scene/model.ply", test::strict_ply_bytes(museum));
  StudioServer server(place.dir.path(), {kModel, "-o", "visit"});
  const Json state = json_of(server.get("/api/state"));
  for (const std::size_t view : {0u, 3u}) json_of(server.post("/api/strokes", strokes(camera_of(state, view))));
  run_job(server, "export");
  const Json done = json_of(server.get("/api/state"));
  const auto count = done["objects"][0]["gaussians"].get<std::int64_t>();
  const std::string folder = place.dir.path() + "/visit/object-1/";
  const GaussianCloud object = io::read_gaussian_ply(folder + "object.ply").cloud;
  CHECK(object.size() == count);
  CHECK(io::read_gaussian_ply(folder + "background.ply").cloud.size() == 3374 - count);
  const io::GaussianPly labelled = io::read_gaussian_ply(folder + "labelled.ply");
  CHECK(std::count(labelled.labels.label.begin(), labelled.labels.label.end(), 1.f) == count);
  for (std::size_t i = 0; i < std::size_t(object.size()); ++i) CHECK(object.position[3 * i + 2] > -1);

  const Json marked = json_of(server.post("/api/objects", R"({"all_pieces":true})"));
  CHECK(marked["all_pieces"] == true);
  CHECK_FALSE(marked.contains("export"));  // the files belong to another selection
  CHECK(marked["objects"][0]["gaussians"] == count + done["objects"][0]["left_out"].get<std::int64_t>());
  run_job(server, "export");
  CHECK(io::read_gaussian_ply(folder + "object.ply").cloud.size() == marked["objects"][0]["gaussians"]);
}

STUDIO_CASE("after Refine the page counts the Gaussians of the refined object, and no older file remains") {
  const test::Visit visit;
  const auto& [place, server, state] = visit;
  json_of(server.post("/api/strokes", strokes(camera_of(state, 0))));
  run_job(server, "export");
  run_job(server, "refine", R"({"quality":"draft"})");
  const Json refined = json_of(server.get("/api/state"));
  const std::string folder = place.dir.path() + "/visit/object-1/";
  const std::vector<float> label = io::read_gaussian_ply(folder + "cut/labelled.ply").labels.label.values();
  CHECK(refined["objects"][0]["gaussians"] == std::ranges::count_if(label, [](float l) { return l >= 0.5f; }));
  CHECK(refined["objects"][0]["gaussians"] >= io::read_gaussian_ply(folder + "cut/object.ply").cloud.size());
  CHECK_FALSE(refined.contains("export"));
  CHECK_FALSE(fs::exists(folder + "object.ply"));
}

STUDIO_CASE("a stroke on nothing is rejected with a hint") {
  const test::Visit visit;
  const StudioServer& server = visit.server;
  Json camera = visit.state["views"][0]["camera"];
  camera["width"] = 192;
  camera["height"] = 144;
  for (std::size_t a = 0; a < 3; ++a)
    camera["look_at"][a] = 2 * camera["position"][a].get<double>() - camera["look_at"][a].get<double>();
  const auto answer = server.post("/api/strokes", strokes(camera.dump()));
  CHECK(answer.status == 409);
  CHECK(answer.body.find("nothing is there") != std::string::npos);
  const auto background =
      server.post("/api/strokes", R"({"object":1,"camera":)" + camera.dump() +
                                      R"(,"strokes":[{"label":"background","radius_px":6,"points":[[96,72]]}]})");
  CHECK(background.status == 409);
  const Json state = json_of(server.get("/api/state"));
  CHECK(state["objects"][0]["strokes"] == 0);
  CHECK(state["undo"] == 0);
}

STUDIO_CASE("the answer to a stroke has the change of the count, 0 for a stroke without effect") {
  const test::Visit visit;
  const StudioServer& server = visit.server;
  const std::string stroke = strokes(camera_of(visit.state, 0));
  const Json first = json_of(server.post("/api/strokes", stroke));
  CHECK(first["answer"]["change"] == first["answer"]["gaussians"]);
  CHECK(first["objects"][0]["views"] == 1);
  const Json again = json_of(server.post("/api/strokes", stroke));
  CHECK(again["answer"]["change"] == 0);
  CHECK(again["objects"][0]["gaussians"] == first["objects"][0]["gaussians"]);
}

STUDIO_CASE("the focus is the piece under the strokes, also if all pieces are shown") {
  const test::Visit visit;
  const auto& [place, server, state] = visit;
  // Without a background stroke colours alone decide which part of the wall is selected.
  const Json marked =
      json_of(server.post("/api/strokes", R"({"object":1,"camera":)" + camera_of(state, 0) +
                                              R"(,"strokes":[{"label":"object","radius_px":6,"points":[[96,72]]}]})"));
  const Json focus = marked["objects"][0]["focus"];
  CHECK(focus["radius"] < 0.6 * state["bounds"]["radius"].get<double>());
  const Json all = json_of(server.post("/api/objects", R"({"all_pieces":true})"));
  CHECK(all["objects"][0]["focus"] == focus);
}

STUDIO_CASE("Export writes the chosen format with the same Gaussians, and only its files can be downloaded") {
  const test::Visit visit;
  const StudioServer& server = visit.server;
  json_of(server.post("/api/strokes", strokes(camera_of(visit.state, 0))));
  CHECK(server.post("/api/export", R"({"format":"exe"})").status == 400);
  CHECK(server.post("/api/download", R"({"file":"object-1/object.ply"})").status == 400);
  const std::string folder = visit.place.dir.path() + "/visit/";
  const auto exported = [&](const std::string& format) {
    run_job(server, "export", R"({"format":")" + format + "\"}");
    return json_of(server.get("/api/state"));
  };
  const Json plain = exported("ply");
  CHECK(plain["export"]["path"] == fs::absolute(folder).parent_path().string());
  const Json spz = exported("spz");
  CHECK_FALSE(fs::exists(folder + "object-1/object.ply"));  // an older selection could stay in it
  CHECK(io::read_gaussian_ply(folder + "object-1/object.spz").cloud.size() == spz["objects"][0]["gaussians"]);
  const auto file = server.post("/api/download", R"({"file":"object-1/object.spz"})");
  CHECK(file.status == 200);
  CHECK(file.headers.find("filename=\"object.spz\"") != std::string::npos);
  CHECK(file.body == test::read_bytes(folder + "object-1/object.spz"));
  for (const char* other : {"studio.json", "object-1/../studio.json", "/etc/passwd", "object-1/object.ply"})
    CHECK(server.post("/api/download", Json{{"file", other}}.dump()).status == 400);
  run_job(server, "export", R"({"format":"ply","mesh":true})");
  CHECK(test::read_bytes(folder + "object-1/mesh.glb").starts_with("glTF"));
  CHECK(json_of(server.get("/api/state"))["commands"].dump().find("--collider convex:8") != std::string::npos);
  CHECK(server.post("/api/download", R"({"file":"object-1/mesh.glb"})").status == 200);
  run_job(server, "refine", R"({"quality":"draft"})");
  exported("compressed.ply");
  CHECK_FALSE(fs::exists(folder + "object-1/cut/mesh.glb"));
  CHECK(io::read_gaussian_ply(folder + "object-1/cut/object.compressed.ply").cloud.size() ==
        io::read_gaussian_ply(folder + "object-1/cut/object.ply").cloud.size());
}

STUDIO_CASE("Refine runs ngs cut on the scene's views and the marked ones, and Export delivers its files") {
  const test::Visit visit;
  const auto& [place, server, state] = visit;
  json_of(server.post("/api/strokes", strokes(camera_of(state, 0))));
  CHECK(server.post("/api/refine", R"({"quality":"perfect"})").status == 400);
  run_job(server, "refine", R"({"quality":"draft"})");
  const Json refined = json_of(server.get("/api/state"));
  CHECK(refined["objects"][0]["refined"] == true);
  CHECK(json_of(server.post("/api/before", R"({"show":true})"))["before"] == true);
  run_job(server, "export");
  const Json files = json_of(server.get("/api/state"))["export"]["files"];
  CHECK(std::find(files.begin(), files.end(), "object-1/cut/object.ply") != files.end());
  CHECK(fs::exists(place.dir.path() + "/visit/object-1/cut/object.ply"));
  const Json after = json_of(server.post("/api/undo", "{}"));
  CHECK(after["objects"][0]["refined"] == false);
}

STUDIO_CASE("a cancelled job ends without changing the studio's state") {
  const test::Visit visit;
  const StudioServer& server = visit.server;
  CHECK(server.post("/api/cancel", "{}").status == 409);
  json_of(server.post("/api/strokes", strokes(camera_of(visit.state, 0))));
  CHECK(server.post("/api/refine", R"({"quality":"high"})").status == 202);
  json_of(server.post("/api/cancel", "{}"));
  CHECK(finished_job(server)["state"] == "cancelled");
  CHECK(json_of(server.get("/api/state"))["objects"][0]["refined"] == false);
}

}  // namespace ngs
