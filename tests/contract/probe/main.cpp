// ngs-probe: a tool for the contract tests only. It tests the rules of all tools without the work of a real one.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <thread>

#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "shared/run/signals.h"
#include "shared/tool.h"

namespace {

using namespace ngs;

enum class Act {
  kWrite,
  kSlowWrite,
  kCheckFails,
  kEmpty,
  kNumeric,
  kNoMemory,
  kBug,
  kPoll,
  kDeaf,
  kKeep,
  kProgress,
  kEcho
};
constexpr NamedValue<Act> kActs[] = {{Act::kWrite, "write"},       {Act::kSlowWrite, "slow-write"},
                                     {Act::kCheckFails, "check"},  {Act::kEmpty, "empty"},
                                     {Act::kNumeric, "numeric"},   {Act::kNoMemory, "no-memory"},
                                     {Act::kBug, "bug"},           {Act::kPoll, "poll"},
                                     {Act::kDeaf, "deaf"},         {Act::kKeep, "keep"},
                                     {Act::kProgress, "progress"}, {Act::kEcho, "echo"}};

struct ProbeOptions {
  Act act = Act::kWrite;
  int count = 3;
  double width = 0.5;
  bool fast = true;
  std::vector<std::string> names;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.act, Choice<Act>{"act", "what to do", kActs});
    visit(self.count, Field<int>{"count", "", "lines to write", 0, 1000});
    visit(self.width, Field<double>{"line_width", "px", "written", 0, 10}.of("wide"));
    visit(self.fast, Flag{"fast", "written"});
    visit(self.names, Text{"names", "NAME", "written"});
  }
};

struct EchoOptions {
  int times = 1;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.times, Field<int>{"times", "", "echoes", 1, 9}.of("loud|far"));
  }
};

/// Two stages with progress, and a warning in the first.
void show_progress(cli::Run& run, int count) {
  // longer than the interval between two updates of the line
  const auto nap = [] { std::this_thread::sleep_for(std::chrono::milliseconds(120)); };
  for (const char* stage : {"work", "rest"}) {
    const auto timed = run.monitor().scope(stage);
    nap();
    run.monitor().progress(1, count);
    if (stage == std::string_view("rest")) break;
    run.monitor().warn("half of it");
    nap();
    run.monitor().progress(2, count);
  }
}

/// Works for longer than the grace period after a signal.
void work_deaf() {
  std::fprintf(stderr, "hears nothing\n");
  std::this_thread::sleep_for(std::chrono::seconds(20));
}

/// Takes longer than the grace period to write its state, then ignores stop requests.
void keep_state(cli::Run& run, const std::string& path) {
  {
    const cli::SignalGrace keeps;
    std::fprintf(stderr, "keeps a state\n");
    while (!run.monitor().stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::this_thread::sleep_for(std::chrono::milliseconds(900));
    io::write_file(path, "state\n");
  }
  work_deaf();
}

int act(cli::Run& run, const ProbeOptions& options, const std::string& path) {
  const auto nap = [] { std::this_thread::sleep_for(std::chrono::milliseconds(20)); };
  if (options.act == Act::kEmpty) run.nothing_found("probe: nothing there", "look elsewhere");
  if (options.act == Act::kNumeric) throw Error(ErrorCode::kNumeric, "row 3: nan, expected finite");
  if (options.act == Act::kNoMemory) throw std::bad_alloc();
  if (options.act == Act::kBug) throw std::logic_error("probe");
  if (options.act == Act::kProgress) show_progress(run, options.count);
  while (options.act == Act::kPoll && !run.monitor().stop_requested()) nap();
  if (options.act == Act::kPoll) return run.stop_code();
  if (options.act == Act::kDeaf) work_deaf();
  if (options.act == Act::kKeep) keep_state(run, path + ".kept");
  io::AtomicFile file(path);
  for (int i = 0; i < options.count; ++i) {
    file.write("line\n");
    if (options.act == Act::kSlowWrite) {
      std::fprintf(stderr, "line %d is written\n", i);
      nap();
    }
  }
  for (const std::string& name : options.names) file.write(name + "\n");
  file.commit();
  run.result()["lines"] = options.count;
  return options.act == Act::kCheckFails ? cli::kCheckFailed : cli::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  cli::Tool tool("ngs-probe", "Do what a test asks.",
                 {"ngs-probe in.txt -o out.txt", "ngs-probe in.txt -o out.txt --count 5"});
  ProbeOptions options;
  EchoOptions echo;
  tool.options(options);
  tool.options(echo, {.name = "echo",
                      .prefix = "echo_",
                      .applies = [&options] { return options.act == Act::kEcho; },
                      .needs = "--act echo"});
  const cli::Input& in = tool.input("text", "any file");
  const cli::Input& more = tool.optional_input("--more", "any file or folder");
  const cli::Output& out = tool.output("-o,--output", "lines");
  if (const std::string last = argv[std::max(argc, 1) - 1];
      last == "--act=poll" || last == "--act=deaf" || last == "--act=keep")
    tool.stops_on_request();
  return tool.run(argc, argv, [&](cli::Run& run) {
    run.warn_unused([](std::string_view effect) { return effect == "far"; });
    run.result()["input"] = in.path;
    run.result()["more"] = more.path;
    if (run.dry_run()) {
      run.plan({{"lines", options.count}});
      return cli::kDone;
    }
    return act(run, options, out.path);
  });
}
