#pragma once
// Messages and progress on stderr, as text or JSON lines; stdout carries data only. On a terminal, progress is one line
// that is rewritten. It is erased before other output and when its stage ends.
#include <cstdint>
#include <string>
#include <string_view>

#include "shared/cli/common_flags.h"
#include "shared/progress/chain_clock.h"

namespace ngs::cli {

struct ChainProgress {
  std::string words;  // what is being done: "finding the object"
  std::size_t step = 1, steps = 1;
  double done = 0;     // fraction of the whole run
  double left_s = -1;  // negative: unknown
};

class Console {
 public:
  Console(std::string tool, LogLevel level, LogFormat format);
  ~Console() { clear_progress(); }
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  void error(const std::string& message, const std::string& remedy);
  void warning(const std::string& message);
  void info(const std::string& message);
  /// Prints a table or another text of several lines unchanged; silent with -q.
  void text(const std::string& lines);
  /// The same, also with -q: without these lines the run is of no use.
  void needed(const std::string& lines);
  /// Like text(), but never wrapped, so that a command or JSON can be copied from the terminal.
  void verbatim(const std::string& lines);
  /// Prints the summary of a run on a terminal; silent with -q.
  void summary(const std::string& lines);
  /// On a terminal: one line that is rewritten, with a bar and the time of the stage. Elsewhere: at most one line every
  /// 10 s, or every NGS_PROGRESS_S seconds if a parent tool sets this variable. `total` 0: unknown.
  void progress(const std::string& stage, std::int64_t done, std::int64_t total);
  void stage_ended(const std::string& stage);
  /// The same line for a run of several steps, as one bar.
  void progress(const ChainProgress& chain);
  /// Erases the progress line before others write to the terminal.
  void clear_progress();

 private:
  std::string progress_line(const std::string& stage, std::int64_t done, std::int64_t total, double now_s) const;
  bool is_time_for_progress(double now_s);
  void write_progress(const std::string& text);
  void line(std::string_view level, std::string_view colour, const std::string& message);

  std::string tool_, chain_;  // chain_: stage_of_chain() (report.h); empty: a single tool
  LogLevel level_;
  LogFormat format_;
  bool terminal_, colour_;
  bool shows_progress_ = false;
  ProgressClock clock_;
  std::string last_words_;  // of progress(ChainProgress)
  double last_progress_s_, progress_every_s_;
};

}  // namespace ngs::cli
