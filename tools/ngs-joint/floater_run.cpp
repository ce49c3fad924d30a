#include "floater_run.h"

namespace ngs::joint {

bool floaters_wanted(const Settings& settings) {
  const bool wanted = parse_effects(settings.joint.effect).floaters;
  if (settings.run.method == Method::kPaper) return wanted;
  bool asked = false;
  for (const std::string& entry : settings.joint.effect)
    if (entry.starts_with("floaters=")) asked = entry == "floaters=on";
  return wanted && asked;
}

FloaterOutcome handle_floaters(cli::Run& run, const MethodInput& input) {
  FloaterOutcome outcome;
  const FloaterOptions options;
  const FloaterFinding finding = find_floaters(run.exec(), run.monitor(), options, input);
  Json report = {{"removed", finding.count},
                 {"reason", "the photos show the object behind them"},
                 {"seen_through", options.seen_through}};
  for (const auto& [name, value] : finding.figures) report[name] = value;
  if (finding.count > 0) {
    outcome.removal = remove_floaters(run.exec(), run.monitor(), {}, input, finding);
    outcome.floater.assign(finding.floater.begin(), finding.floater.end());
    for (const auto& [name, value] : outcome.removal.figures) report[name] = value;
    run.info(std::to_string(finding.count) + " floaters before the object were taken out (column ngs_floater)");
  }
  run.result()["floaters"] = report;
  return outcome;
}

MethodInput without_floaters(const MethodInput& input, const FloaterOutcome& outcome) {
  return {.cloud = outcome.removed() ? outcome.removal.cloud : input.cloud,
          .scene = input.scene,
          .views = input.views,
          .load_masks = input.load_masks,
          .load_photo = input.load_photo,
          .splat = input.splat,
          .background = input.background,
          .seed = input.seed,
          .fixed = input.fixed,
          .labels = outcome.removed() ? outcome.removal.labels : input.labels};
}

}  // namespace ngs::joint
