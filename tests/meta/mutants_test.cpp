// The list of mutants ages with the code: one that no longer breaks anything proves nothing.
#include <doctest/doctest.h>

#include "support/process.h"
#include "support/source_tree.h"

namespace ngs {

TEST_CASE("every mutant still changes the file that it breaks") {
  const test::ProcessResult result =
      test::run_command({std::string(NGS_SOURCE_DIR) + "/tests/stability/mutants.sh", "--applies"});
  INFO(result.err);
  CHECK(result.out == "");
  CHECK(result.exit_code == 0);
}

}  // namespace ngs
