// The studio as a module of a page: the requests of data-schema/studio-protocol.md, answered without a server.
#include <emscripten/heap.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "shared/os/machine.h"
#include "studio.h"

namespace {

using namespace ngs;

struct Module {
  std::unique_ptr<studio::Studio> studio;
  studio::Reply reply;  // the last one
  std::string head;     // of the reply: its type and headers, as JSON
};

Module& module() {
  static Module only;
  return only;
}

int keep(studio::Reply reply) {
  studio::Json headers{{"Content-Type", reply.type}};
  for (const auto& [name, value] : reply.headers) headers[name] = value;
  module().head = headers.dump();
  module().reply = std::move(reply);
  return module().reply.status;
}

/// Creates an empty file per program, so that the tools find the programs; these are functions of the module.
void announce_programs() {
  namespace fs = std::filesystem;
  fs::create_directories("/bin");
  for (const char* program : {"/bin/ngs-studio", "/bin/ngs-extract"}) {
    std::ofstream(program).flush();
    fs::permissions(program, fs::perms::owner_all);
  }
}

/// Throws if the open splat uses over 2 of the module's 4 GiB: an export needs about as much again.
void require_room(const std::string& source) {
  constexpr double kGiB = double(1 << 30), kMost_GiB = 2;
  const double used_GiB = double(emscripten_get_heap_size()) / kGiB;
  if (used_GiB <= kMost_GiB) return;
  char found[64];
  std::snprintf(found, sizeof found, "%.1f GiB of memory when it is open", used_GiB);
  module().studio = nullptr;
  throw studio::Refusal(507, source, found, "at most 2 GiB in a browser, so that Export has room",
                        "open it with ngs-studio; for another file, reload the page");
}

}  // namespace

extern "C" {

/// Opens a splat of the module's file system, for the requests that follow. Returns the status of the reply.
int ngs_open(const char* source) {
  return keep(studio::reply_of([&]() -> studio::Reply {
    announce_programs();
    module().studio = nullptr;
    const studio::StudioPlace place{.source = source,
                                    .folder = std::filesystem::path(source).stem().stem().string() + "-studio",
                                    .device = cli::DeviceChoice::kCpu,
                                    .without_programs = true};
    module().studio = std::make_unique<studio::Studio>(Exec{.threads = os::processor_count()}, place);
    require_room(source);
    return {};
  }));
}

int ngs_answer(const char* method, const char* path, const char* body) {
  if (!module().studio)
    return keep(studio::reply_of(studio::Refusal(409, "studio", "no splat is open", "a splat", "choose a file")));
  return keep(module().studio->answer(method, path, body));
}

// The last reply.
int ngs_status() { return module().reply.status; }
const char* ngs_head() { return module().head.c_str(); }
const char* ngs_body() { return module().reply.body.data(); }
int ngs_body_bytes() { return int(module().reply.body.size()); }

}  // extern "C"
