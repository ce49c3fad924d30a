#pragma once
// The options of ngs-joint besides those of its passes, and their groups.
#include <optional>
#include <string>
#include <vector>

#include "ngs/cut/methods/method_bce.h"
#include "ngs/cut/methods/method_cob.h"
#include "ngs/cut/methods/method_flash.h"
#include "ngs/cut/methods/method_released.h"
#include "ngs/cut/methods/method_sa3d.h"
#include "ngs/cut/methods/method_saga.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/cut/passes/pipeline.h"
#include "ngs/cut/training/training_options.h"
#include "ngs/render/background.h"
#include "ngs/render/render_options.h"
#include "shared/tool.h"

namespace ngs::joint {

// The methods of ngs-joint, and the options of the baselines.

/// kNgs: all passes, the NeRF only if there are no photos. kNgGs: the joint stage of the paper with its NeRF and none
/// of our passes.
enum class Method : std::uint8_t { kNgs, kNgGs, kBce, kCob, kFlash, kSa3d, kSaga, kReleased };
inline constexpr NamedValue<Method> kMethodNames[] = {
    {Method::kNgs, "ngs"},     {Method::kNgGs, "ng-gs"}, {Method::kBce, "bce"},   {Method::kCob, "cob"},
    {Method::kFlash, "flash"}, {Method::kSa3d, "sa3d"},  {Method::kSaga, "saga"}, {Method::kReleased, "released"}};
std::string method_name(Method method);
/// Whether the method renders views; flash is computed from the evidence alone.
constexpr bool renders_views(Method method) { return method != Method::kFlash; }

struct BaselineOptions {
  FlashOptions flash;
  Sa3dOptions sa3d;
  BceOptions bce;
  CobOptions cob;
  SagaOptions saga;
  ReleasedOptions released;

  /// Declares one group per method, which applies if `method` is selected; `method` must outlive the tool.
  void declare(cli::Tool& tool, const Method& method);
};

/// `method` must not be kNgs or kNgGs.
Solution run_baseline(cli::Run& run, Method method, const BaselineOptions& options, const Problem& problem);

/// Options that apply to every method.
struct MethodChoice {
  Method method = Method::kNgs;
  std::vector<std::string> objects, effect;
  Quality quality = Quality::kStandard;
  std::string background;
  bool explain = false;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.method, Choice<Method>{"method", "How to label", kMethodNames});
    visit(self.quality, Choice<Quality>{"quality", "How long to train", kQualityNames});
    visit(self.objects, Text{"object", "NAME", "Use only this object of the scene"});
    visit(self.effect, Text{"effect", "NAME=auto|on|off", "Switch a pass or a part of one, or all=... of them"});
    visit(self.explain, Flag{"explain", "List the effects chosen for this scene with reasons, then stop"});
    visit(self.background, background_option());
  }
};

/// Budget, target, checkpoints and trace of a run.
struct StepOptions {
  std::string time_budget, target, checkpoint;
  std::int64_t checkpoint_every = 0;
  int trace_every = 0;
  bool resume = false, fast_atomics = false;

  /// Of "60s", "5m", "1h" or "90" in seconds; nullopt: no budget. kUsage otherwise.
  std::optional<double> budget_s() const;
  /// Of "biou=0.9" or "iou=0.95"; nullopt: none. kUsage otherwise.
  std::optional<AgreementTarget> agreement_target() const;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.time_budget,
          Text{"time_budget", "60s|5m", "End the process within this time, with a partial result (exit 7)"});
    visit(self.target,
          Text{"target", "iou=X|biou=X", "Stop when renders agree this well with the masks of training views"});
    visit(self.checkpoint, Text{"checkpoint", "DIR", "Folder for checkpoints of the run"}.of("joint"));
    visit(self.checkpoint_every,
          Field<std::int64_t>{"checkpoint_every", "", "Steps between checkpoints; 0: on a signal, before contours", 0,
                              1'000'000'000}
              .of("joint"));
    visit(self.resume, Flag{"resume", "Continue from the checkpoint in --checkpoint, if there is one"}.of("joint"));
    visit(self.trace_every,
          Field<int>{"trace_every", "", "Steps between scores in the trace; 0: once per stage", 0, 1 << 30});
    visit(self.fast_atomics, Flag{"fast_atomics", "Use atomic adds on CUDA: faster, not bit-reproducible"});
  }
};

struct Options {
  MethodChoice choice;
  StepOptions steps;
  TrainingOptions training;
  RasterOptions raster;
  BaselineOptions baselines;
  Pipeline pipeline{all_passes(training.losses)};

  /// Declares the options in groups; --help shows the groups that apply to the method.
  void declare(cli::Tool& tool);
  bool runs_passes() const { return choice.method == Method::kNgs || choice.method == Method::kNgGs; }
};

/// The options that change a result, as one line of JSON.
std::string options_text(Options& options);

// The effects of a run: decisions that need no heuristic, and the table in the help.

/// Decisions from the method, from options, and from another run's report. `effects_from`: empty, or a report of
/// ngs-joint whose decisions are repeated unless the method or an option fixes them. Throws kBadInput if the report has
/// no decisions, kInconsistent if it belongs to another method.
std::vector<FixedDecision> fixed_decisions_of(const Options& options, const std::string& effects_from);

/// The table for the passes that run with the method of `options`. `in_full`: also one line per part.
std::string effects_help(const Options& options, bool in_full);

}  // namespace ngs::joint
