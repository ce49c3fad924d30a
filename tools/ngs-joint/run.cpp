#include "run.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "labelled_result.h"
#include "memory_plan.h"
#include "ngs/capture/scene_check.h"
#include "ngs/core/error.h"
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/cut/passes/pipeline.h"
#include "ngs/field/joint_field.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/content_hash.h"
#include "ngs/io/formats/splat_format.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/image/photo.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/ply/query_ply.h"
#include "ngs/math/median.h"
#include "ngs/problem/coarse_input.h"
#include "ngs/problem/problem.h"
#include "ngs/problem/view_list.h"
#include "options.h"
#include "shared/os/machine.h"
#include "shared/run/checkpoints.h"
#include "shared/run/run.h"
#include "shared/scene/scene_model.h"
#include "step_files.h"

namespace ngs::joint {
namespace {

/// PSNR gain of the model over a constant colour, dB, median of three views; nullopt without photos or after a stop.
std::optional<double> gain_over_constant(cli::Run& run, const Problem& problem, const GaussianCloud& cloud) {
  constexpr std::size_t kViews = 3;
  const std::vector<std::size_t> with_photo = photo_views(problem.scene);
  std::vector<double> gains_db;
  for_each_view(&run.monitor(), spread_views(with_photo, kViews), [&](std::size_t, std::size_t v) {
    const Camera& camera = problem.scene.views[v].camera;
    gains_db.push_back(match_photo(run.exec(), cloud, {camera, problem.load_photo(v)}, problem.splat).gain_db());
  });
  if (gains_db.empty() || run.monitor().stop_requested()) return std::nullopt;
  return upper_median(std::move(gains_db));
}

/// Throws kInconsistent if the model in the file `path` matches the photos worse than import requires while the scene's
/// own model matches them: it belongs to another scene. Warns if neither matches, as after an import with a lower
/// bound.
void compare_with_photos(cli::Run& run, const Problem& problem, const std::string& path) {
  const auto timed = run.monitor().scope("compare with photos");
  const double least_db = SceneCheckOptions{}.min_fit_db;
  const std::optional<double> gain_db = gain_over_constant(run, problem, problem.cloud);
  if (!gain_db || *gain_db >= least_db) return;
  char text[160];
  std::snprintf(text, sizeof text,
                "the rendered model matches the photos %.1f dB above a constant colour, expected at least %.1f",
                std::abs(*gain_db) < 0.05 ? 0.0 : *gain_db, least_db);
  const std::string& own = problem.scene.model_path;
  std::error_code absent;
  if (!std::filesystem::is_regular_file(own, absent))
    return run.monitor().warn(std::string(text) + ": it may belong to another scene");
  const std::optional<double> own_db = gain_over_constant(run, problem, io::read_gaussian_ply(own).cloud);
  if (!own_db) return;
  if (*own_db < least_db) return run.monitor().warn(std::string(text) + ", and so does the scene's own model, " + own);
  throw Error(
      ErrorCode::kInconsistent, path + ": " + text + ": it belongs to another scene, " + own + " matches the photos",
      "give the labelled PLY that ngs-variance writes for this scene.json, or import the scene with this model: "
      "ngs-scene import ... --ply");
}

void usage_error_if(bool wrong, const std::string& what, const std::string& remedy) {
  if (wrong) throw Error(ErrorCode::kUsage, what, remedy);
}

void check_options(cli::Run& run, const Options& options, const Paths& paths) {
  const StepOptions& o = options.steps;
  usage_error_if(o.resume && o.checkpoint.empty(),
                 "--resume without --checkpoint, expected the folder to continue from", "--checkpoint DIR");
  usage_error_if(o.checkpoint_every > 0 && o.checkpoint.empty(),
                 "--checkpoint-every without --checkpoint, expected the folder to write to", "--checkpoint DIR");
  usage_error_if(o.trace_every > 0 && paths.trace.empty() && o.target.empty(),
                 "--trace-every without --trace or --target, expected one of them", "--trace FILE");
  if (!options.runs_passes()) run.needs_cpu("only --method ngs and ng-gs have a CUDA path");
  if (o.fast_atomics) run.sum_atomically();
}

/// Warns about files, effects and a quality that a baseline does not use.
void warn_of_baseline(cli::Run& run, const Options& options, const Paths& paths) {
  if (options.runs_passes()) return;
  std::vector<std::string> unused;
  const auto file = [&](const char* flag, const std::string& path) {
    if (!path.empty()) unused.push_back(flag);
  };
  file("--field", paths.field);
  file("--trace", paths.trace);
  const EffectSwitches switches(options.pipeline.effects(), options.choice.effect);
  if (options.choice.quality != MethodChoice{}.quality && switches.of("floaters") != Switch::kOn)
    unused.push_back("--quality");  // it sets the thoroughness of the floater search
  const std::vector<Effect> effects = options.pipeline.effects(PassStage::kRepair);
  for (const std::string& entry : options.choice.effect)
    if (const std::string name = entry.substr(0, entry.find('='));
        name != "all" && find_effect(effects, name) == nullptr)
      unused.push_back("--effect " + entry);
  std::string text;
  for (const std::string& flag : unused) text += (text.empty() ? "" : ", ") + flag;
  if (!text.empty()) run.monitor().warn(text + ": not used by --method " + method_name(options.choice.method));
}

struct LoadedInputs {
  Scene scene;
  io::GaussianPly ply;
  SharedLabels labels;
  std::shared_ptr<const std::vector<float>> weight;
  double reading_s = 0;

