#include <doctest/doctest.h>

#include "ngs/core/error.h"
#include "ngs/core/monitor.h"
#include "shared/run/child_process.h"
#include "support/error_code.h"
#include "support/process.h"

namespace ngs {
namespace {

using End = cli::ChildResult::End;

cli::LineProgram shell(const std::string& script) { return cli::LineProgram({"sh", "-c", script}); }

}  // namespace

TEST_CASE("a line program responds to every line with a line, and lines that do not begin as JSON are ignored") {
  cli::LineProgram program = shell("n=0; while read line; do n=$((n+1)); echo loading; echo \"{$n $line}\"; done");
  for (const std::string& text : std::vector<std::string>{"a", "b b", "c"}) {
    const cli::LineProgram::Response response = program.request(text, {.time_s = 60});
    REQUIRE_FALSE(response.ended);
    CHECK(response.line == "{" + std::string(text == "a" ? "1" : text == "c" ? "3" : "2") + " " + text + "}");
  }
}

TEST_CASE("a line program that ends instead of responding gives its code and its stderr, also at the next request") {
  cli::LineProgram program = shell("read line; echo no weights >&2; exit 3");
  const cli::LineProgram::Response response = program.request("a", {.time_s = 60});
  REQUIRE(response.ended);
  CHECK(response.ended->end == End::kExited);
  CHECK(response.ended->code == 3);
  CHECK(response.ended->output_tail == "no weights");
  CHECK(program.request("b", {.time_s = 60}).ended);
  cli::LineProgram killed = shell("kill -9 $$");
  const cli::LineProgram::Response none = killed.request(std::string(1 << 20, 'x'), {.time_s = 60});
  REQUIRE(none.ended);
  CHECK(none.ended->end == End::kSignalled);
  CHECK(none.ended->code == 9);
}

TEST_CASE("a program that does not respond is ended at the time limit and on a stop, with what it started") {
  for (const bool stops : {false, true}) {
    CAPTURE(stops);
    cli::LineProgram program = shell("trap '' TERM; sleep 50 & wait; sleep 50");
    const double start_s = wall_seconds();
    const cli::LineProgram::Response response =
        program.request("a", {.time_s = stops ? 60 : 0.1, .stop = [&] { return stops; }, .grace_s = 0.1});
    REQUIRE(response.ended);
    CHECK(response.ended->end == (stops ? End::kStopped : End::kTimedOut));
    CHECK(wall_seconds() - start_s < 10);
  }
}

TEST_CASE("a line program that cannot be started, or that never ends its line, is refused") {
  using test::code_of;
  if (!test::emulated())  // qemu-user starts it, and it ends with 127
    CHECK(code_of([] { cli::LineProgram({"no-such-program"}); }) == ErrorCode::kEnvironment);
  CHECK(code_of([] { shell("tr '\\0' x < /dev/zero").request("a", {.time_s = 60}); }) == ErrorCode::kBadInput);
}

}  // namespace ngs
