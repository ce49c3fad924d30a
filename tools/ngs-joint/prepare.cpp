#include "prepare.h"

#include "ngs/stages/method_labels.h"

namespace ngs::joint {

bool wanted(const Settings& settings, bool JointEffects::*effect) {
  const bool chosen = parse_effects(settings.joint.effect).*effect;
  if (settings.run.method == Method::kPaper) return chosen;
  bool asked = false;
  for (const EffectName& e : kEffects)
    for (const std::string& entry : settings.joint.effect)
      if (e.member == effect && entry.starts_with(std::string(e.name) + "=")) asked = entry.ends_with("=on");
  return asked;
}

ViewTrust handle_trust(cli::Run& run, const MethodInput& input) {
  ViewTrust trust = judge_views(run.exec(), run.monitor(), {}, input);
  Json names = Json::array();
  for (const std::size_t v : trust.ignored) {
    names.push_back(input.scene.views[v].camera.name);
    run.monitor().warn("the mask of view '" + input.scene.views[v].camera.name +
                       "' contradicts the masks of the other views and is ignored; --effect view-trust=off keeps it");
  }
  Json report = {{"ignored", names}};
  for (const auto& [name, value] : trust.figures) report[name] = value;
  run.result()["view_trust"] = report;
  return trust;
}

MethodInput with_trusted_masks(cli::Run& run, const MethodInput& input, const ViewTrust& trust) {
  MethodInput trusted = input;
  if (trust.ignored.empty()) return trusted;
  trusted.load_masks = [load = input.load_masks, &trust](std::size_t view) {
    return trusted_masks(trust, view, load(view));
  };
  trusted.labels = labels_anew(run.exec(), run.monitor(), trusted, input.cloud);
  return trusted;
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
          .labels = outcome.removed() ? outcome.removal.labels : input.labels,
          .load_fine_photo = input.load_fine_photo};
}

}  // namespace ngs::joint
