#pragma once
// How long the part of the work has taken whose progress is told. A stage that counts anew, once for each of its parts,
// begins another part: what it took before says nothing of what is left. What another stage tells in between, such as
// the scores that a trace asks for, does not.
#include <cstdint>
#include <map>
#include <string>

namespace ngs::cli {

class ProgressClock {
 public:
  void told(const std::string& stage, std::int64_t done, double now_s) {
    Part& part = parts_.try_emplace(stage, Part{now_s, done, done}).first->second;
    if (done < part.done) part = {now_s, done, done};
    part.done = done;
  }
  /// False: it has told nothing.
  bool stage_ended(const std::string& stage) { return parts_.erase(stage) > 0; }
  /// Of a stage that has told something.
  double taken_s(const std::string& stage, double now_s) const { return now_s - parts_.at(stage).began_s; }
  /// Of `total` pieces, at the pace so far; negative where there is none yet.
  double left_s(const std::string& stage, std::int64_t total, double now_s) const {
    const Part& part = parts_.at(stage);
    const std::int64_t pace = part.done - part.first_done;
    return pace > 0 ? (now_s - part.began_s) * double(total - part.done) / double(pace) : -1;
  }

 private:
  struct Part {
    double began_s;  // as far as is known from its progress
    std::int64_t first_done, done;
  };
  std::map<std::string, Part> parts_;  // by stage
};

}  // namespace ngs::cli
