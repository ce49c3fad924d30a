#pragma once
// "-" for an input is stdin, for an output stdout. Tools read and write paths only: what comes through a pipe
// ("-", a FIFO, <(command)) is taken up whole into memory and given to them as a path, so that it can be
// hashed, mapped and read twice; what goes to stdout is written to a temporary file first, so that a failed
// run writes nothing.
#include <string>
#include <vector>

#include "ngs/io/files/unfinished_files.h"
#include "shared/cli/spec.h"

namespace ngs::cli {

/// kEnvironment where stdout takes no more.
void print(const std::string& text);
void print_json(const Json& json);
/// As every JSON document of a tool is written.
std::string json_document(const Json& json);

class Streams {
 public:
  /// Redirects the paths of `spec`. kUsage if two inputs or two outputs are "-", or a folder is.
  explicit Streams(Spec& spec);
  ~Streams();
  Streams(const Streams&) = delete;
  Streams& operator=(const Streams&) = delete;

  /// The path as the command line has it, for reports.
  std::string given(const std::string& path) const;
  bool to_stdout() const { return !output_.empty(); }
  /// The output that is "-", copied to stdout. kEnvironment if that fails.
  void copy_output() const;

 private:
  void take_up(std::string& path, bool& stdin_taken);
  void take_over(Output& output);

  struct Redirection {
    std::string given, path;
  };
  std::vector<Redirection> redirections_;
  std::string output_;  // the temporary file
  io::UnfinishedFile unfinished_;
};

}  // namespace ngs::cli
