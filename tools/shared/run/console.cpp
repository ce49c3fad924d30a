#include "shared/run/console.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "ngs/core/monitor.h"
#include "ngs/options/option_set.h"
#include "shared/os/machine.h"
#include "shared/run/report.h"
#include "shared/text/layout.h"

namespace ngs::cli {
namespace {

/// One write per line, so that lines of several tools in a pipeline do not mix.
void write_stderr(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stderr); }

/// "20 s", "3 min", "1 h 20 min".
std::string rough_duration(double seconds) {
  if (seconds < 55) return std::to_string(std::max(1L, std::lround(seconds))) + " s";
  const long minutes = std::lround(seconds / 60);
  if (minutes < 60) return std::to_string(minutes) + " min";
  return std::to_string(minutes / 60) + " h " + std::to_string(minutes % 60) + " min";
}

std::string json_line(const Json& record) { return record.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace

Console::Console(std::string tool, LogLevel level, LogFormat format)
    : tool_(std::move(tool)),
      chain_(stage_of_chain()),
      level_(level),
      format_(format),
      last_progress_s_(wall_seconds()) {
  const char* no_colour = std::getenv("NO_COLOR");
  terminal_ = format == LogFormat::kText && os::is_terminal(os::kStderr);
  const char* every_s = std::getenv("NGS_PROGRESS_S");
  progress_every_s_ = every_s != nullptr ? std::max(0.05, std::atof(every_s)) : terminal_ ? 0.1 : 10.0;
  colour_ = terminal_ && (no_colour == nullptr || *no_colour == '\0');
}

void Console::error(const std::string& message, const std::string& remedy) {
  line("error", "\033[31m", message);
  if (!remedy.empty()) line("hint", "\033[36m", remedy);
}

void Console::warning(const std::string& message) {
  if (level_ >= LogLevel::kWarning) line("warning", "\033[33m", message);
}

void Console::info(const std::string& message) {
  if (level_ >= LogLevel::kInfo) line("info", "", message);
}

void Console::text(const std::string& lines) {
  if (level_ >= LogLevel::kWarning) needed(lines);
}

void Console::needed(const std::string& lines) {
  if (format_ == LogFormat::kJson) return line("text", "", lines);
  clear_progress();
  write_stderr(terminal_ ? rewrapped(lines, terminal_columns(os::kStderr)) : lines);
}

void Console::verbatim(const std::string& lines) {
  if (level_ < LogLevel::kWarning) return;
  if (format_ == LogFormat::kJson) return line("text", "", lines);
  clear_progress();
  write_stderr(lines);
}

void Console::line(std::string_view level, std::string_view colour, const std::string& message) {
  clear_progress();
  if (format_ == LogFormat::kJson)
    return write_stderr(json_line({{"tool", tool_}, {"event", level}, {"message", message}}));
  std::string text = tool_ + ": " + std::string(level) + ": ";
  if (terminal_ && message.find('\n') == message.npos)
    text = wrapped(std::move(text), message, {2, terminal_columns(os::kStderr)});
  else
    text += message;
  if (colour_ && !colour.empty())
    text.insert(tool_.size() + 2 + level.size(), "\033[0m").insert(tool_.size() + 2, colour);
  write_stderr(text + "\n");
}

void Console::progress(const std::string& stage, std::int64_t done, std::int64_t total) {
  if (level_ < LogLevel::kWarning) return;
  const double now_s = wall_seconds();
  clock_.update(stage, done, now_s);
  if (!is_time_for_progress(now_s)) return;
  if (format_ == LogFormat::kJson)
    return write_stderr(
        json_line({{"tool", tool_}, {"event", "progress"}, {"stage", stage}, {"done", done}, {"total", total}}));
  write_progress(progress_line(stage, done, total, now_s));
}

bool Console::is_time_for_progress(double now_s) {
  if (now_s - last_progress_s_ < progress_every_s_) return false;
  last_progress_s_ = now_s;
  return true;
}

void Console::write_progress(const std::string& text) {
  if (terminal_)
    write_stderr("\r\033[K" + std::string(first_columns(text, terminal_columns(os::kStderr) - 1)));
  else
    write_stderr(text + "\n");
  std::fflush(stderr);
  shows_progress_ = terminal_;
}

void Console::progress(const ChainProgress& chain) {
  constexpr int kBar = 20, kParts = 1000;
  if (level_ < LogLevel::kWarning) return;
  if (chain.words != last_words_) last_progress_s_ = 0;  // a new step is shown at once
  last_words_ = chain.words;
  if (!is_time_for_progress(wall_seconds())) return;
  const double done = std::clamp(chain.done, 0.0, 1.0);
  if (format_ == LogFormat::kJson)
    return write_stderr(json_line({{"tool", tool_},
                                   {"event", "progress"},
                                   {"stage", chain.words},
                                   {"done", std::lround(done * kParts)},
                                   {"total", kParts}}));
  std::string text = tool_ + ": ";
  const auto filled = std::size_t(kBar * done);
  if (terminal_) text += "[" + std::string(filled, '#') + std::string(kBar - filled, '.') + "] ";
  text += std::to_string(std::lround(100 * done)) + " %";
  if (chain.left_s >= 0) text += ", about " + rough_duration(chain.left_s) + " left";
  write_progress(text + ": " + chain.words + " (" + std::to_string(chain.step) + "/" + std::to_string(chain.steps) +
                 ")");
}

/// A bar and times as soon as they are known. Narrower than the terminal: a line that wraps could not be erased.
std::string Console::progress_line(const std::string& stage, std::int64_t done, std::int64_t total,
                                   double now_s) const {
  constexpr int kBar = 20;
  const double taken_s = clock_.taken_s(stage, now_s), left_s = clock_.left_s(stage, total, now_s);
  std::string text = (chain_.empty() ? "" : "[" + chain_ + "] ") + tool_ + ": " + stage;
  if (total > 0) text += (stage.empty() ? "" : " ") + std::to_string(done) + "/" + std::to_string(total);
  if (taken_s >= 1 && total > 0 && left_s >= 0) {
    const auto filled = std::size_t(kBar * std::clamp(double(done) / double(total), 0.0, 1.0));
    if (terminal_) text += " [" + std::string(filled, '#') + std::string(kBar - filled, '.') + "]";
    text += " " + duration_text(taken_s) + ", " + duration_text(left_s) + " left";
  }
  return text;
}

void Console::summary(const std::string& lines) {
  if (terminal_) text(lines);
}

void Console::stage_ended(const std::string& stage) {
  if (clock_.stage_ended(stage)) clear_progress();
}

void Console::clear_progress() {
  if (shows_progress_) write_stderr("\r\033[K");
  shows_progress_ = false;
}

}  // namespace ngs::cli
