#pragma once
// Something that takes longer than a person waits: Refine and Export, as sibling programs one after the other.
#include <atomic>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

namespace ngs::studio {

/// One program with its arguments, or what is done between two of them.
struct JobStep {
  std::string stage;               // for people: "joint"
  double share = 1;                // of the job's time, against the others'
  std::vector<std::string> words;  // empty: `run` is called
  std::function<void()> run = {};
};

class Job {
 public:
  /// `finished` is called by the job's thread where all steps were done.
  Job(std::string kind, std::vector<JobStep> steps, std::function<void()> finished);
  /// Cancels, and waits.
  ~Job();
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  void cancel() { stop_ = true; }
  bool is_running() const;
  /// {"kind", "stage", "done", "elapsed_s", "remaining_s", "state", "error"}
  nlohmann::ordered_json json() const;
  const std::string& kind() const { return kind_; }

 private:
  void work();
  void run_program(const JobStep& step, double before);
  void progress(const std::string& stage, double done);

  const std::string kind_;
  const std::vector<JobStep> steps_;
  const std::function<void()> finished_;
  double all_ = 0;  // shares
  const double start_s_;
  std::atomic<bool> stop_ = false;
  mutable std::mutex mutex_;  // of the rest
  std::string stage_, state_ = "running", error_;
  double done_ = 0, end_s_ = 0;
  std::thread thread_;
};

}  // namespace ngs::studio
