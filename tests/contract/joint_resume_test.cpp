// An ngs-joint run resumed from its checkpoint equals an uninterrupted run, wherever the signal came; and a checkpoint
// is rejected by any other run.
#include <doctest/doctest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>

#include "ngs/io/files/safetensors.h"
#include "ngs/io/image/image_file.h"
#include "support/mutations.h"
#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Words = std::vector<std::string>;

struct Case {
  test::TempDir dir;
  std::string keep = dir.path() + "/keep", kept = keep + "/checkpoint.safetensors";
  std::string scene = test::fixture_folder() + "/scene.json";

  std::string path(const std::string& name) const { return dir.path() + "/" + name + ".ply"; }
  std::string bytes(const std::string& name) const { return test::read_bytes(path(name)); }

  /// Writes NAME.ply. Sends TERM as soon as stderr contains `interrupt`, if that is given.
  test::ProcessResult joint(const std::string& name, const Words& more, const std::string& interrupt = {}) const {
    return test::run_process(spec(name, more, interrupt));
  }
  test::ProcessSpec spec(const std::string& name, const Words& more, const std::string& interrupt = {}) const {
    const Words run{"ngs-joint", scene, test::fixture_folder() + "/boundary.ply", "-v", "-o", path(name)};
    test::ProcessSpec spec = test::command(test::joined(run, more));
    if (!interrupt.empty()) {
      spec.signal = SIGTERM;
      spec.signal_after = interrupt;
    }
    return spec;
  }
};

Words operator+(const Words& words, const Words& more) { return test::joined(words, more); }

bool has_message(const test::ProcessResult& result, const std::string& text) {
  return result.err.find(text) != std::string::npos;
}

/// Stops the run with `options` when it prints `interrupt`, resumes it and compares. Returns the output of the resumed
/// run.
test::ProcessResult stop_and_resume(const Case& c, const Words& options, const std::string& interrupt, bool keeps) {
  REQUIRE(c.joint("whole", options).exit_code == 0);
  const Words kept = options + Words{"--checkpoint", c.keep};
  const test::ProcessResult stopped = c.joint("resumed", kept, interrupt);
  INFO(stopped.err);
  REQUIRE(stopped.exit_code == 128 + SIGTERM);
  CHECK_FALSE(fs::exists(c.path("resumed")));
  CHECK(fs::exists(c.kept) == keeps);
  const test::ProcessResult resumed = test::succeeded(c.joint("resumed", kept + Words{"--resume"}));
  CHECK(has_message(resumed, "resumed after step") == keeps);
  CHECK(c.bytes("resumed") == c.bytes("whole"));
  return resumed;
}

/// A copy of the scene whose photos show vertical stripes: many edges that are in no mask.
void lay_stripes(Case& c) {
  const fs::path copy = c.dir.path() + "/striped";
  fs::copy(test::fixture_folder(), copy, fs::copy_options::recursive);
  c.scene = (copy / "scene.json").string();
  for (const auto& file : fs::directory_iterator(copy / "images")) {
    const auto [w, h] = io::read_image_size(file.path().string());
    ImageU8 photo(w, h, 3);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        for (int k = 0; k < 3; ++k) photo.at(x, y, k) = x % 6 < 3 ? 230 : 25;
    io::write_png(file.path().string(), photo);
  }
}

/// `figure` of the report of a run that wrote NAME.
Json figure(const Case& c, const std::string& name, const std::string& figure) {
  return Json::parse(test::read_bytes(c.dir.path() + "/" + name + ".json")).at("result").at(figure);
}

/// Ten steps, with a checkpoint after the first six.
const Words kSteps{"--steps", "10", "--effect", "nerf=off", "--effect", "contours=off"};
void keep_six(const Case& c, const Words& more = {}) {
  REQUIRE(c.joint("kept", kSteps + more + Words{"--checkpoint", c.keep, "--checkpoint-every", "6"}).exit_code == 0);
  REQUIRE(fs::exists(c.kept));
}

}  // namespace

TEST_CASE("ngs-joint stopped during preparation writes no checkpoint, and starts from the beginning") {
  const Case c;
  const Words options{"--steps",  "4",           "--effect", "contours=off",
                      "--effect", "floaters=on", "--effect", "mask-outliers=on"};
  stop_and_resume(c, options, "device", false);
}

TEST_CASE("ngs-joint stopped during its steps resumes with the next step") {
  const Case c;
  stop_and_resume(c, {"--steps", "400", "--effect", "nerf=off", "--effect", "contours=off"}, "step 1 begins", true);
}

