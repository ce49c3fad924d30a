#pragma once
// What a running stage reports to its caller (a tree of timed steps, counts, warnings, progress), and how the caller
// stops it. The library itself never prints.
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <list>
#include <string>
#include <vector>

namespace ngs {

/// One node of the stage tree of a report.
struct StageNode {
  std::string name;
  double wall_s = 0;
  double cpu_s = 0;               // all threads of the process
  std::int64_t items = 0;         // units of the stage: views, queries, steps
  double max_rss_mib = 0;         // peak of the process when the stage ended
  std::list<StageNode> children;  // Scopes point to them
};

class Monitor {
 public:
  Monitor();

  /// Times one step from construction to destruction. Scopes nest; use from one thread only.
  class Scope {
   public:
    Scope(Monitor& monitor, std::string name);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    void items(std::int64_t n) { node_->items = n; }

   private:
    Monitor& monitor_;
    StageNode* node_;
    StageNode* parent_;
    double wall_start_, cpu_start_;
  };
  Scope scope(std::string name) { return Scope(*this, std::move(name)); }

  /// A time limit. Until the end of its scope, stop_requested() is also true once wall_seconds() >= `deadline_s`, or as
  /// soon as the loop that reports progress is estimated to end later. Limits begin and end on one thread and
  /// do not nest.
  class Limit {
   public:
    Limit(Monitor& monitor, double deadline_s);
    ~Limit();
    Limit(const Limit&) = delete;
    Limit& operator=(const Limit&) = delete;
    /// True once stop_requested() has returned true because of this limit: its caller stopped midway.
    bool reached() const;

   private:
    Monitor& monitor_;
  };

  void warn(std::string message);
  void progress(std::int64_t done, std::int64_t total);
  /// True once the user (a signal) or a Limit requests an early end with the result so far. Thread-safe.
  bool stop_requested() const { return (stop_ != nullptr && stop_->load()) || limit_reached(); }

  const StageNode& root() const { return root_; }
  const std::vector<std::string>& warnings() const { return warnings_; }

  // Callbacks; may be empty.
  std::function<void(const std::string&)> on_warning;
  std::function<void(const std::string& stage, std::int64_t done, std::int64_t total)> on_progress;
  std::function<void(const std::string& stage)> on_stage_end;  // called by ~Scope
  void stop_flag(const std::atomic<bool>* flag) { stop_ = flag; }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  bool limit_reached() const;
  void abort_if_late(std::int64_t done, std::int64_t total);

  StageNode root_;
  StageNode* current_;
  std::vector<std::string> warnings_;
  const std::atomic<bool>* stop_ = nullptr;
  std::atomic<double> deadline_s_ = kNever;
  mutable std::atomic<bool> stopped_by_limit_ = false;
  double first_done_s_ = 0;  // when the current loop reported its first step
};

/// Seconds since an arbitrary fixed point, monotonic.
double wall_seconds();

}  // namespace ngs
