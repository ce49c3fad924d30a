#include "shared/run/console.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "ngs/core/monitor.h"
#include "ngs/options/option_set.h"

namespace ngs::cli {
namespace {

/// One write per line, so that lines of several tools in one pipeline do not mix.
void write_stderr(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stderr); }

std::string json_line(const Json& record) { return record.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace

Console::Console(std::string tool, LogLevel level, LogFormat format)
    : tool_(std::move(tool)), level_(level), format_(format), last_progress_s_(wall_seconds()) {
  const char* no_colour = std::getenv("NO_COLOR");
  terminal_ = format == LogFormat::kText && isatty(STDERR_FILENO) != 0;
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
  if (level_ < LogLevel::kWarning) return;
  if (format_ == LogFormat::kJson) return line("text", "", lines);
  clear_progress();
  write_stderr(lines);
}

void Console::line(std::string_view level, std::string_view colour, const std::string& message) {
  clear_progress();
  if (format_ == LogFormat::kJson)
    return write_stderr(json_line({{"tool", tool_}, {"event", level}, {"message", message}}));
  const std::string label =
      colour_ && !colour.empty() ? std::string(colour) + std::string(level) + "\033[0m" : std::string(level);
  write_stderr(tool_ + ": " + label + ": " + message + "\n");
}

void Console::progress(const std::string& stage, std::int64_t done, std::int64_t total) {
  if (level_ < LogLevel::kWarning) return;
  const double now_s = wall_seconds();
  if (now_s - last_progress_s_ < (terminal_ ? 0.1 : 5.0)) return;
  last_progress_s_ = now_s;
  if (format_ == LogFormat::kJson)
    return write_stderr(
        json_line({{"tool", tool_}, {"event", "progress"}, {"stage", stage}, {"done", done}, {"total", total}}));
  const std::string text =
      tool_ + ": " + stage + (stage.empty() ? "" : " ") + std::to_string(done) + "/" + std::to_string(total);
  write_stderr(terminal_ ? "\r\033[K" + text : text + "\n");
  std::fflush(stderr);
  shows_progress_ = terminal_;
  stage_ = stage;
}

void Console::stage_ended(const std::string& stage) {
  if (stage == stage_) clear_progress();
}

void Console::clear_progress() {
  if (shows_progress_) write_stderr("\r\033[K");
  shows_progress_ = false;
}

}  // namespace ngs::cli