TEST_CASE("ngs-joint stopped during contour refinement resumes the refinement") {
  const Case c;
  // Contours must not move, so that the iteration is accepted; its many steps leave time for the signal.
  const Words edges{"--effect",         "contours=on", "--contour-band", "0.5", "--contour-iterations", "1",
                    "--contour-epochs", "400"};
  const test::ProcessResult resumed =
      stop_and_resume(c, Words{"--steps", "4", "--effect", "nerf=off"} + edges, "contours begin", true);
  CHECK(has_message(resumed, "resumed after step 4"));
}

TEST_CASE("ngs-joint takes no joint steps before contour iterations at half resolution, unless they are wanted") {
  Case c;
  const Json views = Json::parse(test::read_bytes(c.scene)).at("views");
  const auto n = std::count_if(views.begin(), views.end(), [](const Json& v) { return v.at("split") == "train"; });
  const Words coarse{"--effect", "nerf=off",    "--effect",         "full-resolution=off",
                     "--effect", "contours=on", "--contour-epochs", "2"};
  const auto report = [&](const std::string& name) {
    return Words{"-w", "--report", c.dir.path() + "/" + name + ".json"};
  };
  REQUIRE(c.joint("rounds", coarse + report("rounds")).exit_code == 0);
  REQUIRE(figure(c, "rounds", "contour_iterations") >= 2);
  CHECK(figure(c, "rounds", "steps") == 0);
  const Words wanted = coarse + Words{"--effect", "joint=on"};
  REQUIRE(c.joint("wanted", wanted + report("wanted")).exit_code == 0);
  CHECK(figure(c, "wanted", "steps") == 10 * n);
  REQUIRE(c.joint("one", wanted + Words{"--contour-iterations", "1"} + report("one")).exit_code == 0);
  REQUIRE(figure(c, "one", "contour_iterations") == 1);
  CHECK(figure(c, "one", "steps") == 10 * n);

  lay_stripes(c);  // the refinement is rejected
  REQUIRE(c.joint("refused", wanted + report("refused")).exit_code == 0);
  REQUIRE(figure(c, "refused", "contour_iterations") == 0);
  CHECK(figure(c, "refused", "steps") == 10 * n);
}

TEST_CASE("ngs-joint without disk space for a checkpoint writes its result and warns") {
  const Case c;
  const Words few{"--steps", "4", "--effect", "nerf=off", "--effect", "contours=on", "--contour-epochs", "2"};
  REQUIRE(c.joint("whole", few).exit_code == 0);
  const int room_kib =
      int(fs::file_size(c.path("whole")) / 1024) + 8;  // enough for the model; a checkpoint also has the Adam moments
  const Words kept = few + Words{"--checkpoint", c.keep, "--checkpoint-every", "1"};
  const test::ProcessResult result =
      test::succeeded(test::run_process(test::with_files_of_at_most(room_kib, c.spec("full", kept))));
  CHECK(c.bytes("full") == c.bytes("whole"));
  CHECK(has_message(result, "the checkpoint was not written, the run continues without it"));
  CHECK(fs::is_empty(c.keep));
}

TEST_CASE("ngs-joint stopped without disk space for a checkpoint returns an error") {
  const Case c;
  const Words many{"--steps", "400", "--effect", "nerf=off", "--effect", "contours=off", "--checkpoint", c.keep};
  test::refused(test::run_process(test::with_files_of_at_most(32, c.spec("full", many, "step 1 begins"))), 8,
                "checkpoint.safetensors: writing failed");
  CHECK_FALSE(fs::exists(c.path("full")));
}

TEST_CASE("ngs-joint resumed under a time budget runs all remaining steps and continues their numbers") {
  const Case c;
  REQUIRE(c.joint("whole", kSteps).exit_code == 0);
  keep_six(c);
  const std::string trace = c.dir.path() + "/t.jsonl";
  const Words more{"--checkpoint", c.keep, "--resume", "--time-budget", "1h", "--trace", trace};
  REQUIRE(c.joint("resumed", kSteps + more).exit_code == 0);
  CHECK(c.bytes("resumed") == c.bytes("whole"));
  std::vector<int> steps;
  std::ifstream lines(trace);
  for (std::string line; std::getline(lines, line);) steps.push_back(Json::parse(line).at("step"));
  CHECK(steps == std::vector<int>{0, 7, 8, 9, 10});
}

