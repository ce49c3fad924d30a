#include "shared/run/child_process.h"

#include <doctest/doctest.h>

#include <csignal>

#include "ngs/core/error.h"
#include "ngs/core/monitor.h"
#include "support/error_code.h"
#include "support/process.h"
#include "support/skip.h"

namespace ngs {
namespace {

using Words = std::vector<std::string>;
using End = cli::ChildResult::End;
using test::code_of;

}  // namespace

TEST_CASE("a command line is split as a shell would, and nothing in it is run") {
  CHECK(cli::split_command("a b") == Words{"a", "b"});
  CHECK(cli::split_command("  a\t'b c'  \"d e\"f ''") == Words{"a", "b c", "d ef", ""});
  CHECK(cli::split_command("a\\ b \"c\\\"d\" 'e\\f'") == Words{"a b", "c\"d", "e\\f"});
  CHECK(cli::split_command("a; b | c && $(d) `e` > f") == Words{"a;", "b", "|", "c", "&&", "$(d)", "`e`", ">", "f"});
  for (const char* bad : {"", "   ", "a 'b", "a \"b", "a \\"}) {
    CAPTURE(bad);
    CHECK(code_of([&] { cli::split_command(bad); }) == ErrorCode::kUsage);
  }
}

TEST_CASE("placeholders are filled within words and once only") {
  CHECK(cli::fill_placeholders({"--i={a}", "{a}{b}", "{c}", "{", "}"}, {{"a", "{b} x"}, {"b", "y"}}) ==
        Words{"--i={b} x", "{b} xy", "{c}", "{", "}"});
}

TEST_CASE("a child is heard line by line while it runs") {
  Words heard;
  bool stop = false;
  const cli::ChildResult child =
      cli::run_child({"sh", "-c", "echo one; echo two >&2; printf half; sleep 50"}, {.stop = [&] { return stop; },
                                                                                     .on_line =
                                                                                         [&](const std::string& line) {
                                                                                           heard.push_back(line);
                                                                                           stop = heard.size() == 2;
                                                                                         }});
  CHECK(child.end == End::kStopped);
  CHECK(heard == Words{"one", "two"});
}

TEST_CASE("a child that ignores the request to end is killed after the grace period") {
  const double start_s = wall_seconds();
  bool stop = false;
  const cli::ChildResult child = cli::run_child(
      {"sh", "-c", "trap '' TERM; echo ready; while true; do sleep 0.05; done"},
      {.stop = [&] { return stop; }, .grace_on_stop_s = 0.2, .on_line = [&](const std::string&) { stop = true; }});
  CHECK(child.end == End::kStopped);
  CHECK(wall_seconds() - start_s < 10);  // a loaded machine; the default grace period alone is two seconds
}

TEST_CASE("a child's exit code or signal and the end of its output are returned") {
  const cli::ChildResult good = cli::run_child({"sh", "-c", "echo one; echo two >&2"}, {});
  CHECK(good.end == End::kExited);
  CHECK(good.code == 0);
  CHECK(good.output_tail == "one\ntwo");
  const cli::ChildResult bad = cli::run_child({"sh", "-c", "printf 'a\\033[31mb'; exit 7"}, {});
  CHECK(bad.code == 7);
  CHECK(bad.output_tail == "a?[31mb");
  const cli::ChildResult killed = cli::run_child({"sh", "-c", "kill -9 $$"}, {});
  CHECK(killed.end == End::kSignalled);
  CHECK(killed.code == 9);
  CHECK(cli::run_child({"sh", "-c", "head -c 100000 /dev/zero | tr '\\0' x"}, {}).output_tail.size() == 2000);
  CHECK(cli::run_child({"cat"}, {}).code == 0);  // stdin is empty
}

TEST_CASE("a child that is late or no longer wanted is ended with what it started") {
  const auto late = cli::run_child({"sh", "-c", "sleep 50 & sleep 50"}, {.time_s = 0.05});
  CHECK(late.end == End::kTimedOut);
  const auto unwanted = cli::run_child({"sleep", "50"}, {.time_s = 50, .stop = [] { return true; }});
  CHECK(unwanted.end == End::kStopped);
}

TEST_CASE("a child whose exit code is lost has not succeeded") {
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  CHECK(code_of([] { cli::run_child({"false"}, {}); }) == ErrorCode::kEnvironment);
  std::signal(SIGCHLD, before);
  CHECK(cli::run_child({"false"}, {}).code == 1);
}

TEST_CASE("a program that is not there is an error of the environment") {
  if (test::emulated()) return test::skip("qemu-user starts a program that is not there, which then ends with 127");
  CHECK(code_of([] { cli::run_child({"no-such-program-anywhere"}, {}); }) == ErrorCode::kEnvironment);
}

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
