#include "shared/run/streams.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/io/files/mapped_file.h"

namespace ngs::cli {
namespace {

void write_all(int descriptor, const char* data, std::size_t bytes, const char* name) {
  while (bytes > 0) {
    const ssize_t written = ::write(descriptor, data, bytes);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0)
      throw Error(ErrorCode::kEnvironment, std::string(name) + ": cannot be written: " + std::strerror(errno));
    data += written;
    bytes -= std::size_t(written);
  }
}

/// An unnamed file in memory with these bytes; it exists until the process ends.
std::string memory_file(std::string_view bytes) {
  const int descriptor = memfd_create("ngs", MFD_CLOEXEC);
  if (descriptor < 0) throw Error(ErrorCode::kEnvironment, std::string("memfd: ") + std::strerror(errno));
  write_all(descriptor, bytes.data(), bytes.size(), "memory");
  return "/proc/self/fd/" + std::to_string(descriptor);
}

bool is_pipe(const std::string& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 && (S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode));
}

}  // namespace

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw Error(ErrorCode::kEnvironment, "stdout: cannot be written");
}

std::string json_document(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }
void print_json(const Json& json) { print(json_document(json)); }

Streams::Streams(Spec& spec) {
  bool stdin_taken = false;
  for (Input& input : spec.inputs) redirect_input(input.path, stdin_taken);
  for (Inputs& list : spec.input_lists)
    for (std::string& path : list.paths) redirect_input(path, stdin_taken);
  for (Output& output : spec.outputs)
    if (output.path == "-") redirect_output(output);
}

void Streams::redirect_output(Output& output) {
  if (output.directory || to_stdout())
    throw Error(ErrorCode::kUsage,
                output.flags + ": '-', expected a " + (output.directory ? "folder" : "path: one output can be stdout"));
  std::string name = (std::filesystem::temp_directory_path() / "ngs-stdout-XXXXXX").string();
  const int descriptor = mkstemp(name.data());
  if (descriptor < 0)
    throw Error(ErrorCode::kEnvironment, name + ": cannot be created: " + std::strerror(errno), "set TMPDIR");
  ::close(descriptor);
  output_ = name;
  unfinished_.track(output_.c_str());
  redirections_.push_back({"-", output_});
  output.path = output_;
}

Streams::~Streams() {
  if (to_stdout()) ::unlink(output_.c_str());
}

void Streams::redirect_input(std::string& path, bool& stdin_taken) {
  const bool from_stdin = path == "-";
  if (from_stdin && stdin_taken) throw Error(ErrorCode::kUsage, "two inputs are '-', expected one at most");
  if (!from_stdin && !is_pipe(path)) return;
  stdin_taken |= from_stdin;
  const io::MappedFile bytes(from_stdin ? "/dev/stdin" : path);
  redirections_.push_back({path, memory_file(bytes.text())});
  path = redirections_.back().path;
}

std::string Streams::given(const std::string& path) const {
  for (const Redirection& redirection : redirections_)
    if (redirection.path == path) return redirection.given;
  return path;
}

void Streams::copy_output() const {
  if (!to_stdout()) return;
  const io::MappedFile bytes(output_);
  write_all(STDOUT_FILENO, bytes.text().data(), bytes.text().size(), "stdout");
}

}  // namespace ngs::cli
