// ngs-joint with a --field of a boundary set from which the components pass removes Gaussians.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/ply/query_ply.h"
#include "support/process.h"
#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

/// A copy of the fixture's boundary.ply in which a boundary Gaussian used by the field lies far away, outside all
/// views.
std::string with_a_component(const test::TempDir& dir) {
  const std::string source = test::fixture_folder() + "/boundary.ply", copy = dir.path() + "/stray.ply";
  const io::GaussianPly ply = io::read_gaussian_ply(source);
  const auto row = std::int64_t(io::read_query_ply(test::fixture_folder() + "/field.ply").neighbour.front());
  REQUIRE(ply.labels.boundary[std::size_t(row)] > 0);
  std::filesystem::copy_file(source, copy);
  std::fstream file(copy, std::ios::binary | std::ios::in | std::ios::out);
  const auto table_begin = std::filesystem::file_size(source) - std::size_t(ply.rows.rows) * ply.rows.row_bytes;
  const auto set = [&](const char* name, float value) {
    const int property = ply.rows.find(name);
    REQUIRE(property >= 0);
    file.seekp(
        std::streamoff(table_begin + std::size_t(row) * ply.rows.row_bytes + ply.rows.offset[std::size_t(property)]));
    file.write(reinterpret_cast<const char*>(&value), sizeof value);
  };
  set("x", 40.f);
  set("ngs_views", 0.f);
  set("ngs_prob", 1.f);
  return copy;
}

}  // namespace

TEST_CASE("ngs-joint samples again if removed components shrink the boundary set of --field") {
  const test::TempDir dir;
  const std::string fixture = test::fixture_folder(), model = with_a_component(dir), out = dir.path() + "/labelled.ply";
  const test::ProcessResult result = test::succeeded(
      test::run_command({NGS_TOOL_DIR "/ngs-joint", fixture + "/scene.json", model, "--field", fixture + "/field.ply",
                         "--steps", "2", "--mlp-hidden", "16", "--effect", "nerf=on", "-v", "-o", out}));
  CHECK(result.err.find("treated as unseen") != std::string::npos);
  CHECK(std::filesystem::exists(out));
}

}  // namespace ngs
