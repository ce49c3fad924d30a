#include "shared/run/line_program.h"

#include <doctest/doctest.h>

#include "ngs/core/error.h"
#include "ngs/core/monitor.h"
#include "support/process.h"

namespace ngs {
namespace {

using End = cli::ChildResult::End;

cli::LineProgram shell(const std::string& script) { return cli::LineProgram({"sh", "-c", script}); }

}  // namespace

TEST_CASE("one program answers every line with a line, and what does not begin as JSON is passed over") {
  cli::LineProgram program = shell("n=0; while read line; do n=$((n+1)); echo loading; echo \"{$n $line}\"; done");
  for (const std::string& text : std::vector<std::string>{"a", "b b", "c"}) {
    const cli::LineProgram::Answer answer = program.ask(text, {.time_s = 60});
    REQUIRE_FALSE(answer.ended);
    CHECK(answer.line == "{" + std::string(text == "a" ? "1" : text == "c" ? "3" : "2") + " " + text + "}");
  }
}

TEST_CASE("a program that ends instead of answering is known by its code and what it said, also when asked again") {
  cli::LineProgram program = shell("read line; echo no weights >&2; exit 3");
  const cli::LineProgram::Answer answer = program.ask("a", {.time_s = 60});
  REQUIRE(answer.ended);
  CHECK(answer.ended->end == End::kExited);
  CHECK(answer.ended->code == 3);
  CHECK(answer.ended->output_tail == "no weights");
  CHECK(program.ask("b", {.time_s = 60}).ended);
  cli::LineProgram killed = shell("kill -9 $$");
  const cli::LineProgram::Answer none = killed.ask(std::string(1 << 20, 'x'), {.time_s = 60});
  REQUIRE(none.ended);
  CHECK(none.ended->end == End::kSignalled);
  CHECK(none.ended->code == 9);
}

TEST_CASE("a program that does not answer is ended at the time limit and on a stop, with what it started") {
  for (const bool stops : {false, true}) {
    CAPTURE(stops);
    cli::LineProgram program = shell("trap '' TERM; sleep 50 & wait; sleep 50");
    const double start_s = wall_seconds();
    const cli::LineProgram::Answer answer =
        program.ask("a", {.time_s = stops ? 60 : 0.1, .stop = [&] { return stops; }, .patience_s = 0.1});
    REQUIRE(answer.ended);
    CHECK(answer.ended->end == (stops ? End::kStopped : End::kTimedOut));
    CHECK(wall_seconds() - start_s < 10);
  }
}

TEST_CASE("a line program that cannot be started, or that never ends its line, is refused") {
  const auto code_of = [](const auto& body) {
    try {
      body();
    } catch (const Error& e) {
      return e.code();
    }
    return ErrorCode::kNumeric;
  };
  if (!test::emulated())  // qemu-user starts it, and it ends with 127
    CHECK(code_of([] { cli::LineProgram({"no-such-program"}); }) == ErrorCode::kEnvironment);
  CHECK(code_of([] { shell("tr '\\0' x < /dev/zero").ask("a", {.time_s = 60}); }) == ErrorCode::kBadInput);
}

}  // namespace ngs
