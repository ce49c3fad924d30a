#include "options.h"

#include "ngs/options/name_of.h"

namespace ngs::joint {

void Options::declare(cli::Tool& tool) {
  const auto group = [this](std::string name, std::string about, std::string effect = {},
                            Shown shown = Shown::kByName) {
    return OptionGroup{.name = std::move(name),
                       .about = std::move(about),
                       .effect = std::move(effect),
                       .applies = [this] { return runs_passes(); },
                       .needs = "--method ngs",
                       .shown = shown};
  };
  tool.options(choice, {.name = "method", .shown = Shown::kInShortHelp});
  tool.options(steps, group("steps", "time, target, checkpoints", {}, Shown::kInHelp));
  tool.options(training.joint, group("joint", "loss weights and learning rates of Eq. 20"));
  tool.options<FieldOptions>(training.joint, group("field", "hash grid and network of the NeRF", "nerf"));
  pipeline.declare(tool.option_set(), group("", ""));
  tool.options(training.sample, group("sampling", "query points of the NeRF", "nerf"));
  tool.options(training.rbf, group("rbf", "features at the query points"));
  tool.options(raster, {.name = "rendering"});
  baselines.declare(tool, choice.method);
}

std::string options_text(Options& options) {
  OptionSet set;
  set.add(options.training.joint);
  set.add<FieldOptions>(options.training.joint);
  options.pipeline.declare(set, {});
  set.add(options.training.sample);
  set.add(options.training.rbf);
  Json values = set.to_json();
  values["quality"] = name_of(kQualityNames, options.choice.quality);
  values["effect"] = options.choice.effect;
  return values.dump();
}

}  // namespace ngs::joint