  LoadedInputs(cli::Run& run, const Options& options, const Paths& paths)
      : scene(with_objects(cli::read_scene(run, paths.scene), options.choice.objects)) {
    choose_background(options.choice.background, run.monitor(), scene);
    const double began_s = wall_seconds();
    ply = io::read_gaussian_ply(paths.boundary);
    labels = take_labels(ply, scene);
    if (!ply.weight.empty()) weight = std::make_shared<const std::vector<float>>(std::move(ply.weight));
    reading_s = wall_seconds() - began_s;
  }
  Problem problem(const Options& options, std::uint64_t seed, Monitor& monitor) const {
    return {.cloud = ply.cloud,
            .scene = scene,
            .views = training_views(scene),
            .load_masks = [this](std::size_t view) { return io::load_masks(scene, view); },
            .load_photo = [this](std::size_t view) { return io::load_photo(scene, view); },
            .splat = splat_options(options.raster, ply.cloud, scene),
            .background = background_of(scene),
            .seed = seed,
            .fixed = ply.fixed,
            .labels = labels,
            .rule = ply.rule.value_or(BoundaryRule()),
            .weight = weight,
            .load_fine_photo = [this](std::size_t view) { return io::load_fine_photo(scene, view); },
            .monitor = &monitor};
  }
};

/// Decodes photos and masks into the caches at both sizes. Views that do not fit into the time are loaded on demand.
void load_views(cli::Run& run, Budget& budget, const CoarseInput& full, const CoarseInput& coarse) {
  const auto timed = run.monitor().scope("load views");
  const double until_s = budget.deadline_s(kLoadShare);
  if (full.preload(run.exec(), [&] { return wall_seconds() < until_s; }) >= 1) coarse.preload(run.exec());
}

/// Inputs and options that determine the state of the joint steps, as far as known before the passes run.
Json identity_of(cli::Run& run, Options& options, const Paths& paths, const Scene& scene) {
  OptionSet raster;
  raster.add(options.raster);
  Json objects = Json::array();
  for (const SceneObject& object : scene.objects) objects.push_back(object.name);
  return {{"scene", io::content_hash(paths.scene).xxh3},
          {"boundary", io::content_hash(paths.boundary).xxh3},
          {"masks", cli::masks_hash(scene)},
          {"photos", cli::photos_hash(scene)},
          {"options", options_text(options)},
          {"raster", raster.to_json()},
          {"background", options.choice.background},
          {"objects", objects},
          {"seed", run.seed()},
          {"fast_atomics", options.steps.fast_atomics}};
}

class MethodRun {
 public:
  MethodRun(cli::Run& run, Options& options, const Paths& paths, double start_s)
      : run_(run),
        options_(options),
        paths_(paths),
        budget_(start_s, options.steps.budget_s()),
        switches_(options.pipeline.effects(), options.choice.effect),
        decisions_(options.pipeline.effects(), switches_, fixed_decisions_of(options, paths.effects_from)),
        input_(run, options, paths),
        store_(run.monitor(), {options.steps.checkpoint, options.steps.resume, options.steps.checkpoint_every}) {}

