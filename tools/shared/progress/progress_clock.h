#pragma once
// Elapsed and remaining time of the stages that report progress. A stage whose count restarts begins another part: the
// time of earlier parts does not predict the new one. Progress of other stages in between, such as scores for a trace,
// has no influence.
#include <cstdint>
#include <map>
#include <string>

namespace ngs::cli {

class ProgressClock {
 public:
  void update(const std::string& stage, std::int64_t done, double now_s) {
    Part& part = parts_.try_emplace(stage, Part{now_s, done, done}).first->second;
    if (done < part.done) part = {now_s, done, done};
    part.done = done;
  }
  /// False if the stage has reported no progress.
  bool stage_ended(const std::string& stage) { return parts_.erase(stage) > 0; }
  /// Elapsed time of a stage that has reported progress.
  double taken_s(const std::string& stage, double now_s) const { return now_s - parts_.at(stage).began_s; }
  /// Remaining time until `total`, at the pace so far; negative if there is no pace yet.
  double left_s(const std::string& stage, std::int64_t total, double now_s) const {
    const Part& part = parts_.at(stage);
    const std::int64_t pace = part.done - part.first_done;
    return pace > 0 ? (now_s - part.began_s) * double(total - part.done) / double(pace) : -1;
  }

 private:
  struct Part {
    double began_s;  // time of its first progress report
    std::int64_t first_done, done;
  };
  std::map<std::string, Part> parts_;  // by stage
};

}  // namespace ngs::cli
