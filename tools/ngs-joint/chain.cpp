#include "chain.h"

#include "decide.h"
#include "fingerprint.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/image/photo.h"
#include "ngs/io/ply/query_ply.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/problem/coarse_input.h"
#include "ngs/passes/joint/first_queries.h"
#include "ngs/stages/boundary/variance_stage.h"
#include "ngs/problem/view_list.h"
#include "prepare.h"
#include "shared/checkpoints.h"
#include "unused.h"

namespace ngs::joint {
namespace {

void refuse_if(bool wrong, const std::string& what, const std::string& remedy) {
  if (wrong) throw Error(ErrorCode::kUsage, what, remedy);
}

/// Whether the edges stage has anything to do: where it has no epochs, it has none for any number of views.
bool refines_contours(const Settings& settings) { return contour_epochs(settings.edge, settings.joint.quality, 1) > 0; }

void check(cli::Run& run, const Declared& declared, const Paths& paths) {
  const RunOptions& o = declared.settings.run;
  refuse_if(o.resume && o.checkpoint.empty(), "--resume without --checkpoint, expected the folder to go on from",
            "--checkpoint DIR");
  refuse_if(o.checkpoint_every > 0 && o.checkpoint.empty(),
            "--checkpoint-every without --checkpoint, expected the folder to write to", "--checkpoint DIR");
  refuse_if(o.trace_every > 0 && paths.trace.empty() && o.target.empty(),
            "--trace-every without --trace or --target, expected what the scores are for", "--trace FILE");
  const int features = declared.settings.joint.hash_features;
  refuse_if(!are_hash_features(features), "--hash-features: " + std::to_string(features) + ", expected 1, 2, 4 or 8",
            "2 is the default; --hash-levels adds resolutions");
  refuse_if(!paths.nerf.empty() && mode_of("nerf", declared.settings.joint.effect) == EffectMode::kOff,
            "--nerf with nerf off by --effect, expected a field to write", "leave out one of them");
  refuse_if(!paths.nerf.empty() && o.method == Method::kPaper && mode_of("joint", declared.settings.joint.effect) == EffectMode::kOff,
            "--nerf with joint off by --effect, expected steps that train the field", "leave out one of them");
  if (o.method != Method::kPaper && run.device_exec().device_ops != nullptr)
    throw Error(ErrorCode::kEnvironment, "--device cuda: only --method paper has a CUDA path", "use --device cpu");
  if (o.fast_atomics) run.sum_atomically();
  if (const std::string unused = unused_flags(declared, paths); !unused.empty())
    run.monitor().warn(unused + ": not used by --method " + method_name(o.method));
  if (o.method == Method::kPaper && !refines_contours(declared.settings) &&
      mode_of("contours", declared.settings.joint.effect) == EffectMode::kOn)
    run.monitor().warn("--effect contours=on with --quality draft, which has no epochs for them: they are left out; --contour-epochs N gives "
                       "some");
}

/// What the command line decides without naming an effect.
std::vector<EffectVerdict> ruled_by_options(const Settings& settings, const Paths& paths) {
  std::vector<EffectVerdict> ruled;
  if (settings.run.method != Method::kPaper)
    for (const std::string_view name : kMendingEffects)  // the methods beside it are as their papers say
      ruled.push_back({name, false, "part of --method paper"});
  if (!paths.nerf.empty()) ruled.push_back({"nerf", true, "--nerf"});
  if (!refines_contours(settings)) ruled.push_back({"contours", false, "no epochs: --quality draft without --contour-epochs"});
  if (settings.edge.iterations == 1) ruled.push_back({"contour-iterations", false, "--contour-iterations 1"});
  if (settings.edge.split_px < ContourOptions{}.split_px)  // less than what its detector looks for
    ruled.push_back({"split", true, "--contour-split"});
  return ruled;
}

/// Whether an effect may be on, as far as that is known without a look at the scene that would itself take time.
bool may_be_on(std::string_view name, const Problem& input, const Decisions& decisions) {
  if (const std::optional<bool> said = decisions.said(name)) return *said;
  if (name == "nerf") return photo_count(input.scene, input.views) == 0;
  if (name == "contours") return photo_count(input.scene, input.views) > 0;
  return name != "exposure" || !photo_views(input.scene).empty();
}

/// Nothing is cut where there was nothing to leave out, or where --effect insists.
void leave_out(std::string_view name, const Problem& input, const Settings& settings, Budget& budget, Decisions& decisions) {
  const bool insisted = mode_of(name, settings.joint.effect) != EffectMode::kAuto;
  if (!insisted && may_be_on(name, input, decisions)) budget.note_cut();
  decisions.rule({name, false, "--time-budget has no room for it"});
}

/// What the time that is left decides before the steps.
void rule_by_time(Budget& budget, const Settings& settings, const Problem& input, Decisions& decisions) {
  const std::size_t views = input.scene.views.size();
  for (const std::string_view name : {"exposure", "mask-outliers"})
    if (!budget.fits(kMaskOutliersCost, views)) leave_out(name, input, settings, budget, decisions);
  if (!budget.fits(kDraftFloatersCost, views)) leave_out("floaters", input, settings, budget, decisions);
}

/// What it decides of steps and edges. False: of nothing that is left could a detector say more.
bool rule_steps_by_time(Budget& budget, const Settings& settings, const Problem& input,
                        Decisions& decisions) {
  if (!budget.given()) return true;
  JointOptions planned = settings.joint;  // no time is kept for a field that photos make needless
  if (!may_be_on("nerf", input, decisions)) planned.effect.emplace_back("nerf=off");
  const TimePlan plan = budget.plan(planned, settings.edge, input.scene, input.views.size());
  const bool steps = plan.steps && budget.fits(kDetectorsCost, input.views.size());
  if (!steps) leave_out("joint", input, settings, budget, decisions);
  if (!plan.field) leave_out("nerf", input, settings, budget, decisions);
  if (plan.contour_iterations == 0 && contour_epochs(settings.edge, settings.joint.quality, input.scene.views.size()) > 0)
    leave_out("contours", input, settings, budget, decisions);
  return steps || plan.contour_iterations > 0;
}

/// A method beside the paper's, start to end. What a signal leaves of it is no result.
int run_other(cli::Run& run, const Declared& declared, const Problem& input, const Source& source,
              const std::string& path) {
  const Method method = declared.settings.run.method;
  run.info("method " + method_name(method) + " begins");
  const Solution result = run_beside(run, method, declared.methods, input);
  if (const int stopped = run.stop_code()) return stopped;
  write_result(run, source, result, path);
  return result.converged ? cli::kDone : cli::kBudgetHit;
}

}  // namespace

int run_chain(cli::Run& run, const Declared& declared, const Paths& paths) {
  const Settings& settings = declared.settings;
  check(run, declared, paths);
  Budget budget(declared.start_s, parse_budget(settings.run.time_budget));
  parse_target(settings.run.target);
  Decisions decisions(settings, ruled_by_options(settings, paths), paths.effects_from);
  if (!paths.nerf.empty() && settings.run.method == Method::kPaper && decisions.said("joint") == false)
    throw Error(ErrorCode::kInconsistent, paths.effects_from + ": decided joint=off, expected steps that train the field of --nerf",
                "leave out --nerf, or add --effect joint=on");
  Scene scene = with_objects(io::read_scene_json(paths.scene), settings.run.objects);
  choose_background(settings.run.background, run.monitor(), scene);
  const double reads_s = wall_seconds();
  const io::GaussianPly ply = io::read_gaussian_ply(paths.boundary);
  const double reading_s = wall_seconds() - reads_s;
  const Problem from_files{
      .cloud = ply.cloud,
      .scene = scene,
      .views = training_views(scene),
      .load_masks = [&](std::size_t view) { return io::load_masks(scene, view); },
      .load_photo = [&](std::size_t view) { return io::load_photo(scene, view); },
      .splat = splat_options(declared.raster, ply.cloud, scene),
      .background = background_of(scene),
      .seed = run.seed(),
      .fixed = ply.fixed,
      .labels = labels_of(ply, scene),
      .load_fine_photo = [&](std::size_t view) { return io::load_fine_photo(scene, view); }};
  Json plan = {{"training_views", from_files.views.size()},
               {"gaussians", ply.cloud.size()}};
  if (run.dry_run()) {
    run.plan(std::move(plan));
    return 0;
  }
  if (const std::string& folder = settings.run.checkpoint;
      !folder.empty() && settings.run.method == Method::kPaper && !settings.run.explain)
    cli::require_checkpoint_folder(folder, Checkpoint::path_in(folder));
  if (from_files.views.empty())
    throw Error(ErrorCode::kInconsistent, paths.scene + ": no training view, expected at least one", "hold out fewer views");
  budget.measure(run.exec(), from_files, reading_s);
  rule_by_time(budget, settings, from_files, decisions);
  const CoarseInput kept(from_files, 1), coarse(kept.get(), decision_shrink(scene));
  if (settings.run.method == Method::kPaper && budget.fits(kLoadCost, scene.views.size())) {
    const auto timed = run.monitor().scope("load views");
    // A disk may be slower than any foresight: what is left to load then costs what the rest is foreseen to.
    const double began_s = budget.elapsed_s(), until_s = began_s + kLoadCost.share * budget.left_s();
    const auto in_time = [&] { return budget.elapsed_s() < until_s; };
    const double loaded = kept.preload(run.exec(), in_time);
    if (loaded < 1)
      for (const std::string_view name : kMendingEffects) leave_out(name, from_files, settings, budget, decisions);
    else
      coarse.preload(run.exec()), compare_with_photos(run, coarse.get());
    budget.took(kLoadCost.name, loaded * kLoadCost.renders * double(scene.views.size()), budget.elapsed_s() - began_s);
  }
  decisions.decide(run, EffectPhase::kBefore, coarse.get());
  // The stages below end early on a signal. What they then leave is nothing to go on from, and no checkpoint.
  if (const int stopped = run.stop_code()) return stopped;
  const bool mend = !settings.run.explain;
  const bool keeps = mend && settings.run.method == Method::kPaper && !settings.run.checkpoint.empty();
  const StateSource state{run, declared, paths, scene, decisions};
  const Json known = keeps ? known_of_state(state) : Json();
  const auto kept_plan = keeps && settings.run.resume ? Checkpoint::floaters_in(settings.run.checkpoint, known) : std::nullopt;
  const auto exposures =
      mend && decisions.on("exposure") ? handle_exposure(run, coarse.get()) : std::vector<ViewExposure>{};
  const Problem read = with_levelled_photos(kept.get(), exposures);
  const MaskOutliers trust = mend && decisions.on("mask-outliers") ? handle_mask_outliers(run, coarse.get()) : MaskOutliers{};
  if (const int stopped = run.stop_code()) return stopped;
  const Problem believed = with_consistent_masks(run, read, trust);
  const FloaterOutcome clean = mend && decisions.on("floaters")
                                   ? handle_floaters(run, believed, settings.joint.quality, budget, kept_plan)
                                   : FloaterOutcome{};
  if (const int stopped = run.stop_code()) return stopped;
  Problem input = without_floaters(believed, clean);
  const bool components = mend && decisions.on("components") && release_disconnected(run, input);
  const Source source{ply, scene, clean.floater};
  if (settings.run.method != Method::kPaper && mend) return run_other(run, declared, input, source, paths.labelled);
  const bool detects = rule_steps_by_time(budget, settings, input, decisions);
  {
    const auto lap = budget.lap(kDetectorsCost, detects ? input.views.size() : 0);
    decisions.decide(run, EffectPhase::kSteps, input);
  }
  if (const int stopped = run.stop_code()) return stopped;
  if (!mend) {
    plan["effects"] = decisions.json();
    run.plan(std::move(plan));
    run.text(decision_table(decisions));
    return 0;
  }
  decisions.warn_of_needs(run);
  warn_unused(run, declared, decisions);
  const bool writes_nerf = decisions.on("nerf");
  if (!writes_nerf && !paths.nerf.empty())
    run.monitor().warn(paths.nerf + ": not written, there is no room for the steps that train the field; --time-budget with more");
  input.splat.antialiased = input.splat.antialiased && decisions.on("antialias");
  std::optional<QueryField> given;
  if (!paths.field.empty()) {
    const std::string_view unread = !decisions.on("nerf")       ? "nerf=off"
                                    : clean.removed() || components ? "it holds points of what was taken out"
                                                                : "";
    if (unread.empty()) {
      given = io::read_query_ply(paths.field);
      require_grids(*given, input.cloud, paths.field);
    } else {
      run.info("--field is not read: " + std::string(unread));
    }
  }
  return optimise(run, decisions,
                  {input,
                   given ? &*given : nullptr,
                   source,
                   {settings.run.checkpoint, keeps ? fingerprint(known, state, clean.plan, given.has_value()) : ""},
                   budget},
                  {paths.labelled, writes_nerf ? paths.nerf : "", paths.trace});
}

}  // namespace ngs::joint
