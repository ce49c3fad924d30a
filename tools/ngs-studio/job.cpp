#include "job.h"

#include <algorithm>
#include <limits>

#include "ngs/core/error.h"
#include "ngs/core/monitor.h"
#include "shared/cli/exit_code.h"
#include "shared/run/child_process.h"
#include "shared/run/sibling_program.h"
#include "shared/run/signals.h"

namespace ngs::studio {
namespace {

struct Cancelled {};

}  // namespace

Job::Job(std::string kind, std::vector<JobStep> steps, std::function<void()> finished)
    : kind_(std::move(kind)), steps_(std::move(steps)), finished_(std::move(finished)), start_s_(wall_seconds()) {
  for (const JobStep& step : steps_) share_sum_ += step.share;
  thread_ = std::thread([this] { work(); });
}

Job::~Job() {
  stop_ = true;
  thread_.join();
}

bool Job::is_running() const {
  const std::lock_guard lock(mutex_);
  return state_ == "running";
}

void Job::progress(const std::string& stage, double done) {
  const std::lock_guard lock(mutex_);
  stage_ = stage, done_ = std::max(done_, std::min(1.0, done));
}

void Job::work() {
  std::string state = "done", error;
  try {
    double before = 0;
    for (const JobStep& step : steps_) {
      if (stop_) throw Cancelled{};
      progress(step.stage, before / share_sum_);
      if (step.words.empty())
        step.run();
      else
        run_program(step, before);
      before += step.share;
    }
    finished_();
  } catch (const Cancelled&) {
    state = "cancelled";
  } catch (const Error& e) {
    state = "failed", error = e.what() + (e.remedy().empty() ? "" : " (" + e.remedy() + ")");
  } catch (const std::exception& e) {
    state = "failed", error = e.what();
  }
  const std::lock_guard lock(mutex_);
  state_ = state, error_ = error, end_s_ = wall_seconds();
  if (state == "done") done_ = 1;
}

void Job::run_program(const JobStep& step, double before) {
  std::vector<std::string> argv = step.words;
  argv[0] = cli::sibling_path(argv[0]);
  for (const char* word : {"--log-format", "json"}) argv.emplace_back(word);
  std::string error, hint;
  const auto listen = [&](const std::string& line) {
    const nlohmann::json record = nlohmann::json::parse(line, nullptr, false);
    if (!record.is_object()) return;
    const std::string event = record.value("event", "");
    if (event == "error") error = record.value("message", "");
    if (event == "hint") hint = record.value("message", "");
    const double total = record.value("total", 0.0);
    if (event == "progress" && total > 0)
      progress(record.value("stage", step.stage),
               (before + step.share * record.value("done", 0.0) / total) / share_sum_);
  };
  constexpr double kPatienceS = 2;
  const cli::SignalGrace waits;  // waits until the program has removed its unfinished files
  const cli::ChildResult child = cli::run_child(argv, {.time_s = std::numeric_limits<double>::infinity(),
                                                       .stop = [this] { return stop_.load(); },
                                                       .patience_on_stop_s = kPatienceS,
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
  const double elapsed_s = (running ? wall_seconds() : end_s_) - start_s_;
  nlohmann::ordered_json remaining;
  if (running && done_ > 0.05) remaining = elapsed_s * (1 - done_) / done_;
  return {{"kind", kind_},
          {"stage", stage_},
          {"done", done_},
          {"elapsed_s", elapsed_s},
          {"remaining_s", remaining},
          {"state", state_},
          {"error", error_.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(error_)}};
}

}  // namespace ngs::studio
