#pragma once
// Command lines that write the files of an object, as a user would type them.
#include <atomic>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "shared/progress/chain_clock.h"
#include "state_folder.h"

namespace ngs::studio {

// A background job (Refine or Export): runs sibling programs one after the other.

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

/// File formats of Export, by the ending of the file.
inline constexpr const char* kFormats[] = {"ply", "compressed.ply", "spz", "sog"};

struct ExportChoice {
  bool all_pieces = false;
  std::string format = "ply";
  bool fill = true;   // also writes background-filled.FORMAT: without the hole behind the object
  bool mesh = false;  // also writes mesh.glb with convex colliders
};
/// Export: writes exactly the Gaussians shown, with ngs-variance, ngs-joint --method flash and ngs-extract. Labels that
/// come neither from strokes nor from Refine are read from selection.ply, which was made from the splat `labelled`.
std::vector<std::vector<std::string>> selection_words(const StateFolder& folder, int object,
                                                      const std::string& labelled, const ExportChoice& choice);
/// The background without any object, from the splat of the session.
std::vector<std::string> common_background_words(const StateFolder& folder, const std::string& model,
                                                 const ExportChoice& choice);
std::vector<std::vector<std::string>> export_words(const StateFolder& folder, int object, const ExportChoice& choice);
/// Export after Refine: converts its object.ply and background.ply, unless the format is ply, and fills the hole.
std::vector<std::vector<std::string>> convert_words(const StateFolder& folder, int object, const ExportChoice& choice);
/// The mesh of the object.FORMAT in a folder, closed where it stands on background.FORMAT.
std::vector<std::string> mesh_words(const std::string& folder, const ExportChoice& choice);

/// The quality of Refine that takes seconds: --method flash for a splat without photos, else --quality draft.
inline constexpr const char* kQuickRefine = "quick";

struct RefineChoice {
  std::string source;  // a splat without views, to be rendered; empty: the scene has views
  std::string around;  // X,Y,Z,R for ngs-scene orbit
  std::string quality = "standard";
  bool all_pieces = false;
};
/// Refine: ngs-scene orbit for a splat without views, then ngs cut over those views and the marked views.
std::vector<std::vector<std::string>> refine_words(const StateFolder& folder, int object, const RefineChoice& choice);

struct Focus {
  Vec3<double> centre{0, 0, 0};
  double radius = 0;
};

/// "X,Y,Z,R": a ball around the selected Gaussians; empty without a selection.
std::string ball_around(const GaussianCloud& cloud, const live::ObjectLabels& labels);

/// Ball around most selected Gaussians, in world units, without outliers; radius 0 without a selection.
Focus focus_of(const GaussianCloud& cloud, const live::ObjectLabels& labels);

}  // namespace ngs::studio
