#pragma once
// How long the part of the work has taken whose progress is told. A stage that counts anew, once for each of its parts,
// begins another part: what it took before says nothing of what is left.
#include <cstdint>
#include <string>

namespace ngs::cli {

class ProgressClock {
 public:
  void told(const std::string& stage, std::int64_t done, double now_s) {
    if (began_s_ < 0 || stage != stage_ || done < done_) stage_ = stage, began_s_ = now_s, first_done_ = done;
    done_ = done;
  }
  void stage_ended() { began_s_ = -1; }
  const std::string& stage() const { return stage_; }
  double taken_s(double now_s) const { return now_s - began_s_; }
  /// Of `total` pieces, at the pace so far; negative where there is none yet.
  double left_s(std::int64_t total, double now_s) const {
    return done_ > first_done_ ? taken_s(now_s) * double(total - done_) / double(done_ - first_done_) : -1;
  }

 private:
  std::string stage_;
  double began_s_ = -1;  // as far as is known from its progress; -1: none was told
  std::int64_t first_done_ = 0, done_ = 0;
};

}  // namespace ngs::cli
