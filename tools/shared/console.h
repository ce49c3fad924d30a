#pragma once
// stderr: messages and progress for people, or JSON lines. stdout is data and no business of this file.
#include <string>
#include <string_view>

#include "shared/spec.h"

namespace ngs::cli {

class Console {
 public:
  Console(std::string tool, LogLevel level, LogFormat format);

  void error(const std::string& message, const std::string& remedy);
  void warning(const std::string& message);
  void info(const std::string& message);
  /// A table or another text of several lines for people, as it is; silent with -q.
  void text(const std::string& lines);
  /// On a terminal one line that is rewritten, else a line every five seconds at most.
  void progress(const std::string& stage, std::int64_t done, std::int64_t total);

 private:
  void line(std::string_view level, std::string_view colour, const std::string& message);
  void end_progress_line();

  std::string tool_;
  LogLevel level_;
  LogFormat format_;
  bool terminal_, colour_;
  bool progress_line_open_ = false;
  double last_progress_s_;
};

}  // namespace ngs::cli
