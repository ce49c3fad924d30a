// ngs-studio and requests that do not come from its page.
#include <doctest/doctest.h>

#include <filesystem>
#include <thread>

#include "support/studio_place.h"

namespace ngs {
namespace {

using Json = nlohmann::json;
using test::StudioServer;

constexpr const char* kCamera =
    R"({"position":[0,0,-3],"look_at":[0,0,0],"up":[0,-1,0],"fov_y_deg":50,"width":64,"height":48})";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != text.npos);
  return text.replace(at, from.size(), to);
}

std::string frame(const std::string& camera, const std::string& more = "") {
  return R"({"camera":)" + camera + more + "}";
}

std::string stroke(const std::string& inner) {
  return std::string(R"({"object":1,"camera":)") + kCamera + R"(,"strokes":[)" + inner + "]}";
}

/// Requests without one of the required properties; all are rejected with 403 and an empty body.
std::vector<std::string> of_strangers(const StudioServer& server) {
  const std::string port = std::to_string(server.port()), host = "Host: 127.0.0.1:" + port + "\r\n",
                    token = "X-Ngs-Token: " + server.token() + "\r\n", end = "Connection: close\r\n\r\n",
                    get = "GET /api/state HTTP/1.1\r\n";
  const std::string cookie = "Cookie: ngs-studio-" + port + "=";
  return {get + host + end,
          get + host + "X-Ngs-Token: \r\n" + end,
          get + host + "X-Ngs-Token: " + std::string(32, '0') + "\r\n" + end,
          get + host + "X-Ngs-Token: " + server.token().substr(1) + "\r\n" + end,
          get + host + cookie + std::string(32, 'a') + "\r\n" + end,
          get + host + "Cookie: other=" + server.token() + "\r\n" + end,
          get + "Host: evil.example:" + port + "\r\n" + token + end,
          get + "Host: 127.0.0.1\r\n" + token + end,
          get + token + end,
          get + host + token + "Origin: http://evil.example\r\n" + end,
          get + host + token + "Origin: null\r\n" + end,
          get + host + token + "Origin: http://127.0.0.1:1\r\n" + end,
          get + host + token + "Origin: https://127.0.0.1:" + port + "\r\n" + end,
          "GET / HTTP/1.1\r\n" + host + end,
          "GET /?token=" + std::string(32, '0') + " HTTP/1.1\r\n" + host + end,
          "GET /?token=" + server.token() + " HTTP/1.1\r\nHost: evil.example\r\n" + end,
          "GET /studio.js HTTP/1.1\r\n" + host + end,
          "POST /api/quit HTTP/1.1\r\n" + host + "Content-Length: 2\r\n\r\n{}"};
}

struct Refused {
  const char* path;
  std::string body;
  int status;
  const char* object;  // object of the error
};

