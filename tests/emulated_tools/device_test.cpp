// --device of the tools: the same bytes on the device and on the CPU, the choice between them, and too little memory.
#include "emulated_tools/device_run.h"
#include "support/skip.h"
#include "support/studio_server.h"

namespace ngs::test {
namespace {

using Json = nlohmann::json;

constexpr int kEnvironment = 8;

const std::string kJoint = "ngs-joint {fixture}/scene.json {fixture}/boundary.ply -o {tmp}/labelled.ply";
const std::string kEvidence = "ngs-variance {fixture}/scene.json -o {tmp}/boundary.ply";
const std::string kPictures =
    "ngs-render {fixture}/scene.json {fixture}/boundary.ply --views all --format exr "
    "--layers color,mask,alpha,depth,labels -o {tmp}/layers";
const std::string kInterpolation = "ngs-rbf {fixture}/boundary.ply {fixture}/queries.ply -o {tmp}/field.ply";
const std::string kFit =
    "ngs-fit {fixture}/scene.json -o {tmp}/fit.ply --steps 620 --random-points 60 --max-gaussians 90 --sh-degree 1 "
    "--checkpoint {tmp}/kept --checkpoint-every 300";

const std::string kMasks = "ngs-mask {fixture}/scene.json -o {tmp}/masks --prompts ";
const std::string kCut = "ngs cut {fixture}/model.ply --size 64x48 --around 0,0,0,0.7 -o {tmp}/cut --strokes ";

constexpr const char* kBox = R"({"ngs_prompts":1,"view":"v0.png","width":48,"height":36,"boxes":[[12,6,36,30]]})";
constexpr const char* kStrokes = R"({"ngs_prompts":1,"view":"0000.png","width":64,"height":48,"strokes":[)"
                                 R"({"object":true,"radius":3,"points":[[25,20],[40,20],[32,30]]},)"
                                 R"({"object":false,"radius":1,"points":[[2,2],[62,2],[62,46],[2,46],[2,2]]}]})";

bool warns_of_restart(const DeviceRun& run, const std::string& part = "the run") {
  return run.process.err.find(part + " starts again on the CPU") != std::string::npos;
}

/// A case on the CPU and on the device, which launched kernels. `last`: the file that a run writes last.
struct Compared {
  DeviceCase tool;
  std::string last;
  DeviceRun cpu, device;