  int operator()() {
    Problem from_files = input_.problem(options_, run_.seed(), run_.monitor());
    if (run_.dry_run()) return plan(from_files);
    run_.needs_device_memory(cli::device_bytes(double(from_files.cloud.size()), from_files.cloud.rest_count()));
    if (renders_views(options_.choice.method)) from_files.splat.prepared = prepare_cloud(run_.exec(), from_files.cloud);
    if (writes_checkpoints())
      cli::require_checkpoint_folder(options_.steps.checkpoint, StepFile::path_in(options_.steps.checkpoint));
    if (from_files.views.empty())
      throw Error(ErrorCode::kInconsistent, paths_.scene + ": no training view, expected at least one",
                  "hold out fewer views");
    PassRun passes = pass_run(from_files);
    Json identity = writes_checkpoints() ? identity_of(run_, options_, paths_, input_.scene) : Json();
    if (writes_checkpoints()) restore_decisions(passes, identity);
    options_.pipeline.decide(PassStage::kCrop, passes, from_files);
    if (!options_.pipeline.run(PassStage::kCrop, passes)) return run_.stop_code();
    const Problem cropped = *passes.problem;
    budget_.reserve_for_writing(input_.reading_s);
    CoarseInput full(cropped, 1), coarse(full.get(), decision_shrink(input_.scene));
    passes.problem.emplace(full.get());
    passes.coarse = &coarse.get();
    if (options_.runs_passes()) {
      load_views(run_, budget_, full, coarse);
      compare_with_photos(run_, CoarseInput(from_files, decision_shrink(input_.scene), 0).get(), paths_.boundary);
    }
    options_.pipeline.decide(PassStage::kRepair, passes, coarse.get());
    if (const int stopped = run_.stop_code()) return stopped;  // no state worth a checkpoint yet
    if (options_.choice.explain) return explain(passes, from_files);
    if (writes_checkpoints()) {
      identity["effects"] = stored_decisions(options_.pipeline, decisions_);
      store_.resumed(identity);  // again: the decisions may differ from those of the checkpoint
    }
    if (!options_.pipeline.run(PassStage::kRepair, passes)) return run_.stop_code();
    coarse.clear_cache();  // the decisions that need it have been made
    os::release_freed_memory();
    return options_.runs_passes() ? optimise(passes, std::move(identity), full) : baseline(passes);
  }

 private:
  bool writes_checkpoints() const {
    return !options_.steps.checkpoint.empty() && options_.runs_passes() && !options_.choice.explain;
  }

  void restore_decisions(PassRun& passes, const Json& identity) {
    const std::optional<Json>& before = store_.resumed(identity);
    if (!before) return;
    const Json state = before->value("passes", Json());
    passes.resume.before = state.is_object() ? state : Json::object();
    repeat_decisions(options_.pipeline, passes, before->value("effects", Json()), before->value("left_out", Json()));
  }

  Json plan_json(const Problem& problem) const {
    return {{"training_views", problem.views.size()}, {"gaussians", problem.cloud.size()}};
  }

  int plan(const Problem& problem) {
    Json plan = plan_json(problem);
    plan.update(memory_plan(problem));
    run_.plan(std::move(plan));
    return cli::kDone;
  }

  PassRun pass_run(const Problem& problem) {
    PassRun passes{.exec = run_.exec(),
                   .monitor = run_.monitor(),
                   .training = options_.training,
                   .decisions = decisions_,
                   .budget = budget_,
                   .report = run_.result(),
                   .info = [this](const std::string& line) { run_.info(line); },
                   .optimisation = {.tracking = {options_.steps.agreement_target(), !paths_.trace.empty(),
                                                 options_.steps.trace_every},
                                    .allow_empty = run_.allow_empty()}};
    passes.problem.emplace(problem);
    return passes;
  }

