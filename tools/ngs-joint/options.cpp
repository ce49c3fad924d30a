#include "options.h"

#include <cmath>
#include <span>
#include <stdexcept>

#include "ngs/core/error.h"
#include "ngs/core/parse_number.h"
#include "ngs/options/name_of.h"
#include "ngs/options/strict_json.h"
#include "shared/text/text_file.h"

namespace ngs::joint {
namespace {

/// Runs bce and reports its loss and certified gap over time, one list per object.
Solution bce_with_trace(cli::Run& run, const BceOptions& options, const Problem& problem) {
  BceResult result = solve_bce(run.exec(), run.monitor(), options, problem);
  for (const std::vector<GapPoint>& object : result.trace) {
    Json points = Json::array();
    for (const GapPoint& p : object)
      points.push_back({{"t", p.seconds}, {"loss", p.loss}, {"gap", p.gap}, {"certified", p.certified}});
    run.result()["gap_over_time"].push_back(std::move(points));
  }
  return std::move(result.method);
}

/// The method recorded in the report; empty: none.
std::string method_of(const Json& report) {
  const Json options = report.is_object() ? report.value("options", Json()) : Json();
  const Json method = options.is_object() ? options.value("method", Json()) : Json();
  return method.is_string() ? method.get<std::string>() : "";
}

/// The decisions recorded in the report; empty if there are none.
Json effects_of(const Json& report) {
  const Json result = report.is_object() ? report.value("result", Json()) : Json();
  const Json effects = result.is_object() ? result.value("effects", Json()) : Json();
  return effects.is_array() ? effects : Json::array();
}

std::vector<FixedDecision> replayed(const std::string& path, const Options& options) {
  const Json report =
      parse_strict_json<Json>(cli::read_text_file(path, ErrorCode::kBadInput), path, ErrorCode::kBadInput);
  const std::string ran = method_of(report), wanted = method_name(options.choice.method);
  if (!ran.empty() && ran != wanted)  // effects that a method does not use are recorded as off
    throw Error(ErrorCode::kInconsistent, path + ": decisions of --method " + ran + ", expected those of " + wanted,
                "give the report of a run of this method");
  const std::vector<Effect> effects = options.pipeline.effects();
  std::vector<FixedDecision> decisions;
  for (const Json& entry : effects_of(report)) {
    const Json name = entry.is_object() ? entry.value("name", Json()) : Json(),
               on = entry.is_object() ? entry.value("on", Json()) : Json();
    if (!name.is_string() || !on.is_boolean()) continue;
    if (const Effect* known = find_effect(effects, name.get<std::string>()))
      decisions.push_back({known->name, on.get<bool>(), "--effects-from", "replayed"});
  }
  if (decisions.empty())
    throw Error(ErrorCode::kBadInput, path + ": no decisions on effects, expected a report of ngs-joint",
                "write one: ngs-joint ... --report FILE");
  return decisions;
}

using FixedDecisions = std::vector<FixedDecision>;

std::string mode_of(const Effect& effect, const FixedDecisions& fixed) {
  for (const FixedDecision& decision : fixed)
    if (decision.name == effect.name) return decision.on ? "on" : "off";
  return effect.always.empty() ? "auto" : "on";
}

std::string row(std::string name, std::string mode, std::string_view help) {
  name.resize(23, ' ');
  mode.resize(6, ' ');
  return name + mode + std::string(help) + "\n";
}

std::string part_rows(std::span<const Effect> parts, const FixedDecisions& fixed) {
  std::string text;
  for (const Effect& part : parts) text += row("    " + std::string(part.name), mode_of(part, fixed), part.help);
  return text;
}

/// One line per switch value, with the names of the parts that have it.
std::string part_names(std::span<const Effect> parts, const FixedDecisions& fixed) {
  std::string text;
  for (const char* mode : {"auto", "on", "off"}) {
    std::string names;
    for (const Effect& part : parts)
      if (mode_of(part, fixed) == mode) names += (names.empty() ? "" : " ") + std::string(part.name);
    if (!names.empty()) text += row("    parts", mode, names);
  }
  return text;
}

}  // namespace

std::string method_name(Method method) { return name_of(kMethodNames, method); }

void BaselineOptions::declare(cli::Tool& tool, const Method& method) {
  const auto group = [&](Method one, std::string_view cites) {
    const std::string name = method_name(one);
    return OptionGroup{
        .name = name,
        .about = std::string(cites),
        .applies = [&method, one] { return method == one || (one == Method::kCob && method == Method::kReleased); },
        .needs = "--method " + name};
  };
  tool.options(flash, group(Method::kFlash, "FlashSplat, closed form"));
  tool.options(sa3d, group(Method::kSa3d, "SA3D-GS, closed form"));
  tool.options(bce, group(Method::kBce, "optimal labels of unchanged Gaussians"));
  tool.options(cob, group(Method::kCob, "COB-GS"));
  tool.options(saga, group(Method::kSaga, "SAGA features from masks"));
  tool.options(released, group(Method::kReleased, "the published NG-GS code"));
}

Solution run_baseline(cli::Run& run, Method method, const BaselineOptions& options, const Problem& problem) {
  switch (method) {
    case Method::kFlash: return run_flash(run.exec(), run.monitor(), options.flash, problem);
    case Method::kSa3d: return run_sa3d(run.exec(), run.monitor(), options.sa3d, problem);
    case Method::kBce: return bce_with_trace(run, options.bce, problem);
    case Method::kCob: return run_cob(run.exec(), run.monitor(), options.cob, problem);
    case Method::kSaga: return run_saga(run.exec(), run.monitor(), options.saga, problem);
    case Method::kReleased: {
      ReleasedOptions released = options.released;
      released.cob = options.cob;  // the method is cob with an extra loss term
      return run_released(run.exec(), run.monitor(), released, problem);
    }
    case Method::kNgs:
    case Method::kNgGs: break;
  }
  throw std::logic_error("ngs and ng-gs are no baselines");
}

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

std::vector<FixedDecision> fixed_decisions_of(const Options& options, const std::string& effects_from) {
  std::vector<FixedDecision> decisions;
  const auto fix_off = [&](std::string_view effect) { decisions.push_back({effect, false, "part of --method ngs"}); };
  if (options.choice.method != Method::kNgs)  // the other methods run as published
    for (const PassStage stage : {PassStage::kCrop, PassStage::kRepair})
      for (const Effect& effect : options.pipeline.effects(stage)) fix_off(effect.name);
  if (options.choice.method == Method::kNgGs) {
    fix_off(kContoursEffect);
    decisions.push_back({kNerfEffect, true, "--method ng-gs"});
  }
  for (FixedDecision& decision : options.pipeline.fixed_decisions(options.training))
    decisions.push_back(std::move(decision));
  if (!effects_from.empty())
    for (FixedDecision& decision : replayed(effects_from, options)) decisions.push_back(std::move(decision));
  if (options.choice.method == Method::kNgGs) decisions.push_back({kJointEffect, true, "--method ng-gs"});
  return decisions;
}

std::string effects_help(const Options& options, bool in_full) {
  const FixedDecisions fixed = fixed_decisions_of(options, "");
  std::string text = "effects: --effect NAME=auto|on|off; auto: decided from the scene (--explain lists why)\n";
  for (const std::unique_ptr<Pass>& pass : options.pipeline.passes()) {
    if (pass->traits.stage != PassStage::kRepair && !options.runs_passes()) continue;
    const std::vector<Effect> effects = pass->effects();
    const auto parts = std::span(effects).subspan(1);
    text += row("  " + std::string(effects[0].name), mode_of(effects[0], fixed), effects[0].help);
    text += in_full ? part_rows(parts, fixed) : part_names(parts, fixed);
  }
  return text;
}

}  // namespace ngs::joint