TEST_CASE("ngs-joint rejects the checkpoint of another run") {
  Case c;
  keep_six(c);
  const Words resume = kSteps + Words{"--checkpoint", c.keep, "--resume"};
  CHECK(c.joint("same", resume).exit_code == 0);
  const std::string decided = c.dir.path() + "/decided.json";
  REQUIRE(c.joint("decided", kSteps + Words{"--effect", "mask-geometry=off", "--report", decided}).exit_code == 0);
  for (const Words& other : {Words{"--background", "1,1,1"},
                             {"--compat", "gsplat"},
                             {"--seed", "3"},
                             {"--lambda-cont", "0.2"},
                             {"--effect", "joint=off"},
                             {"--effects-from", decided}}) {
    CAPTURE(other[0]);
    test::refused(c.joint("other", resume + other), 4, "the checkpoint of a run with other inputs, options or effects");
  }
  // A scene next to the other, so that its photos are found, with one training view less.
  std::string text = test::read_bytes(c.scene);
  const std::size_t at = text.find("\"train\"");
  REQUIRE(at != std::string::npos);
  const fs::path copy = c.dir.path() + "/scene";
  fs::copy(test::fixture_folder(), copy, fs::copy_options::recursive);
  std::ofstream(copy / "scene.json") << text.replace(at, 7, "\"held-out\"");
  c.scene = (copy / "scene.json").string();
  CHECK(c.joint("other", resume).exit_code == 4);
}

TEST_CASE("ngs-joint resumes with a copy of its files, but not with a different mask or photo") {
  Case c;
  keep_six(c);
  const Words resume = kSteps + Words{"--checkpoint", c.keep, "--resume"};
  const fs::path copy = c.dir.path() + "/scene";
  fs::copy(test::fixture_folder(), copy, fs::copy_options::recursive);
  c.scene = (copy / "scene.json").string();
  CHECK(has_message(c.joint("copied", resume), "resumed after step 6"));
  for (const std::string file : {"masks/v1.png", "images/v3.png"}) {
    const fs::path other = copy / (file[0] == 'm' ? "masks/v2.png" : "images/v4.png"), kept = copy / "kept.png";
    fs::copy_file(copy / file, kept);
    fs::copy_file(other, copy / file, fs::copy_options::overwrite_existing);
    CAPTURE(file);
    test::refused(c.joint("other", resume), 4, "the checkpoint of a run with other inputs, options or effects");
    fs::remove(copy / file);
    fs::rename(kept, copy / file);
  }
  CHECK(c.joint("again", resume).exit_code == 0);
}

TEST_CASE(
    "ngs-joint rejects the checkpoint of another run before it searches floaters, and uses none of its floaters") {
  const Case c;
  const Words options = kSteps + Words{"--effect", "floaters=on", "--checkpoint", c.keep};
  REQUIRE(c.joint("first", options + Words{"--checkpoint-every", "6"}).exit_code == 0);
  const test::ProcessResult refused = c.joint("other", options + Words{"--resume", "--lambda-cont", "0.2"});
  INFO(refused.err);
  CHECK(refused.exit_code == 4);
  CHECK_FALSE(has_message(refused, "auto: exposure="));
}

TEST_CASE(
    "ngs-joint rejects a checkpoint whose step is beyond its plan, or with arrays of other lengths or not finite") {
  const Case c;
  keep_six(c);
  const io::TensorFile whole = io::read_safetensors(c.kept);
  const auto refused = [&](const std::string& text, const std::function<void(io::TensorFile&)>& forge) {
    io::TensorFile forged = whole;
    forge(forged);
    io::write_safetensors(c.kept, forged);
    test::refused(c.joint("other", kSteps + Words{"--checkpoint", c.keep, "--resume"}), 3, text);
  };
  for (const std::string step : {"1e300", "999", "11", "-1", "3.5", "nan", " 6", "6x", ""})
    refused("'step' is '" + step + "', expected a whole number from 0 to 10",
            [&](io::TensorFile& file) { file.metadata["step"] = step; });
  for (const std::string name : {"position", "label", "label.m", "sh_dc.v"}) {
    const auto tensor_of = [&](io::TensorFile& file) -> io::Tensor& {
      return *std::ranges::find(file.tensors, name, &io::Tensor::name);
    };
    refused("'" + name + "' has a value that is not finite",
            [&](io::TensorFile& file) { std::fill_n(tensor_of(file).bytes.begin(), 4, std::uint8_t(0xff)); });
    refused("checkpoint.safetensors: '" + name + "' has ", [&](io::TensorFile& file) {
      io::Tensor& tensor = tensor_of(file);
      tensor.shape[0] -= 1;
      tensor.bytes.resize(tensor.bytes.size() - sizeof(float));
    });
  }
  CHECK_FALSE(fs::exists(c.path("other")));
}

