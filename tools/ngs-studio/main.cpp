// ngs-studio: a local web page to mark objects of a splat, check and correct the selection, and cut the objects out.
#include <chrono>
#include <filesystem>
#include <sstream>
#include <thread>

#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "server.h"
#include "shared/os/machine.h"
#include "shared/run/child_process.h"
#include "shared/tool.h"
#include "studio.h"

namespace {

using namespace ngs;

struct PageOptions {
  int port = 0;
  bool browser = true;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.port, Field<int>{"port", "", "Port on 127.0.0.1; 0: any free port", 0, 65535});
    visit(self.browser, Flag{"browser", "Open the page in the browser; off: only print its address"});
  }
};

std::string default_folder(const std::string& source) {
  return std::filesystem::path(source).stem().stem().string() + "-studio";
}

void open_browser(cli::Run& run, const std::string& url) {
  try {
    if (cli::run_child(os::browser_command(url), {.time_s = 10}).code == 0) return;
  } catch (const Error&) {
  }
  run.info("no browser could be opened");
}

void serve(cli::Run& run, const PageOptions& options, studio::Studio& studio, studio::Recorder& recorder) {
  studio::Server server(options.port, [&](const std::string& method, const std::string& path, const std::string& body) {
    return recorder.answer(method, path, body);
  });
  server.start();
  run.needed("open " + server.url() + "\n(serves this machine only; stop it with Ctrl-C)\n");
  if (options.browser) open_browser(run, server.url());
  while (!run.monitor().stop_requested() && !studio.has_quit())
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // lets the pending response finish
}

std::string table_of(const Json& log) {
  std::ostringstream text;
  const auto line = [&](const char* name, const Json& times) {
    if (times.at("n") == 0) return;
    text << name << times.at("n") << " responses, median " << times.at("median_ms") << " ms, 95th percentile "
         << times.at("p95_ms") << " ms; CPU time " << times.at("median_cpu_ms") << " and " << times.at("p95_cpu_ms")
         << " ms\n";
  };
  line("strokes        ", log.at("strokes"));
  line("  on a new view ", log.at("first"));
  line("  corrections   ", log.at("corrections"));
  line("frames, moving ", log.at("frames").at("moving"));
  line("frames, still  ", log.at("frames").at("still"));
  return text.str();
}

}  // namespace

int main(int argc, char** argv) {
  cli::Tool tool("ngs-studio", "Mark objects of a splat in the browser, correct the selection and cut them out.",
                 {"ngs-studio statue.ply", "ngs-studio scene.json -o statue-studio --no-browser --port 8080",
                  "ngs-studio statue.ply --replay statue-studio/visit.jsonl -o again"});
  PageOptions options;
  tool.options(options);
  const cli::Input& source = tool.input("source", "a splat (.ply, .spz, .sog, .splat, .ksplat, .glb), or a scene.json");
  const cli::Output& out = tool.resumed_output_dir("-o,--output", "folder of the session; default: SOURCE-studio");
  const cli::Output& record = tool.optional_output("--record", "write every request of the session as JSON lines");
  const cli::Input& visit =
      tool.optional_input("--replay", "repeat the requests of a recorded session, without a browser");
  tool.stops_on_request();

  return tool.run(argc, argv, [&](cli::Run& run) {
    if (visit) run.warn_unused({"--port", "--browser", "--record"}, "with --replay");
    if (run.dry_run()) return int(cli::kDone);
    os::set_variable("NGS_PROGRESS_S", "0.3", false);  // of the programs that Refine and Export run
    const studio::StudioPlace place{source.path, out ? out.path : default_folder(source.path), run.device_choice()};
    studio::Studio studio(run.exec(), place);
    if (visit) {
      const std::size_t requests =
          studio::replay(studio, visit.path,
                         {[&] { return run.monitor().stop_requested(); },
                          [&](std::int64_t done, std::int64_t total) { run.monitor().progress(done, total); }});
      run.result()["requests"] = requests;
    } else {
      studio::Recorder recorder(studio);
      serve(run, options, studio, recorder);
      if (record) io::write_file(record.path, recorder.lines());
    }
    run.result()["latency"] = studio.log();
    run.info("response times\n" + table_of(studio.log()));
    run.text("saved in " + std::filesystem::absolute(place.folder).lexically_normal().generic_string() + "\n");
    run.verbatim("continue with: " + cli::quoted_line({"ngs-studio", place.source, "-o", place.folder}) + "\n");
    return studio.has_quit() ? int(cli::kDone) : run.stop_code();
  });
}
