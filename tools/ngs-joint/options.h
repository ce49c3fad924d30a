#pragma once
// The options of ngs-joint besides those of its passes, and their groups.
#include <optional>
#include <string>
#include <vector>

#include "methods.h"
#include "ngs/cut/passes/pass_list.h"
#include "ngs/cut/passes/pipeline.h"
#include "ngs/cut/training/training_options.h"
#include "ngs/render/background.h"
#include "ngs/render/render_options.h"

namespace ngs::joint {

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

/// All options of a command line.
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

}  // namespace ngs::joint