std::vector<Refused> broken_requests() {
  const std::string camera = kCamera;
  return {
      {"/api/frame", "{", 400, "request"},
      {"/api/frame", "[]", 400, "request"},
      {"/api/frame", R"({"camera":{},"camera":{}})", 400, "request"},
      {"/api/frame", std::string(2000, '['), 400, "request"},
      {"/api/frame", "{}", 400, "camera"},
      {"/api/frame", frame("7"), 400, "camera"},
      {"/api/frame", frame(with(camera, "[0,0,-3]", "[0,NaN,-3]")), 400, "request"},
      {"/api/frame", frame(with(camera, "[0,0,-3]", "[0,1e400,-3]")), 400, "request"},
      {"/api/frame", frame(with(camera, "[0,0,-3]", "[0,1e30,-3]")), 400, "camera.position"},
      {"/api/frame", frame(with(camera, "[0,0,-3]", "[0,\"1\",-3]")), 400, "camera.position"},
      {"/api/frame", frame(with(camera, "[0,0,-3]", "[0,0,0]")), 400, "camera.look_at"},
      {"/api/frame", frame(with(camera, "64", "100000000")), 400, "camera.width"},
      {"/api/frame", frame(with(camera, "64", "-64")), 400, "camera.width"},
      {"/api/frame", frame(with(camera, "64", "64.5")), 400, "camera.width"},
      {"/api/frame", frame(with(with(camera, "64", "4096"), "48", "4096")), 400, "camera.height"},
      {"/api/frame", frame(with(camera, "50", "180")), 400, "camera.fov_y_deg"},
      {"/api/frame", frame(camera, R"(,"layer":"secret")"), 400, "layer"},
      {"/api/frame", frame(camera, R"(,"fade":1.5)"), 400, "fade"},
      {"/api/frame", frame(camera, R"(,"moving":1)"), 400, "moving"},
      {"/api/frame", frame(camera, R"(,"path":"/etc/passwd")"), 400, "path"},
      {"/api/strokes", stroke(""), 400, "strokes"},
      {"/api/strokes", stroke(R"({"label":"object","radius_px":3,"points":[]})"), 400, "strokes[0].points"},
      {"/api/strokes", stroke(R"({"label":"object","radius_px":3,"points":[[1,2,3]]})"), 400, "strokes[0].points"},
      {"/api/strokes", stroke(R"({"label":"object","radius_px":3,"points":[[1e9,2]]})"), 400, "strokes[0].points"},
      {"/api/strokes", stroke(R"({"label":"both","radius_px":3,"points":[[1,2]]})"), 400, "strokes[0].label"},
      {"/api/strokes", stroke(R"({"label":"object","radius_px":-1,"points":[[1,2]]})"), 400, "strokes[0].radius_px"},
      {"/api/strokes", with(stroke(R"({"label":"object","radius_px":3,"points":[[1,2]]})"), "1", "77"), 409,
       "object 77"},
      {"/api/objects", R"({"remove":9})", 409, "object 9"},
      {"/api/objects", R"x({"id":1,"colour":"url(http://evil.example)"})x", 400, "colour"},
      {"/api/objects", R"({"id":1,"name":"a\nb"})", 400, "name"},
      {"/api/objects", R"({"add":{"name":"../../x"},"remove":1})", 400, "remove"},
      {"/api/refine", R"({"quality":"high; rm -rf ."})", 400, "quality"},
      {"/api/export", R"({"folder":"/tmp"})", 400, "folder"},
      {"/api/nothing", "{}", 404, "POST /api/nothing"},
  };
}

}  // namespace

STUDIO_CASE("requests without a token or with another Host or Origin are rejected") {
  const test::SplatFolder dir;
  StudioServer server(dir.path(), {"model.ply"});
  for (const std::string& request : of_strangers(server)) {
    CAPTURE(request);
    const StudioServer::Answer answer = StudioServer::parsed(server.send(request));
    CHECK(answer.status == 403);
    CHECK(answer.body == "ngs-studio: access denied, open the address that it printed, with its token\n");
    CHECK(answer.headers.find("Set-Cookie") == std::string::npos);
  }
  const std::string port = std::to_string(server.port());
  const auto first = StudioServer::parsed(server.send(
      "GET /?token=" + server.token() + " HTTP/1.1\r\nHost: 127.0.0.1:" + port + "\r\nConnection: close\r\n\r\n"));
  CHECK(first.status == 303);
  CHECK(first.headers.find("Set-Cookie: ngs-studio-" + port + "=" + server.token() + "; HttpOnly; SameSite=Strict") !=
        std::string::npos);
  const auto page = StudioServer::parsed(
      server.send("GET / HTTP/1.1\r\nHost: localhost:" + port + "\r\nOrigin: http://localhost:" + port +
                  "\r\nCookie: a=b; ngs-studio-" + port + "=" + server.token() + "\r\nConnection: close\r\n\r\n"));
  CHECK(page.status == 200);
  CHECK(page.body.find("<title>") != std::string::npos);
  CHECK(page.headers.find("Content-Security-Policy: default-src 'self'") != std::string::npos);
}

STUDIO_CASE("behind a tunnel the port of Host differs: a request with the token is answered") {
  const test::SplatFolder dir;
  StudioServer server(dir.path(), {"model.ply", "-q"});  // without its address there is no page
  for (const std::string host : {"localhost:9000", "127.0.0.1:1"}) {
    const std::string head = " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n";
    const auto first = StudioServer::parsed(server.send("GET /?token=" + server.token() + head + "\r\n"));
    CHECK(first.status == 303);
    const auto state = StudioServer::parsed(server.send("GET /api/state" + head + "Origin: http://" + host +
                                                        "\r\nX-Ngs-Token: " + server.token() + "\r\n\r\n"));
    CHECK(state.status == 200);
  }
}

STUDIO_CASE("a second studio on the same port or in the same folder ends with exit code 8 and leaves the first alone") {
  const test::SplatFolder dir;
  StudioServer server(dir.path(), {"model.ply", "-o", "a"});
  const std::string port = std::to_string(server.port());
  const auto second = [&](const char* folder, const std::string& of) {
    return test::run_process(
        {.argv = {NGS_TOOL_DIR "/ngs-studio", "model.ply", "-o", folder, "--port", of, "--no-browser"},
         .folder = dir.path(),
         .signal = 15,
         .signal_after = "open http"});
  };
  test::refused(second("b", port), 8, "port " + port + ": is in use");
  test::refused(second("a", "0"), 8, "a: another run writes here");
  for (int k = 0; k < 8; ++k) CHECK(server.get("/api/state").status == 200);
}

STUDIO_CASE("a folder is refused with the next step") {
  const test::SplatFolder dir;
  test::refused(test::run_process({.argv = {NGS_TOOL_DIR "/ngs-studio", ".", "--no-browser"}, .folder = dir.path()}), 3,
                ".: a folder, expected a splat or a scene.json");
}

STUDIO_CASE("malformed requests get one clear error and do not change the studio's state") {
  const test::SplatFolder dir;
  StudioServer server(dir.path(), {"model.ply", "-o", "visit"});
  const std::string before = server.get("/api/state").body, kept = test::read_bytes(dir.path() + "/visit/studio.json");
  for (const Refused& request : broken_requests()) {
    CAPTURE(request.body.substr(0, 200));
    const StudioServer::Answer answer = server.post(request.path, request.body);
    CHECK(answer.status == request.status);
    const Json error = Json::parse(answer.body)["error"];
    CHECK(error["object"] == request.object);
    for (const char* part : {"found", "expected", "remedy"}) CHECK(error[part].is_string());
  }
  CHECK(server.get("/api/state").body == before);
  CHECK(test::read_bytes(dir.path() + "/visit/studio.json") == kept);
  CHECK_FALSE(std::filesystem::exists(dir.path() + "/visit/visit.jsonl"));
}

STUDIO_CASE("no URL path reads a file, and bodies are bounded, uncompressed and JSON") {
  const test::SplatFolder dir;
  StudioServer server(dir.path(), {"model.ply"});
  for (const char* path :
       {"/../model.ply", "/%2e%2e/model.ply", "/..%2fmodel.ply", "/model.ply", "//model.ply", "/api/../model.ply",
        "/api/state/../../model.ply", "/studio.js/../model.ply", "/index.html", "/api/frame"}) {
    CAPTURE(path);
    const StudioServer::Answer answer = server.get(path);
    CHECK((answer.status == 404 || answer.status == 400));
    CHECK(answer.body.find("ply\nformat") == std::string::npos);
  }
  const std::string head = "POST /api/undo HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server.port()) +
                           "\r\nX-Ngs-Token: " + server.token() + "\r\n",
                    json = "Content-Type: application/json\r\n";
  const auto status = [&](const std::string& rest) { return StudioServer::parsed(server.send(head + rest, 3)).status; };
  CHECK(status(json + "Content-Length: 99999999999\r\n\r\n{}") == 413);
  CHECK(status(json + "Content-Length: 1048577\r\nConnection: close\r\n\r\n" + std::string(1048577, ' ')) == 413);
  CHECK(status(json + "Transfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n") == 411);
  CHECK(status(json + "Content-Encoding: gzip\r\nContent-Length: 2\r\n\r\n{}") == 415);
  CHECK(status("Content-Type: text/plain\r\nContent-Length: 2\r\n\r\n{}") == 415);
  CHECK(status("Content-Type: multipart/form-data; boundary=x\r\nContent-Length: 2\r\n\r\n{}") == 415);
  CHECK(server.send("\r\n\r\n", 1).find("model") == std::string::npos);
  CHECK(server.send(std::string(100'000, 'A'), 1).find("200") == std::string::npos);
  CHECK(server.is_alive());
  CHECK(server.get("/api/state").status == 200);
}

STUDIO_CASE("clients that stop in the middle of a request do not block others, and are disconnected") {
  const test::SplatFolder dir;
  StudioServer server(dir.path(), {"model.ply"});
  std::vector<std::thread> slow;
  std::vector<std::string> answers(12);
  for (std::string& answer : answers)
    slow.emplace_back([&] { answer = server.send("POST /api/undo HTTP/1.1\r\nHost: x\r\nX-Slow", 30); });
  CHECK(server.get("/api/state").status == 200);
  for (std::thread& one : slow) one.join();  // each ends when the server closes the connection
  for (const std::string& answer : answers) CHECK(answer.find("200 OK") == std::string::npos);
  CHECK(server.get("/api/state").status == 200);
  CHECK(server.quit() == 0);
}

}  // namespace ngs
