// The Windows side of the operating-system code, run under Wine by tests/ci/windows.sh. The program is also its own
// child: "child WHAT ARGUMENTS...".
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <thread>

#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/os/process_usage.h"
#include "shared/os/files.h"
#include "shared/os/machine.h"
#include "shared/run/child_process.h"
#include "shared/run/signals.h"
#include "support/error_code.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using End = cli::ChildResult::End;
using test::code_of;
const std::string kOdd = "\xC3\xA4 \xE8\xAF\xAD\xF0\x9F\x98\x80";  // an umlaut, a Chinese character, one beyond 16 bits

std::vector<std::string> child(const std::string& what, const std::vector<std::string>& arguments = {}) {
  std::vector<std::string> argv{os::path_of_this_program(), "child", what};
  argv.insert(argv.end(), arguments.begin(), arguments.end());
  return argv;
}

void say(const char* text) {
  std::puts(text);
  std::fflush(stdout);
}

int answer_lines() {
  for (std::string line; std::getline(std::cin, line);) {
    if (line == "end") return 3;
    say(("noise\n{\"got\": \"" + line + "\"}").c_str());
  }
  return 0;
}

int wait_for_stop(bool listens) {
  cli::install_signal_handlers(true);
  say("ready");
  for (int i = 0; i < 2000 && !(listens && cli::stop_flag()); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  cli::cancel_grace_timer();
  return cli::signal_exit_code();
}

int run_as_child(const std::string& what, const std::vector<std::string>& arguments) {
  if (what == "echo") {
    for (const std::string& argument : arguments) say(("[" + argument + "]").c_str());
    return 5;
  }
  if (what == "lines") return answer_lines();
  if (what == "waits") return wait_for_stop(true);
  if (what == "deaf") return wait_for_stop(false);
  if (what == "fault") *static_cast<volatile int*>(nullptr) = 1;
  return 9;
}

struct Folder {
  std::string path = (fs::temp_directory_path() / ("ngs " + kOdd + "-XXXXXX")).generic_string();
  Folder() { REQUIRE(os::make_temporary_folder(path)); }
  ~Folder() { fs::remove_all(path); }
};

}  // namespace

TEST_CASE("a child receives every argument unchanged, and its exit code and output come back") {
  const std::string quotes = "a \"b\" \\ c\\\\\"d\\";
  const cli::ChildResult result = cli::run_child(child("echo", {"x y", quotes, kOdd, "", "tail\\ "}), {});
  CHECK(result.end == End::kExited);
  CHECK(result.code == 5);
  CHECK(result.output_tail == "[x y]\n[" + quotes + "]\n[" + kOdd + "]\n[]\n[tail\\ ]");
}

TEST_CASE("a child stops on request, one that does not listen after the grace period, and one that is late is killed") {
  for (const char* what : {"waits", "deaf"}) {
    CAPTURE(what);
    bool is_ready = false;
    const cli::ChildResult result =
        cli::run_child(child(what), {.stop = [&] { return is_ready; },
                                     .grace_on_stop_s = 8,
                                     .on_line = [&](const std::string& line) { is_ready |= line == "ready"; }});
    CHECK(result.end == End::kStopped);
    CHECK(result.code == 143);
  }
  CHECK(cli::run_child(child("deaf"), {.time_s = 0.1, .grace_s = 0}).end == End::kTimedOut);
}

TEST_CASE("a crash of a child is told from an exit, and a program that does not exist is an error") {
  CHECK(cli::run_child(child("fault"), {}).end == End::kSignalled);
  CHECK(code_of([] { cli::run_child({"no-such-program"}, {}); }) == ErrorCode::kEnvironment);
}

TEST_CASE("a program of lines answers each line, and its end is reported") {
  cli::LineProgram program(child("lines"));
  CHECK(program.request(kOdd, {}).line == "{\"got\": \"" + kOdd + "\"}");
  const cli::LineProgram::Response last = program.request("end", {});
  REQUIRE(last.ended);
  CHECK(last.ended->code == 3);
}

TEST_CASE("an output replaces a file at once, or leaves it, and its bytes are read by maps and streams") {
  const Folder folder;
  const std::string path = folder.path + "/" + kOdd + ".txt";
  io::write_file(path, "one\ntwo\n");
  const os::FileVersion first = os::version_of_file(path);
  io::write_file(path, "three\n");
  CHECK(first != os::version_of_file(path));
  { io::AtomicFile(path).write("lost"); }
  const io::MappedFile map(path);
  map.forget_pages();
  CHECK(map.text() == "three\n");
  std::ofstream(folder.path + "/stream.txt") << "a\nb\n";
  CHECK(fs::file_size(folder.path + "/stream.txt") == 4);
  CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()) == 2);
}

TEST_CASE("folders and missing files are errors with their reason") {
  const Folder folder;
  CHECK(code_of([&] { io::write_file(folder.path, "x"); }) == ErrorCode::kEnvironment);
  CHECK(code_of([&] { io::write_file(folder.path + "/none/x", "x"); }) == ErrorCode::kEnvironment);
  CHECK(code_of([&] { io::MappedFile file(folder.path); }) == ErrorCode::kBadInput);
  CHECK(code_of([&] { io::MappedFile file(folder.path + "/none"); }) == ErrorCode::kBadInput);
  CHECK(os::version_of_file(folder.path).inode == 0);
}

TEST_CASE("bytes of a stream become a file, and the process knows its processors, time and memory") {
  CHECK(io::MappedFile(os::file_of_bytes("abc")).text() == "abc");
  CHECK(os::processor_count() >= 1);
  CHECK(os::cpu_seconds() > 0);
  CHECK(os::peak_rss_mib() > 1);
}

}  // namespace ngs

int main(int argc, char** argv) {
  if (argc > 2 && std::string(argv[1]) == "child") return ngs::run_as_child(argv[2], {argv + 3, argv + argc});
  return doctest::Context(argc, argv).run();
}
