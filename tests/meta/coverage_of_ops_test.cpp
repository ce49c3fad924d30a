#include <doctest/doctest.h>

#include <map>
#include <regex>
#include <set>

#include "support/process.h"
#include "support/source_tree.h"

namespace ngs {
namespace {

using test::SourceFile;

/// Headers that are parts of another op, whose gradient test covers them.
const std::map<std::string, std::string> kPartOf = {
    {"project", "splat"},        {"splat_engine", "splat"},    {"splat_tiles", "splat"}, {"splat_gaussian", "splat"},
    {"splat_backward", "splat"}, {"tile_kernels_of", "splat"}, {"tile_types", "splat"}};

/// "rbf" for libngs/ngs/ops/field/rbf_kernels.h
std::string family(const std::string& path) {
  const std::string stem =
      std::regex_replace(std::filesystem::path(path).stem().string(), std::regex("_(kernels|impl)$"), "");
  return kPartOf.count(stem) != 0 ? kPartOf.at(stem) : stem;
}

/// Device kernels contain no formulas; tests/parity compares their gradients with those of the op.
bool is_device_kernel(const std::string& path) {
  static const std::regex device(".*/ops/device/.*\\.h");
  return std::regex_match(path, device);
}

bool has_backward(const std::string& text) {
  return std::regex_search(text, std::regex("\\b\\w*([Bb]ackward|_gradient)\\w*\\s*[({]"));
}

}  // namespace

TEST_CASE("every op with a backward has a gradient test") {
  std::set<std::string> differentiable;
  for (const SourceFile& file : test::source_files({"libngs/ngs/ops"}, {".h"}))
    if (!is_device_kernel(file.path) && has_backward(file.text)) differentiable.insert(family(file.path));
  REQUIRE(differentiable.count("splat") == 1);
  REQUIRE(differentiable.count("rbf") == 1);
  for (const std::string& op : differentiable) {
    INFO(op);
    CHECK(std::filesystem::exists(std::string(NGS_SOURCE_DIR "/tests/grad/") + op + "_grad_test.cpp"));
  }
}

TEST_CASE("every entry of kPartOf names existing headers") {
  for (const auto& entry : kPartOf) {
    INFO(entry.first);
    const auto& [part, whole] = entry;
    const std::string folder = NGS_SOURCE_DIR "/libngs/ngs/ops/splat/";
    CHECK((std::filesystem::exists(folder + part + ".h") || std::filesystem::exists(folder + part + "_kernels.h")));
    CHECK(std::filesystem::exists(folder + whole + ".h"));
  }
}

TEST_CASE("every mutant still changes its source file") {
  const test::ProcessResult result =
      test::run_command({std::string(NGS_SOURCE_DIR) + "/tests/stability/mutants.sh", "--applies"});
  INFO(result.err);
  CHECK(result.out == "");
  CHECK(result.exit_code == 0);
}

}  // namespace ngs
