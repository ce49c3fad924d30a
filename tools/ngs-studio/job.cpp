#include "job.h"

#include <limits>

#include "ngs/core/error.h"
#include "ngs/core/monitor.h"
#include "shared/cli/exit_code.h"
#include "shared/os/background.h"
#include "shared/run/child_process.h"
#include "shared/run/signals.h"

namespace ngs::studio {
namespace {

struct Cancelled {};

std::vector<cli::ChainStep> parts_of(const std::vector<JobStep>& steps) {
  std::vector<cli::ChainStep> parts;
  for (const JobStep& step : steps) {
    parts.push_back({step.words.empty() ? 0 : step.share, !step.words.empty() && step.words[0] == "ngs-joint"});
  }
  return parts;
}

}  // namespace

Job::Job(std::string kind, std::vector<JobStep> steps, std::function<void()> finished)
    : kind_(std::move(kind)),
      steps_(std::move(steps)),
      finished_(std::move(finished)),
      start_s_(wall_seconds()),
      clock_(parts_of(steps_)) {
  thread_ = os::in_background([this] { work(); });
}

Job::~Job() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

bool Job::is_running() const {
  const std::lock_guard lock(mutex_);
  return state_ == "running";
}

void Job::begin(std::size_t step) {
  const std::lock_guard lock(mutex_);
  stage_ = steps_[step].stage;
  clock_.begin(step, wall_seconds());
}

void Job::progress(const std::string& stage, double fraction) {
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  clock_.update(fraction);
}

bool Job::run_steps() {
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    if (stop_) throw Cancelled{};
    begin(k);
    if (steps_[k].words.empty()) {
      steps_[k].run();
      continue;
    }
    try {
      run_program(steps_[k]);
    } catch (const Error& e) {
      if (steps_[k].if_nothing.empty() || e.code() == ErrorCode::kEnvironment) throw;
      const std::lock_guard lock(mutex_);
      note_ = steps_[k].if_nothing;
      return false;
    }
  }
  return true;
}

void Job::work() {
  std::string state = "done", error;
  try {
    if (run_steps()) finished_();
  } catch (const Cancelled&) {
    state = "cancelled";
  } catch (const Error& e) {
    state = "failed", error = e.what() + (e.remedy().empty() ? "" : " (" + e.remedy() + ")");
  } catch (const std::exception& e) {
    state = "failed", error = e.what();
  }
  const std::lock_guard lock(mutex_);
  state_ = state, error_ = error, end_s_ = wall_seconds();
  if (state == "done") clock_.begin(steps_.size(), end_s_);
}

void Job::run_program(const JobStep& step) {
  std::vector<std::string> argv = step.words;
  argv = cli::sibling_command(std::move(argv));
  for (const char* word : {"--log-format", "json"}) argv.emplace_back(word);
  std::string error, hint;
  const auto listen = [&](const std::string& line) {
    const nlohmann::json record = nlohmann::json::parse(line, nullptr, false);
    if (!record.is_object()) return;
    const std::string event = record.value("event", "");
    if (event == "error") error = record.value("message", "");
    if (event == "hint") hint = record.value("message", "");
    const double total = record.value("total", 0.0);
    if (event == "progress" && total > 0)  // stages of a single program are no words for people
      progress(step.words[0] == "ngs" ? record.value("stage", step.stage) : step.stage,
               record.value("done", 0.0) / total);
  };
  constexpr double kGrace_s = 2;
  const cli::SignalGrace waits;  // waits until the program has removed its unfinished files
  const cli::ChildResult child = cli::run_child(argv, {.time_s = std::numeric_limits<double>::infinity(),
                                                       .stop = [this] { return stop_.load(); },
                                                       .grace_on_stop_s = kGrace_s,
                                                       .on_line = listen});
  if (child.end == cli::ChildResult::End::kStopped) throw Cancelled{};
  if (child.end == cli::ChildResult::End::kSignalled)
    throw Error(ErrorCode::kEnvironment, step.words[0] + ": ended by signal " + std::to_string(child.code));
  if (child.code != cli::kDone && child.code != cli::kCheckFailed && child.code != cli::kBudgetHit)
    throw Error(ErrorCode(child.code), step.words[0] + ": " + (error.empty() ? child.output_tail : error), hint);
}

nlohmann::ordered_json Job::json() const {
  const std::lock_guard lock(mutex_);
  const bool running = state_ == "running";
  const double now_s = running ? wall_seconds() : end_s_, elapsed_s = now_s - start_s_;
  const double left_s = clock_.left_s(now_s);
  nlohmann::ordered_json remaining;
  if (running && left_s >= 0) remaining = left_s;
  return {{"kind", kind_},
          {"stage", stage_},
          {"done", clock_.done(now_s)},
          {"elapsed_s", elapsed_s},
          {"remaining_s", remaining},
          {"state", state_},
          {"error", error_.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(error_)},
          {"note", note_.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(note_)}};
}

}  // namespace ngs::studio
