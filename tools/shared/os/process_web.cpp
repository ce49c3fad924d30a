// Programs are functions of the module: each runs to its end before start() returns.
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "shared/os/process.h"

/// Of Linux (files_posix.cpp): there is none.
extern "C" int memfd_create(const char*, unsigned) {
  errno = ENOSYS;
  return -1;
}

int ngs_extract_main(int argc, char** argv);  // the main() of a tool (tools/ngs-studio/web/CMakeLists.txt)

namespace ngs::os {
namespace {

void flush_streams() {
  std::cout.flush();
  std::cerr.flush();
  std::fflush(nullptr);
}

/// A standard stream that goes to another descriptor while this object lives.
class Redirected {
 public:
  Redirected(int stream, int to) : stream_(stream), before_(to < 0 ? -1 : ::dup(stream)) {
    if (before_ >= 0) ::dup2(to, stream);
  }
  ~Redirected() {
    if (before_ < 0) return;
    ::dup2(before_, stream_);
    ::close(before_);
  }
  Redirected(const Redirected&) = delete;
  Redirected& operator=(const Redirected&) = delete;

 private:
  int stream_, before_;
};

}  // namespace

Process::~Process() = default;

int Process::start(const std::vector<std::string>& argv, const Descriptors& descriptors) {
  if (std::filesystem::path(argv[0]).filename() != "ngs-extract") return ENOENT;
  std::vector<char*> words;
  for (const std::string& word : argv) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  ::umask(022);  // Emscripten begins with 0777
  flush_streams();
  const Redirected out(STDOUT_FILENO, descriptors.out), err(STDERR_FILENO, descriptors.err);
  group_ = ngs_extract_main(int(argv.size()), words.data());
  process_ = 1;
  flush_streams();
  return 0;
}

Process::Status Process::poll() { return {State::kExited, int(group_)}; }
void Process::request_end() const {}
void Process::kill() const {}
void Process::release() { process_ = 0; }

bool open_channels(Channels&) {
  errno = ENOSYS;
  return false;
}
std::int64_t send_some(int, const void*, std::size_t) { return -1; }
bool is_readable_within(int, int) { return true; }
std::int64_t read_some(int descriptor, void* to, std::size_t bytes) { return ::read(descriptor, to, bytes); }
int become(const std::vector<std::string>&) { return ENOSYS; }

}  // namespace ngs::os
