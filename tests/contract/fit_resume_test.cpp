// A fit resumed from a checkpoint equals a fit that was never interrupted.
#include <doctest/doctest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>

#include "ngs/io/files/safetensors.h"
#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

test::ProcessSpec fit_spec(const std::string& out, const std::vector<std::string>& more, bool interrupt) {
  const test::Words run{"ngs-fit", test::fixture_folder() + "/scene.json", "-o", out};
  const test::Words options = test::split("--steps 800 --random-points 60 --max-gaussians 90 --sh-degree 1");
  test::ProcessSpec spec = test::command(test::joined(test::joined(run, options), more));
  if (interrupt) {
    spec.signal = SIGTERM;
    spec.signal_after = "random Gaussians";
  }
  return spec;
}

test::ProcessResult fit(const std::string& out, const std::vector<std::string>& more, bool interrupt) {
  return test::run_process(fit_spec(out, more, interrupt));
}

/// Disk space for the model of 90 Gaussians, but not for the checkpoint, which also has the Adam moments.
test::ProcessResult fit_on_full_disk(const std::string& out, const std::vector<std::string>& more) {
  return test::run_process(test::with_files_of_at_most(16, fit_spec(out, more, false)));
}

}  // namespace

TEST_CASE("ngs-fit stopped by SIGTERM and resumed writes the bytes of an uninterrupted run") {
  const test::TempDir dir;
  const std::string whole = dir.path() + "/whole.ply", resumed = dir.path() + "/resumed.ply",
                    keep = dir.path() + "/keep";
  REQUIRE(fit(whole, {}, false).exit_code == 0);
  REQUIRE(fit(resumed, {"--checkpoint", keep}, true).exit_code == 128 + SIGTERM);
  CHECK_FALSE(std::filesystem::exists(resumed));
  // A run with other options does not resume from it.
  CHECK(fit(resumed, {"--checkpoint", keep, "--resume", "--background", "1,1,1"}, false).exit_code == 4);
  REQUIRE(fit(resumed, {"--checkpoint", keep, "--resume"}, false).exit_code == 0);
  CHECK(test::read_bytes(resumed) == test::read_bytes(whole));
}

TEST_CASE(
    "ngs-fit without disk space for a checkpoint writes its model, warns once, and keeps the previous checkpoint") {
  const test::TempDir dir;
  const std::string whole = dir.path() + "/whole.ply", model = dir.path() + "/m.ply", keep = dir.path() + "/keep",
                    kept = keep + "/fit.safetensors";
  REQUIRE(fit(whole, {}, false).exit_code == 0);
  const test::ProcessResult result =
      test::succeeded(fit_on_full_disk(model, {"--checkpoint", keep, "--checkpoint-every", "300"}));
  CHECK(test::read_bytes(model) == test::read_bytes(whole));
  CHECK(test::occurrences(result.err, "the checkpoint was not written") == 1);
  CHECK(test::occurrences(result.err, "fit.safetensors: writing failed") == 1);
  CHECK(std::filesystem::is_empty(keep));

  REQUIRE(fit(model, {"-w", "--checkpoint", keep, "--checkpoint-every", "300"}, false).exit_code == 0);
  const std::string before = test::read_bytes(kept);
  REQUIRE(fit_on_full_disk(model, {"-w", "--checkpoint", keep, "--checkpoint-every", "300"}).exit_code == 0);
  CHECK(test::read_bytes(kept) == before);
}

TEST_CASE("ngs-fit stopped without disk space for a checkpoint returns an error") {
  const test::TempDir dir;
  // At the first step the checkpoint is not larger than the model.
  test::refused(test::run_process(test::with_files_of_at_most(
                    1, fit_spec(dir.path() + "/m.ply", {"--checkpoint", dir.path() + "/keep"}, true))),
                8, "fit.safetensors: writing failed");
  CHECK_FALSE(std::filesystem::exists(dir.path() + "/m.ply"));
}

TEST_CASE("ngs-fit resumes with a copy of its files, but not with a different photo or different points") {
  const test::TempDir dir;
  const std::string scene = dir.path() + "/scene";
  std::filesystem::copy(test::fixture_folder(), scene, std::filesystem::copy_options::recursive);
  const auto points_fit = [&](const std::string& folder, const std::vector<std::string>& more) {
    const test::Words options = test::split("--points points3D.txt -o m.ply -w --steps 4 --checkpoint keep");
    return test::run_tool(test::joined(test::joined({"ngs-fit", folder + "/scene.json"}, options), more), dir.path());
  };
  const std::string points = "1 0 0 2 200 40 40 0\n2 0.5 0 2 40 200 40 0\n3 0 0.5 2.5 40 40 200 0\n";
  dir.write("points3D.txt", points);
  REQUIRE(points_fit(test::fixture_folder(), {}).exit_code == 0);
  REQUIRE(points_fit(scene, {"--resume"}).exit_code == 0);
  const std::pair<std::string, std::string> others[] = {
      {"scene/images/v1.png", test::read_bytes(scene + "/images/v2.png")},
      {"points3D.txt", points + "4 0 0 1.5 9 9 9 0\n"}};
  for (const auto& [name, bytes] : others) {
    const std::string& file = name;
    const std::string before = test::read_bytes(dir.path() + "/" + file);
    dir.write(file, bytes);
    CAPTURE(file);
    test::refused(points_fit(scene, {"--resume"}), 4, "expected the same options, seed, views, photos and points");
    dir.write(file, before);
  }
  CHECK(points_fit(scene, {"--resume"}).exit_code == 0);
}

TEST_CASE("ngs-fit rejects a checkpoint with a step beyond the last or with values that are not finite") {
  const test::TempDir dir;
  const std::string model = dir.path() + "/m.ply", keep = dir.path() + "/keep", kept = keep + "/fit.safetensors";
  REQUIRE(fit(model, {"--checkpoint", keep}, false).exit_code == 0);
  std::filesystem::remove(model);
  const io::TensorFile whole = io::read_safetensors(kept);
  for (const std::string name : {"step", "position", "sh_dc.v", "gradient_sum"}) {
    io::TensorFile forged = whole;
    for (io::Tensor& tensor : forged.tensors)
      if (tensor.name == name)
        std::fill(tensor.bytes.begin(), tensor.bytes.begin() + 4,
                  name == "step" ? std::uint8_t(0x01) : std::uint8_t(0xff));
    io::write_safetensors(kept, forged);
    CAPTURE(name);
    test::refused(fit(model, {"--checkpoint", keep, "--resume"}, false), 3,
                  name == "step" ? "step 16843009 of 800" : name + " has a value that is not finite");
    CHECK_FALSE(std::filesystem::exists(model));
  }
}

}  // namespace ngs
