#include "options.h"

#include "ngs/options/name_of.h"

namespace ngs::joint {

void Options::declare(cli::Tool& tool) {
  const auto group = [this](std::string title, std::string effect = {}) {
    return OptionGroup{.title = std::move(title),
                       .effect = std::move(effect),
                       .listens = [this] { return runs_passes(); },
                       .listener = "--method ngs",
                       .expert = true};
  };
  OptionGroup of_steps = group("steps: time, target, checkpoints");
  of_steps.expert = false;
  tool.options(choice, {.title = "method", .basic = true});
  tool.options(steps, of_steps);
  tool.options(training.joint, group("joint: losses and rates of Eq. 20"));
  pipeline.declare(tool.option_set(), group(""));
  tool.options(training.sample, group("nerf: query points", "nerf"));
  tool.options(training.rbf, group("nerf: query points"));
  tool.options(raster, {.title = "rendering"});
  baselines.declare(tool, choice.method);
}

void Options::settle(Monitor& monitor) {
  training.joint.quality = choice.quality;
  if (choice.method != Method::kPaper) return;
  monitor.warn("--method paper is now called --method ngs; the paper's own method is --method ng-gs");
  choice.method = Method::kNgs;
}

std::string options_text(Options& options) {
  OptionSet set;
  set.add(options.training.joint);
  options.pipeline.declare(set, {});
  set.add(options.training.sample);
  set.add(options.training.rbf);
  Json values = set.to_json();
  values["quality"] = name_of(kQualityNames, options.choice.quality);
  values["effect"] = options.choice.effect;
  return values.dump();
}

}  // namespace ngs::joint