TEST_CASE("ngs-joint resumes if Gaussians of the model are not finite") {
  const Case c;
  const std::string model = c.dir.path() + "/model.ply";
  fs::copy_file(test::fixture_folder() + "/boundary.ply", model);
  test::apply_mutation({{"poke", model}, {"property", "x"}, {"row", 5}, {"value", "nan"}});
  const auto joint = [&](const std::string& name, const Words& more) {
    test::ProcessSpec spec = c.spec(name, more);
    spec.argv[2] = model;
    return test::run_process(spec);
  };
  REQUIRE(joint("whole", kSteps).exit_code == 0);
  REQUIRE(joint("kept", kSteps + Words{"--checkpoint", c.keep, "--checkpoint-every", "6"}).exit_code == 0);
  const test::ProcessResult resumed =
      test::succeeded(joint("resumed", kSteps + Words{"--checkpoint", c.keep, "--resume"}));
  CHECK(c.bytes("resumed") == c.bytes("whole"));
}

TEST_CASE(
    "ngs-joint resumed repeats the decisions of the interrupted run, and reports what that run skipped for lack of "
    "time") {
  const Case c;
  keep_six(c);
  const Words resume =
      kSteps + Words{"--checkpoint", c.keep, "--resume", "-w", "--report", c.dir.path() + "/resumed.json"};
  io::TensorFile file = io::read_safetensors(c.kept);
  const auto as_decided = nlohmann::ordered_json::parse(file.metadata.at("run"));
  const auto outliers = [](const Json& effects) {
    return *std::find_if(effects.begin(), effects.end(), [](const Json& e) { return e.at("name") == "mask-outliers"; });
  };
  auto run = as_decided;
  const auto goes_on = [&](int exit_code) {
    file.metadata["run"] = run.dump();
    io::write_safetensors(c.kept, file);
    const test::ProcessResult resumed = c.joint("resumed", resume);
    INFO(resumed.err);
    CHECK(resumed.exit_code == exit_code);
    CHECK(has_message(resumed, "resumed after step 6") == (exit_code != 4));
  };
  run["left_out"] = {"mask-outliers"};
  goes_on(7);
  CHECK(outliers(figure(c, "resumed", "effects")).at("reason") == "--time-budget: skipped, no time left");
  run = as_decided;
  *std::find(run.at("effects").begin(), run.at("effects").end(), "mask-outliers=off") = "mask-outliers=on";
  goes_on(0);
  CHECK(outliers(figure(c, "resumed", "effects")).at("on") == true);
  CHECK(outliers(figure(c, "resumed", "effects")).at("mode") == "resumed");
  for (const auto& [key, wrong] : {std::pair("left_out", Json{"everything", 3}),
                                   {"left_out", Json(3)},
                                   {"effects", Json(3)},
                                   {"effects", Json{3, "mask-outliers=maybe", nullptr}}}) {
    run = as_decided;
    run[key] = wrong;
    goes_on(4);
  }
}

TEST_CASE("ngs-joint resumed removes the floaters that the interrupted run found under its budget") {
  const Case c;
  const Words options = kSteps + Words{"--effect", "floaters=on", "--checkpoint", c.keep};
  REQUIRE(c.joint("first", options + Words{"--checkpoint-every", "6"}).exit_code == 0);
  io::TensorFile file = io::read_safetensors(c.kept);
  auto run = nlohmann::ordered_json::parse(file.metadata.at("run"));
  REQUIRE(run.at("passes").at("floaters").at("draft") == false);
  run["passes"]["floaters"]["draft"] = true;
  file.metadata["run"] = run.dump();
  io::write_safetensors(c.kept, file);
  const test::ProcessResult resumed = test::succeeded(c.joint("resumed", options + Words{"--resume"}));
  CHECK(has_message(resumed, "resumed after step 6"));
  for (const Json& wrong :
       {Json(), Json(3), Json{{"draft", 1}, {"refit_epochs", 0}}, Json{{"draft", true}, {"refit_epochs", 1000000}}}) {
    run["passes"]["floaters"] = wrong;
    file.metadata["run"] = run.dump();
    io::write_safetensors(c.kept, file);
    CHECK(c.joint("other", options + Words{"--resume"}).exit_code == 4);
  }
}

}  // namespace ngs
