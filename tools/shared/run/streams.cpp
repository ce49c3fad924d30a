#include "shared/run/streams.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "ngs/core/error.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/os/output_file.h"
#include "shared/os/files.h"
#include "shared/os/machine.h"

namespace ngs::cli {
namespace {

/// A file with these bytes; it exists until the process ends.
std::string memory_file(std::string_view bytes) {
  const std::string path = os::file_of_bytes(bytes);
  if (path.empty()) throw Error(ErrorCode::kEnvironment, std::string("memory file: ") + std::strerror(errno));
  return path;
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
  std::string name = os::temporary_path("ngs-stdout-XXXXXX");
  if (!os::make_temporary_file(name))
    throw Error(ErrorCode::kEnvironment, name + ": cannot be created: " + std::strerror(errno), "set TMPDIR");
  output_ = name;
  unfinished_.track(output_.c_str());
  redirections_.push_back({"-", output_});
  output.path = output_;
}

Streams::~Streams() {
  if (to_stdout()) os::remove_file(output_.c_str());
}

void Streams::redirect_input(std::string& path, bool& stdin_taken) {
  const bool from_stdin = path == "-";
  if (from_stdin && stdin_taken) throw Error(ErrorCode::kUsage, "two inputs are '-', expected one at most");
  if (!from_stdin && !os::is_pipe(path)) return;
  stdin_taken |= from_stdin;
  const io::MappedFile bytes(from_stdin ? os::path_of_stdin() : path);
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
  for (std::string_view rest = bytes.text(); !rest.empty();) {
    const std::int64_t written = os::write_some(os::kStdout, rest.data(), rest.size());
    if (written < 0)
      throw Error(ErrorCode::kEnvironment, std::string("stdout: cannot be written: ") + std::strerror(errno));
    rest.remove_prefix(std::size_t(written));
  }
}

}  // namespace ngs::cli
