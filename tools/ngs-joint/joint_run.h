#pragma once
// What surrounds the optimisation in ngs-joint: its own options, budget, target, trace and checkpoints.
#include <optional>
#include <string>

#include "ngs/options/field.h"
#include "ngs/stages/render/background.h"
#include "ngs/passes/joint/joint_stage.h"
#include "shared/tool.h"

namespace ngs::joint {

enum class Method : std::uint8_t { kPaper, kBce, kCob, kFlash, kSa3d, kSaga, kReleased };
inline constexpr NamedValue<Method> kMethodNames[] = {
    {Method::kPaper, "paper"},      {Method::kBce, "bce"},   {Method::kCob, "cob"},
    {Method::kFlash, "flash"},      {Method::kSa3d, "sa3d"}, {Method::kSaga, "saga"},
    {Method::kReleased, "released"}};
std::string method_name(Method method);

struct RunOptions {
  Method method = Method::kPaper;
  std::string time_budget, target, background, checkpoint;
  std::int64_t checkpoint_every = 0;
  int trace_every = 0;
  std::vector<std::string> objects;
  bool resume = false, explain = false, fast_atomics = false;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.method, Choice<Method>{"method", "what decides the labels", kMethodNames});
    visit(self.time_budget,
          Text{"time_budget", "60s|5m", "the whole process ends by then, with what there is (exit 7)"});
    visit(self.target, Text{"target", "biou=0.9|iou=0.95",
                            "stop when the training views agree this well with their masks"});
    visit(self.background, background_option());
    visit(self.checkpoint, Text{"checkpoint", "DIR", "folder in which the state of the run is kept"});
    visit(self.checkpoint_every,
          Field<std::int64_t>{"checkpoint_every", "", "steps between checkpoints; 0: when interrupted, and before the edges",
                              0, 1'000'000'000});
    visit(self.trace_every,
          Field<int>{"trace_every", "", "steps between scores in the trace; 0: once per iteration of views", 0,
                     1 << 30});
    visit(self.objects, Text{"objects", "NAME", "only this object of the scene; repeat for more"});
    visit(self.resume, Flag{"resume", "go on from the checkpoint in --checkpoint, if there is one"});
    visit(self.explain, Flag{"explain", "decide the effects for this scene, list them, run nothing else"});
    visit(self.fast_atomics,
          Flag{"fast_atomics", "with --device cuda: sum as it comes, faster; the same run then differs in last bits"});
  }
};

/// Seconds of "60s", "5m", "1h" or "90"; kUsage otherwise. Empty: none.
std::optional<double> parse_budget(const std::string& text);

struct Target {
  bool boundary;  // biou, else iou
  double value;
};
std::optional<Target> parse_target(const std::string& text);

/// How well the rendered masks agree with the training views' own masks, on the mean over the objects.
struct Agreement {
  double iou = 0, biou = 0;
};
/// Of every training view with masks.
std::vector<Agreement> training_agreement(const Exec& exec, const Problem& input,
                                          const Solution& result);
Agreement mean_agreement(const std::vector<Agreement>& views);

/// How floaters were taken out. Under a budget the clock decides it, and a run that is resumed has to do the same again.
struct FloaterPlan {
  bool draft = false;    // searched at a half of the size of decisions
  int refit_epochs = 0;  // 0: nothing was found
  Json json() const { return {{"draft", draft}, {"refit_epochs", refit_epochs}}; }
};

/// Where the state of a run is kept; the file appears by rename. `fingerprint` names all that the
/// state follows from: another run's checkpoint is kInconsistent.
class Checkpoint {
 public:
  Checkpoint(std::string folder, std::string fingerprint)
      : folder_(std::move(folder)), fingerprint_(std::move(fingerprint)) {}
  static std::string path_in(const std::string& folder);
  /// "floaters" of the fingerprint of the state in that folder; none: there is no such state. kInconsistent where the state is of
  /// a run with something else than what is `known` of this one (fingerprint.h), before the work for it is done.
  static std::optional<FloaterPlan> floaters_in(const std::string& folder, const Json& known);
  bool given() const { return !folder_.empty(); }
  /// The folder is there (shared/checkpoints.h).
  void save(JointTrainer& trainer) const;
  /// False if there is none. Its contents are believed as little as those of any file: kBadInput for arrays of another length,
  /// numbers that are not finite where the trainer's are, and a step that it does not plan.
  bool load(JointTrainer& trainer) const;

 private:
  std::string path() const { return path_in(folder_); }
  std::string folder_, fingerprint_;
};

void write_nerf(const std::string& path, const JointTrainer& trainer);

}  // namespace ngs::joint
