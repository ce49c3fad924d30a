#pragma once
// State of the studio and the handler of each request (data-schema/studio-protocol.md).
#include <atomic>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "chain.h"
#include "loaded_model.h"
#include "requests.h"

namespace ngs::studio {

// Response times.

/// Wall time and CPU time of the whole process since construction.
struct Stopwatch {
  Stopwatch();
  double wall_s() const;
  double cpu_s() const;

  double wall_start_s, cpu_start_s;
};

class Latencies {
 public:
  void add(const Stopwatch& watch) {
    wall_ms_.push_back(1000 * watch.wall_s());
    cpu_ms_.push_back(1000 * watch.cpu_s());
  }
  /// {"n", "median_ms", "p95_ms", "median_cpu_ms", "p95_cpu_ms"}; times are null if n is 0. CPU
  /// time counts all threads, including those of concurrent responses.
  nlohmann::ordered_json json() const;

 private:
  std::vector<double> wall_ms_, cpu_ms_;
};

class Desk {
 public:
  Desk(const Exec& exec, StudioPlace place);
  Desk(const Desk&) = delete;
  Desk& operator=(const Desk&) = delete;

  /// Requests that change the state; the caller serialises them. Each returns the new state.
  Json strokes(const io::JsonReader& request);
  Json undo(const io::JsonReader& request);
  Json redo(const io::JsonReader& request);
  Json objects(const io::JsonReader& request);
  Json edit(const io::JsonReader& request);
  Json keep(const io::JsonReader& request);
  Json refine(const io::JsonReader& request);
  Json export_files(const io::JsonReader& request);
  /// A file of the last export, for the browser.
  Reply download(const io::JsonReader& request) const;
  /// Clears the undo history. A reopened session records this request, since it starts without history.
  Json forget(const io::JsonReader& request);
  /// Appends a request to visit.jsonl for --replay.
  void note(const std::string& path, const nlohmann::json& body) const;

  /// Thread-safe; never wait for a change.
  Reply frame(const io::JsonReader& request);
  Json before(const io::JsonReader& request);
  Json state() const;
  Json job_json() const;
  Json cancel() const;
  Json log() const;

 private:
  struct Refined {
    std::shared_ptr<const RefinedModel> model;
    std::vector<std::shared_ptr<const live::MarkedView>> views;  // marked views that Refine used
    std::shared_ptr<const live::ObjectLabels> labels;            // shown: with dropped parts and edits by hand
    std::shared_ptr<const live::HandEdits> edits;                // what `labels` was made with
    bool keeps_dropped = false;
  };

  Json changed();
  std::int64_t shown_count(int object) const;
  Json objects_json(const live::Marks& marks) const;
  Json commands_json(const live::Marks& marks) const;
  Json views_json() const;
  std::shared_ptr<const RefinedModel> refined_of(const live::Marks& marks, int object) const;
  bool is_refined(const live::ObjectMarks& object) const;
  /// The labels shown, on the Gaussians of the model or of Refine; null: none.
  std::shared_ptr<const live::ObjectLabels> labels_of(const live::Marks& marks, int object) const;
  void relabel_refined(const live::ObjectMarks& object);
  /// Whether the labels shown are neither those of the strokes alone nor those of Refine.
  bool is_by_hand(const live::Marks& marks, const live::ObjectMarks& object) const;
  std::vector<std::vector<std::string>> words_of(const live::ObjectMarks& object, const live::Marks& marks,
                                                 const ExportChoice& choice) const;
  void write_selection(const live::Marks& marks, const live::ObjectMarks& object) const;
  void write_all_objects(const live::Marks& marks) const;
  RefineChoice choice_for(int object, const std::string& quality) const;
  void start(std::string kind, std::vector<JobStep> steps, std::function<void()> finished);
  void refuse_while_busy() const;
  ExportChoice export_choice(const live::Marks& marks) const;
  live::FrameRequest frame_request(const io::JsonReader& request, bool& moving) const;

  const Exec exec_;
  const StudioPlace place_;
  const LoadedModel loaded_;
  StateFolder folder_;  // after the model: no folder is left if that cannot be read
  live::Session session_;
  std::atomic<int> version_ = 1;
  std::atomic<bool> shows_before_ = false;
  std::mutex drawing_;              // one frame at a time: each uses all threads
  live::CachedStill last_still_;    // guarded by drawing_
  mutable std::mutex mutex_;        // guards the members below
  std::map<int, Refined> refined_;  // by object id
  std::map<int, std::string> quality_;
  ExportChoice exported_as_;  // format and filling of the last export
  Json exported_;
  Latencies stroke_ms_, first_ms_, correction_ms_, moving_ms_, still_ms_;
  std::shared_ptr<Job> job_;  // the last job; declared last, so that it is destroyed first
};

}  // namespace ngs::studio
