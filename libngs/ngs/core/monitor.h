#pragma once
// What a stage tells the outside while it runs: a tree of timed steps, counts, warnings, progress; and what
// the outside tells it: whether to stop. The library itself never prints.
#include <atomic>
#include <cstdint>
#include <functional>
#include <list>
#include <string>
#include <vector>

namespace ngs {

/// One node of the stage tree of a report.
struct StageNode {
  std::string name;
  double wall_s = 0;
  double cpu_s = 0;               // all threads of the process
  std::int64_t items = 0;         // what the stage counts: views, queries, steps
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

  void warn(std::string message);
  void progress(std::int64_t done, std::int64_t total);
  /// True once the user (signal) or a budget asked the stage to end early with what it has.
  bool stop_requested() const { return stop_ != nullptr && stop_->load(); }

  const StageNode& root() const { return root_; }
  const std::vector<std::string>& warnings() const { return warnings_; }

  // May be empty.
  std::function<void(const std::string&)> on_warning;
  std::function<void(const std::string& stage, std::int64_t done, std::int64_t total)> on_progress;
  std::function<void(const std::string& stage)> on_stage_end;  // by its Scope
  void stop_flag(const std::atomic<bool>* flag) { stop_ = flag; }

 private:
  StageNode root_;
  StageNode* current_;
  std::vector<std::string> warnings_;
  const std::atomic<bool>* stop_ = nullptr;
};

/// Seconds since an arbitrary fixed point, monotonic.
double wall_seconds();

}  // namespace ngs
