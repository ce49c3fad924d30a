#pragma once
// A background job (Refine or Export): runs sibling programs one after the other.
#include <atomic>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "shared/progress/chain_clock.h"

namespace ngs::studio {

/// One program with its arguments, or a function to call between two programs.
struct JobStep {
  std::string stage;               // shown to the user: "joint"
  double share = 1;                // expected time of a program, relative to the other programs
  std::vector<std::string> words;  // command line; empty: call `run`
  std::function<void()> run = {};
  std::string if_nothing = {};  // the note with which the job ends as done if the program fails with these inputs
};

class Job {
 public:
  /// The job's thread calls `finished` after all steps succeeded.
  Job(std::string kind, std::vector<JobStep> steps, std::function<void()> finished);
  /// Cancels the job and waits for its end.
  ~Job();
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  void cancel() { stop_ = true; }
  bool is_running() const;
  /// {"kind", "stage", "done", "elapsed_s", "remaining_s", "state", "error", "note"}
  nlohmann::ordered_json json() const;
  const std::string& kind() const { return kind_; }

 private:
  void work();
  bool run_steps();  // false: a step with a note for this case failed
  void run_program(const JobStep& step);
  void begin(std::size_t step);
  void progress(const std::string& stage, double fraction);

  const std::string kind_;
  const std::vector<JobStep> steps_;
  const std::function<void()> finished_;
  const double start_s_;
  std::atomic<bool> stop_ = false;
  mutable std::mutex mutex_;  // guards the members below
  std::string stage_, state_ = "running", error_, note_;
  mutable cli::ChainClock clock_;
  double end_s_ = 0;
  std::thread thread_;
};

}  // namespace ngs::studio
