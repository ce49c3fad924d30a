// ngs-studio: a page on this machine in which a person marks an object on a splat, sees it found, corrects and cuts it.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "ngs/core/error.h"
#include "server.h"
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
    visit(self.port, Field<int>{"port", "", "of 127.0.0.1; 0: any that is free", 0, 65535});
    visit(self.browser, Flag{"browser", "open the page in the browser; else only its address is printed"});
  }
};

std::string default_folder(const std::string& source) {
  return std::filesystem::path(source).stem().stem().string() + "-studio";
}

void open_browser(cli::Run& run, const std::string& url) {
  try {
    if (cli::run_child({"xdg-open", url}, {.time_s = 10}).code == 0) return;
  } catch (const Error&) {
  }
  run.info("no browser could be opened");
}

int serve(cli::Run& run, const PageOptions& options, studio::Studio& studio) {
  studio::Server server(options.port, [&](const std::string& method, const std::string& path, const std::string& body) {
    return studio.answer(method, path, body);
  });
  server.start();
  std::fprintf(stderr, "ngs-studio: open %s (only on this machine; ends with Ctrl-C or in the page)\n",
               server.url().c_str());
  if (options.browser) open_browser(run, server.url());
  while (!run.monitor().stop_requested() && !studio.has_quit())
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // for the answer that is under way
  return run.stop_code();
}

}  // namespace

int main(int argc, char** argv) {
  cli::Tool tool("ngs-studio", "Mark, see, correct and cut objects of a splat in a page on this machine.",
                 {"ngs-studio statue.ply", "ngs-studio scene.json -o statue-studio --no-browser --port 8080"});
  PageOptions options;
  tool.options(options);
  const cli::Input& source = tool.input("source", "a splat (.ply, .spz, .sog, .splat, .ksplat), or a scene.json");
  const cli::Output& out = tool.resumed_output_dir("-o,--output", "folder for all that lasts; default: SOURCE-studio");
  tool.stops_on_request();

  return tool.run(argc, argv, [&](cli::Run& run) {
    studio::Studio studio(run.exec(), {source.path, out ? out.path : default_folder(source.path)});
    if (run.dry_run()) return int(cli::kDone);
    return serve(run, options, studio);
  });
}
