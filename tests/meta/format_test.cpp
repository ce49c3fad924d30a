// The tree is formatted by .clang-format, so that running the formatter shows only own changes.
#include <doctest/doctest.h>

#include "support/process.h"
#include "support/skip.h"
#include "support/source_tree.h"

namespace ngs {
namespace {

/// Other versions break lines differently.
constexpr const char* kVersion = "version 14.";

}  // namespace

TEST_CASE("every source file is formatted as .clang-format requires") {
  const test::ProcessResult version = test::run_command({"/usr/bin/env", "clang-format", "--version"});
  if (version.exit_code != 0) return test::skip("clang-format is not installed");
  if (version.out.find(kVersion) == std::string::npos)
    return test::skip("expected clang-format " + std::string(kVersion) + "x, found " + version.out);
  test::ProcessSpec check;
  check.argv = {"/usr/bin/env", "clang-format", "--dry-run", "--Werror"}, check.folder = NGS_SOURCE_DIR;
  const std::vector<test::SourceFile> files =
      test::source_files({"libngs", "tools", "tests"}, {".h", ".cpp", ".cu", ".cuh"});
  for (const test::SourceFile& file : files) check.argv.push_back(file.path);
  const test::ProcessResult result = test::run_process(check);
  CAPTURE(result.err);
  CHECK(result.exit_code == 0);
  CHECK(files.size() > 800);
}

}  // namespace ngs
