#pragma once
// What the studio works with, and the answer to each request (data-schema/studio-protocol.md).
#include <atomic>
#include <map>

#include "chain.h"
#include "fields.h"
#include "latency.h"
#include "loaded_model.h"
#include "reply.h"

namespace ngs::studio {

class Desk {
 public:
  Desk(const Exec& exec, StudioPlace place);
  Desk(const Desk&) = delete;
  Desk& operator=(const Desk&) = delete;

  /// Changes: one at a time. Each returns the state.
  Json strokes(Fields request);
  Json undo(Fields request);
  Json redo(Fields request);
  Json objects(Fields request);
  Json refine(Fields request);
  Json export_files(Fields request);
  /// Steps back end here: what a visit that was closed and opened again writes down.
  Json forget(Fields request);
  /// Writes a change down, to be run again.
  void note(const std::string& path, const nlohmann::json& body) const;

  /// Any time, by any thread.
  Reply frame(Fields request);
  Json before(Fields request);
  Json state() const;
  Json job_json() const;
  Json cancel() const;
  Json log() const;

 private:
  struct Refined {
    std::shared_ptr<const RefinedModel> model;
    std::vector<std::shared_ptr<const live::MarkedView>> views;  // that it was made from
  };

  Json changed();
  Json objects_json(const live::Marks& marks) const;
  Json commands_json(const live::Marks& marks) const;
  Json views_json() const;
  std::shared_ptr<const RefinedModel> refined_of(const live::Marks& marks, int object) const;
  bool is_refined(const live::ObjectMarks& object) const;
  RefineChoice choice_for(int object, const std::string& quality) const;
  void start(std::string kind, std::vector<JobStep> steps, std::function<void()> finished);
  void refuse_while_busy() const;
  live::FrameRequest frame_request(Fields& request, bool& moving) const;

  const Exec exec_;
  const StudioPlace place_;
  StateFolder folder_;
  const LoadedModel loaded_;
  live::Session session_;
  std::atomic<int> version_ = 1;
  std::atomic<bool> shows_before_ = false;
  std::mutex drawing_;              // one frame at a time: each takes all threads
  live::LastFrame last_still_;      // while drawing
  mutable std::mutex mutex_;        // of what follows
  std::map<int, Refined> refined_;  // by object
  std::map<int, std::string> quality_;
  Json exported_;
  Latencies stroke_ms_, first_ms_, correction_ms_, moving_ms_, still_ms_;
  std::shared_ptr<Job> job_;  // the last: it ends before what it works with goes
};

}  // namespace ngs::studio
