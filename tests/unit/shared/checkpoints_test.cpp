#include "shared/run/checkpoints.h"

#include <doctest/doctest.h>

#include "ngs/core/error.h"

namespace ngs {

TEST_CASE("a state that is kept already is not written again when the run stops") {
  Monitor monitor;
  cli::Checkpoints checkpoints(monitor);
  int written = 0;
  const auto write = [&] { ++written; };
  const auto fail = [] { throw Error(ErrorCode::kEnvironment, "disk: full, expected room"); };

  checkpoints.write_during_run(5, write);
  checkpoints.write_on_stop(5, write);
  CHECK(written == 1);
  checkpoints.write_on_stop(6, write);
  CHECK(written == 2);
  checkpoints.write_on_stop(6, write);
  CHECK(written == 2);

  SUBCASE("one that could not be written is tried again, and its failure is told") {
    checkpoints.write_during_run(10, fail);
    CHECK_THROWS_AS(checkpoints.write_on_stop(10, fail), Error);
    checkpoints.write_on_stop(10, write);
    CHECK(written == 3);
  }
}

}  // namespace ngs
