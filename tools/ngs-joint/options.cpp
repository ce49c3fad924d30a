#include "options.h"

#include <cmath>

#include "ngs/core/error.h"
#include "ngs/core/parse_number.h"
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

std::optional<AgreementTarget> StepOptions::agreement_target() const {
  if (target.empty()) return std::nullopt;
  const bool boundary = target.starts_with("biou=");
  double value = -1;
  const bool known = boundary || target.starts_with("iou=");
  if (!known || !parse_number(std::string_view(target).substr(target.find('=') + 1), value) ||
      !(value >= 0 && value <= 1))
    throw Error(ErrorCode::kUsage, "--target: '" + target + "', expected biou=X or iou=X with X in [0, 1]");
  return AgreementTarget{boundary, value};
}

std::optional<double> StepOptions::budget_s() const {
  if (time_budget.empty()) return std::nullopt;
  double value = 0;
  const auto [stop, error] = scan_number(time_budget.data(), time_budget.data() + time_budget.size(), value);
  const std::string unit(stop, time_budget.data() + time_budget.size());
  const double seconds = unit == "m" ? 60 : unit == "h" ? 3600 : 1;
  const bool known = unit.empty() || unit == "s" || unit == "m" || unit == "h";
  if (error != std::errc() || !std::isfinite(value) || !(value > 0) || !known)
    throw Error(ErrorCode::kUsage, "--time-budget: '" + time_budget + "', expected a time such as 60s, 5m or 1h");
  return value * seconds;
}

}  // namespace ngs::joint