  int explain(PassRun& passes, const Problem& problem) {
    if (options_.runs_passes()) options_.pipeline.decide(PassStage::kOptimise, passes, *passes.problem);
    if (const int stopped = run_.stop_code()) return stopped;
    Json plan = plan_json(problem);
    plan["effects"] = decisions_.json();
    run_.plan(std::move(plan));
    run_.text(decisions_.table());
    return cli::kDone;
  }

  /// Runs a baseline. After a signal it writes no result.
  int baseline(PassRun& passes) {
    run_.info("method " + method_name(options_.choice.method) + " begins");
    const Solution solution = run_baseline(run_, options_.choice.method, options_.baselines, *passes.problem);
    if (const int stopped = run_.stop_code()) return stopped;
    write_result(run_, {input_.ply, input_.scene, input_.labels, passes.floater}, solution, paths_.labelled);
    return solution.converged ? cli::kDone : cli::kBudgetHit;
  }

  /// The query field of --field, if the NeRF is on and the field still belongs to the model.
  std::optional<QueryField> read_field(const PassRun& passes) {
    if (paths_.field.empty()) return std::nullopt;
    const bool matches_model = passes.floater.empty() && passes.problem->frozen.empty();
    const std::string_view unread = !passes.on(kNerfEffect) ? "nerf=off"
                                    : !matches_model        ? "it has query points of removed Gaussians"
                                                            : "";
    if (!unread.empty()) {
      run_.info("--field is not read: " + std::string(unread));
      return std::nullopt;
    }
    std::optional<QueryField> field = io::read_query_ply(paths_.field);
    require_grids(*field, passes.problem->cloud, paths_.field);
    return field;
  }

  int optimise(PassRun& passes, Json identity, CoarseInput& views) {
    options_.pipeline.decide(PassStage::kOptimise, passes, *passes.problem);
    if (const int stopped = run_.stop_code()) return stopped;
    run_.warn_unused([&](std::string_view effect) { return decisions_.on(effect); });
    const std::optional<QueryField> field = read_field(passes);
    passes.optimisation.field = field ? &*field : nullptr;
    if (writes_checkpoints()) {
      identity["effects"] = stored_decisions(options_.pipeline, decisions_);
      identity["passes"] = passes.resume.state;
      identity["field"] = field ? io::content_hash(paths_.field).xxh3 : "";
      if (!passes.resume.skipped.empty()) identity["left_out"] = passes.resume.skipped;
      store_.identify(identity);
      passes.optimisation.store = &store_;
    }
    if (!options_.pipeline.run(PassStage::kOptimise, passes)) return run_.stop_code();
    views.clear_cache();
    passes.optimisation.trainer.reset();  // unused from here on, and as large as the model
    os::release_freed_memory();
    return write(passes);
  }

  int write(PassRun& passes) {
    const Solution& solution = *passes.solution;
    if (budget_.is_set()) run_.result()["budget"] = budget_.json();
    if (budget_.is_set() && !solution.converged)
      run_.monitor().warn("--time-budget " + options_.steps.time_budget +
                          ": parts were skipped or shortened for lack of time");
    if (passes.optimisation.tracking.target && !passes.optimisation.tracker->target_met())
      run_.monitor().warn("--target " + options_.steps.target + ": not reached in the training views");
    write_result(run_, {input_.ply, input_.scene, input_.labels, passes.floater}, solution, paths_.labelled);
    if (!paths_.trace.empty()) io::write_file(paths_.trace, passes.optimisation.tracker->trace());
    return solution.converged ? cli::kDone : cli::kBudgetHit;
  }

  cli::Run& run_;
  Options& options_;
  const Paths& paths_;
  Budget budget_;
  EffectSwitches switches_;
  Decisions decisions_;
  LoadedInputs input_;
  StepFile store_;
};

}  // namespace

int run_method(cli::Run& run, Options& options, const Paths& paths, double start_s) {
  options.training.joint.quality = options.choice.quality;
  io::require_ply_output(paths.labelled);
  check_options(run, options, paths);
  warn_of_baseline(run, options, paths);
  return MethodRun(run, options, paths, start_s)();
}

}  // namespace ngs::joint