  Compared(const std::string& line, std::string last_file)
      : tool(line), last(std::move(last_file)), cpu(tool.done({"cpu"})), device(tool.done({"cuda"})) {
    CHECK(cpu.device() == "cpu");
    CHECK(cpu.launches == 0);
    CHECK(device.device() == "emulated");
    REQUIRE(device.launches > 0);
    REQUIRE(std::filesystem::exists(cpu.file(last)));
    check_same_files(device, cpu);
  }
  /// Without memory for more than `allocations`, auto warns, and ends on the CPU with its bytes; cuda is an error.
  void check_too_little(std::int64_t allocations, const std::string& repeated = "the run") {
    CAPTURE(allocations);
    REQUIRE(allocations < device.allocations);
    const DeviceRun restarted = tool.done({.choice = "auto", .allocations = allocations});
    CHECK(warns_of_restart(restarted, repeated));
    CHECK(restarted.device() == "cpu");
    CHECK(restarted.report.at("device").at("reason") == "auto: emulated has too little memory");
    check_same_files(restarted, cpu);
    const DeviceRun failed = tool.run({.choice = "cuda", .allocations = allocations});
    CHECK(failed.process.exit_code == kEnvironment);
    CHECK(failed.process.err.find("device memory: ") != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(failed.file(last)));
  }
};

}  // namespace

TEST_CASE("ngs-variance writes the bytes of the CPU, wherever the memory of the device ends") {
  Compared run(kEvidence, "boundary.ply");
  for (std::int64_t allocations = 0; allocations < run.device.allocations; allocations = 2 * allocations + 1)
    run.check_too_little(allocations);
}

TEST_CASE("ngs-render writes the bytes of the CPU, also if the device has too little memory for a later view") {
  Compared run(kPictures, "layers/v5.exr");
  for (const int part : {2, 1}) run.check_too_little(run.device.allocations / part - 1);
}

TEST_CASE("ngs-rbf writes the bytes of the CPU, also without device memory") {
  Compared(kInterpolation, "field.ply").check_too_little(0);
}

TEST_CASE("ngs-fit writes the bytes of the CPU, its checkpoints too, also if the device's memory ends after one") {
  Compared run(kFit, "fit.ply");
  for (const int part : {2, 1}) run.check_too_little(run.device.allocations / part - 1);
}

TEST_CASE("ngs-joint --quality draft writes the bytes of the CPU, also if the device's memory ends on the way") {
  Compared run(kJoint + " --quality draft", "labelled.ply");
  for (const int part : {16, 4, 2, 1}) run.check_too_little(run.device.allocations / part - 1);
}

TEST_CASE("ngs-joint writes the bytes of the CPU with its defaults and with all passes") {
  const Compared defaults(kJoint, "labelled.ply");
  Compared run(kJoint + " --steps 30 --effect all=on --effect nerf=off --checkpoint {tmp}/kept --checkpoint-every 10",
               "labelled.ply");
  run.check_too_little(run.device.allocations / 2);
}

TEST_CASE("ngs-joint with the NeRF runs on the device, and starts again on the CPU if its memory ends") {
  DeviceCase tool(kJoint + " --steps 6 --effect nerf=on --mlp-hidden 16 --rows 6 --cols 6 --effect contours=off");
  const DeviceRun cpu = tool.done({"cpu"}), device = tool.done({"cuda"});  // other bits, see docs/gpu.md
  CHECK(device.launches > 0);
  for (const int part : {2, 1}) {
    const DeviceRun restarted = tool.done({.choice = "auto", .allocations = device.allocations / part - 1});
    CHECK(warns_of_restart(restarted));
    check_same_files(restarted, cpu);
  }
}

TEST_CASE("ngs-mask writes the bytes of the CPU, also if the device's memory ends on the way") {
  const TempDir dir;
  Compared run(kMasks + dir.write("box.json", kBox) + " --soft {tmp}/soft", "masks/v5.png");
  for (const int part : {2, 1}) run.check_too_little(run.device.allocations / part - 1);
}

TEST_CASE("ngs cut of a splat runs on the device, and repeats only the step at which its memory ends") {
  const TempDir dir;
  const std::string cut = kCut + dir.write("strokes.json", kStrokes);
  Compared flash(cut + " --method flash", "cut/object.ply");
  for (const int part : {4, 1}) flash.check_too_little(flash.device.allocations / part - 1, "this step");
}

TEST_CASE("ngs cut gives --device to its stages, and writes the bytes of the CPU") {
  const TempDir dir;
  Compared run(kCut + dir.write("strokes.json", kStrokes) + " --quality draft", "cut/object.ply");
  const auto device_of = [](const DeviceRun& of, const std::string& tool) {
    return Json::parse(read_bytes(of.file("cut/reports/" + tool + ".json"))).at("device").at("name");
  };
  for (const std::string tool : {"ngs-mask", "ngs-variance", "ngs-joint", "ngs-render", "ngs-scene", "ngs-extract"}) {
    CAPTURE(tool);
    CHECK(device_of(run.cpu, tool) == "cpu");
    CHECK(device_of(run.device, tool) == (tool == "ngs-scene" || tool == "ngs-extract" ? "cpu" : "emulated"));
  }
  const DeviceRun restarted = run.tool.done({.choice = "auto", .allocations = 40});
  CHECK(warns_of_restart(restarted, "this step"));
  check_same_files(restarted, run.cpu);
}

TEST_CASE("the programs that ngs-studio runs choose their device themselves, and the CPU with --device cpu") {
  if (!has_studio()) return skip("no cpp-httplib: ngs-studio was not built");
  const TempDir dir;
  {
    StudioServer server(dir.path(), {fixture_folder() + "/model.ply", "-o", "visit"});
    Json camera = Json::parse(server.get("/api/state").body).at("start");
    camera["width"] = 192;
    camera["height"] = 144;
    const Json stroke = {{"label", "object"}, {"radius_px", 6}, {"points", {{96, 72}}}};
    const Json strokes = {{"object", 1}, {"camera", camera}, {"strokes", {stroke}}};
    REQUIRE(server.post("/api/strokes", strokes.dump()).status == 200);
    REQUIRE(server.post("/api/export", "{}").status == 202);
    while (Json::parse(server.get("/api/job").body).at("state") == "running") continue;
    CHECK(server.quit() == 0);
  }
  DeviceCase again("ngs-studio {fixture}/model.ply -o {tmp}/again --replay " + dir.path() + "/visit/visit.jsonl");
  const DeviceRun cpu = again.done({"cpu"}), chosen = again.done({"auto"}), refused = again.run({"cuda"});
  REQUIRE(std::filesystem::exists(cpu.file("again/object-1/object.ply")));
  check_same_files(chosen, cpu);
  CHECK(chosen.device() == "cpu");
  CHECK(chosen.launches > 0);
  CHECK(cpu.launches == 0);
  CHECK(refused.process.exit_code == kEnvironment);
}

TEST_CASE("auto takes the device if it has enough free memory, and reports it") {
  DeviceCase tool(kEvidence);
  const DeviceRun device = tool.done({"auto"}), cpu = tool.done({.choice = "auto", .free_mib = 512});
  CHECK(device.process.err.find("device: emulated (auto), threads: 2") != std::string::npos);
  CHECK(device.report.at("device") ==
        Json{{"kind", "cuda"}, {"name", "emulated"}, {"reason", "auto"}, {"fast_atomics", false}});
  CHECK(device.launches > 0);
  const std::string reason = "auto: emulated has 512 MiB of free memory, expected 1024";
  CHECK(cpu.process.err.find("device: cpu (" + reason + ")") != std::string::npos);
  CHECK(cpu.report.at("device") == Json{{"kind", "cpu"}, {"name", "cpu"}, {"reason", reason}, {"fast_atomics", false}});
  CHECK(cpu.launches == 0);
  check_same_files(device, cpu);
  CHECK(tool.done({.choice = "cuda", .free_mib = 512}).device() == "emulated");  // no estimate overrules the user
}

TEST_CASE("ngs-joint --method flash runs on the CPU, and refuses --device cuda") {
  DeviceCase tool(kJoint + " --method flash");
  const DeviceRun cpu = tool.done({"cpu"}), chosen = tool.done({"auto"}), refused = tool.run({"cuda"});
  check_same_files(chosen, cpu);
  CHECK(chosen.report.at("device").at("reason") == "auto: only --method ngs and ng-gs have a CUDA path");
  CHECK(refused.process.exit_code == kEnvironment);
  CHECK(refused.process.err.find("only --method ngs and ng-gs have a CUDA path") != std::string::npos);
  CHECK(files_in(refused.folder).empty());
  CHECK(chosen.launches + refused.launches == 0);
}

TEST_CASE("--fast-atomics demands the device: too little memory is an error with auto too") {
  DeviceCase tool(kJoint + " --quality draft --fast-atomics");
  const DeviceRun done = tool.done({"auto"});
  CHECK(done.report.at("device").at("fast_atomics") == true);
  CHECK(done.launches > 0);
  const DeviceRun failed = tool.run({.choice = "auto", .allocations = done.allocations / 2});
  CHECK(failed.process.exit_code == kEnvironment);
  CHECK(files_in(failed.folder).empty());
}

}  // namespace ngs::test
