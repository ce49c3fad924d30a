#include "ngs/core/monitor.h"

#include <chrono>

#include "ngs/core/wall_clock.h"
#include "ngs/os/process_usage.h"

namespace ngs {

double (*wall_clock)() = [] {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
};

double wall_seconds() { return wall_clock(); }

Monitor::Monitor() : current_(&root_) {}

Monitor::Scope::Scope(Monitor& monitor, std::string name)
    : monitor_(monitor), parent_(monitor.current_), wall_start_(wall_seconds()), cpu_start_(os::cpu_seconds()) {
  // A step that runs many times under one parent is one node: its times add up.
  for (StageNode& child : parent_->children)
    if (child.name == name) {
      node_ = &child;
      name.clear();
    }
  if (!name.empty()) {
    node_ = &parent_->children.emplace_back();
    node_->name = std::move(name);
  }
  monitor_.current_ = node_;
}

Monitor::Scope::~Scope() {
  node_->wall_s += wall_seconds() - wall_start_;
  node_->cpu_s += os::cpu_seconds() - cpu_start_;
  node_->max_rss_mib = os::peak_rss_mib();
  monitor_.current_ = parent_;
  if (monitor_.on_stage_end) monitor_.on_stage_end(node_->name);
}

void Monitor::warn(std::string message) {
  if (on_warning) on_warning(message);
  warnings_.push_back(std::move(message));
}

Monitor::Limit::Limit(Monitor& monitor, double deadline_s) : monitor_(monitor) {
  monitor_.stopped_by_limit_ = false;
  monitor_.deadline_s_ = deadline_s;
}

Monitor::Limit::~Limit() {
  monitor_.stopped_by_limit_ = false;
  monitor_.deadline_s_ = kNever;
}

bool Monitor::Limit::reached() const { return monitor_.stopped_by_limit_; }

/// Once true, it stays true until the limit ends: all threads of a loop must stop together.
bool Monitor::limit_reached() const {
  const double deadline_s = deadline_s_;
  if (deadline_s == kNever) return false;
  if (stopped_by_limit_ || wall_seconds() >= deadline_s) stopped_by_limit_ = true;
  return stopped_by_limit_;
}

/// Estimates the end of a loop once a tenth of it is done.
void Monitor::abort_if_late(std::int64_t done, std::int64_t total) {
  constexpr std::int64_t kFraction = 10, kMinDone = 3;
  const double now_s = wall_seconds();
  if (done <= 1) first_done_s_ = now_s;
  if (done < kMinDone || kFraction * done < total || done >= total) return;
  const double rest_s = (now_s - first_done_s_) / double(done - 1) * double(total - done);
  if (now_s + rest_s > deadline_s_) deadline_s_ = now_s;
}

void Monitor::progress(std::int64_t done, std::int64_t total) {
  if (deadline_s_ != kNever) abort_if_late(done, total);
  if (on_progress) on_progress(current_->name, done, total);
}

}  // namespace ngs
