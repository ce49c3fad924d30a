#pragma once
// "-" is stdin for an input and stdout for an output. Tools read and write paths only. A piped input ("-", a FIFO,
// <(command)) is read into memory and replaced by a path, so that it can be hashed, mapped and read twice. An output to
// stdout is written to a temporary file first, so that a failed run writes nothing.
#include <string>
#include <vector>

#include "ngs/io/files/atomic_file.h"
#include "shared/cli/spec.h"

namespace ngs::cli {

/// Throws kEnvironment if stdout cannot be written.
void print(const std::string& text);
void print_json(const Json& json);
/// The text of a JSON document: indented, with a final newline.
std::string json_document(const Json& json);

class Streams {
 public:
  /// Redirects the paths of `spec`. Throws kUsage if two inputs, two outputs or a folder are "-".
  explicit Streams(Spec& spec);
  ~Streams();
  Streams(const Streams&) = delete;
  Streams& operator=(const Streams&) = delete;

  /// The path as given on the command line, for reports.
  std::string given(const std::string& path) const;
  bool to_stdout() const { return !output_.empty(); }
  /// Copies the output whose path is "-" to stdout. Throws kEnvironment if that fails.
  void copy_output() const;

 private:
  void redirect_input(std::string& path, bool& stdin_taken);
  void redirect_output(Output& output);

  struct Redirection {
    std::string given, path;
  };
  std::vector<Redirection> redirections_;
  std::string output_;  // the temporary file
  io::UnfinishedFile unfinished_;
};

}  // namespace ngs::cli
