#pragma once
// stderr: messages and progress for people, or JSON lines. stdout is data and no business of this file.
// Progress on a terminal is one line that is rewritten; it is gone before anything else is written and once its stage
// is over, so that nothing of it stays behind.
#include <cstdint>
#include <string>
#include <string_view>

#include "shared/cli/common_flags.h"
#include "shared/run/progress_clock.h"

namespace ngs::cli {

class Console {
 public:
  Console(std::string tool, LogLevel level, LogFormat format);
  ~Console() { clear_progress(); }
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  void error(const std::string& message, const std::string& remedy);
  void warning(const std::string& message);
  void info(const std::string& message);
  /// A table or another text of several lines for people, as it is; silent with -q.
  void text(const std::string& lines);
  /// The end of a run, on a terminal; silent with -q.
  void summary(const std::string& lines);
  /// On a terminal one line that is rewritten, with a bar and the time that the stage takes, else a line every ten
  /// seconds at most, or every NGS_PROGRESS_S of the environment, for a tool that another shows. `total` 0: not known.
  void progress(const std::string& stage, std::int64_t done, std::int64_t total);
  void stage_ended(const std::string& stage);
  /// "3/9": progress is that of the third of nine stages, of which other tools do the rest. At first what the
  /// environment says (summary.h); empty: there is one stage only.
  void set_stage_of_chain(std::string stage_of) { chain_ = std::move(stage_of), last_progress_s_ = 0; }
  /// For those who write to the terminal themselves.
  void clear_progress();

 private:
  std::string progress_line(const std::string& stage, std::int64_t done, std::int64_t total, double now_s) const;
  void line(std::string_view level, std::string_view colour, const std::string& message);

  std::string tool_, chain_;
  LogLevel level_;
  LogFormat format_;
  bool terminal_, colour_;
  bool shows_progress_ = false;
  ProgressClock clock_;
  double last_progress_s_, progress_every_s_;
};

}  // namespace ngs::cli
