// Mutants are sed patterns on source lines: a pattern that no longer matches tests nothing.
#include <doctest/doctest.h>

#include "support/process.h"
#include "support/source_tree.h"

namespace ngs {

TEST_CASE("every mutant still changes its source file") {
  const test::ProcessResult result =
      test::run_command({std::string(NGS_SOURCE_DIR) + "/tests/stability/mutants.sh", "--applies"});
  INFO(result.err);
  CHECK(result.out == "");
  CHECK(result.exit_code == 0);
}

}  // namespace ngs
