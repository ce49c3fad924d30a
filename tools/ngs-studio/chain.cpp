#include "chain.h"

#include <cstdio>
#include <limits>

#include "ngs/core/error.h"
#include "ngs/core/monitor.h"
#include "ngs/math/median.h"
#include "shared/cli/exit_code.h"
#include "shared/os/machine.h"
#include "shared/run/child_process.h"
#include "shared/run/signals.h"

namespace ngs::studio {
namespace {

struct Cancelled {};

std::vector<cli::ChainStep> parts_of(const std::vector<JobStep>& steps) {
  std::vector<cli::ChainStep> parts;
  for (const JobStep& step : steps) {
    parts.push_back({step.words.empty() ? 0 : step.share, !step.words.empty() && step.words[0] == "ngs-joint"});
  }
  return parts;
}

using Words = std::vector<std::string>;

Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

Words outputs_of(const StateFolder& folder, int object, const ExportChoice& choice) {
  const auto at = [&](const std::string& name) { return folder.of(object, name); };
  Words halves{"--object-ply",
               at("object." + choice.format),
               "--background-ply",
               at("background." + choice.format),
               "--labelled",
               at("labelled.ply"),
               "-w"};
  if (!choice.fill) return halves;
  return joined({"--background-filled", at("background-filled." + choice.format)}, halves);
}

/// A ball around everything selects the whole model if it has no labels; the imported edit then decides.
Words import_words(const std::string& labelled, const std::string& selection) {
  return {"ngs-extract", labelled,   "--keep-sphere", "0,0,0,1e18",   "--import",
          selection,     "--unseen", "background",    "--allow-empty"};
}

}  // namespace

Job::Job(std::string kind, std::vector<JobStep> steps, std::function<void()> finished)
    : kind_(std::move(kind)),
      steps_(std::move(steps)),
      finished_(std::move(finished)),
      start_s_(wall_seconds()),
      clock_(parts_of(steps_)) {
  thread_ = os::in_background([this] { work(); });
}

Job::~Job() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

bool Job::is_running() const {
  const std::lock_guard lock(mutex_);
  return state_ == "running";
}

void Job::begin(std::size_t step) {
  const std::lock_guard lock(mutex_);
  stage_ = steps_[step].stage;
  clock_.begin(step, wall_seconds());
}

void Job::progress(const std::string& stage, double fraction) {
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  clock_.update(fraction);
}

bool Job::run_steps() {
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    if (stop_) throw Cancelled{};
    begin(k);
    if (steps_[k].words.empty()) {
      steps_[k].run();
      continue;
    }
    try {
      run_program(steps_[k]);
    } catch (const Error& e) {
      if (steps_[k].if_nothing.empty() || e.code() == ErrorCode::kEnvironment) throw;
      const std::lock_guard lock(mutex_);
      note_ = steps_[k].if_nothing;
      return false;
    }
  }
  return true;
}

void Job::work() {
  std::string state = "done", error;
  try {
    if (run_steps()) finished_();
  } catch (const Cancelled&) {
    state = "cancelled";
  } catch (const Error& e) {
    state = "failed";
    error = e.what() + (e.remedy().empty() ? "" : " (" + e.remedy() + ")");
  } catch (const std::exception& e) {
    state = "failed";
    error = e.what();
  }
  const std::lock_guard lock(mutex_);
  state_ = state;
  error_ = error;
  end_s_ = wall_seconds();
  if (state == "done") clock_.begin(steps_.size(), end_s_);
}

void Job::run_program(const JobStep& step) {
  std::vector<std::string> argv = step.words;
  argv = cli::sibling_command(std::move(argv));
  for (const char* word : {"--log-format", "json"}) argv.emplace_back(word);
  std::string error, hint;
  const auto listen = [&](const std::string& line) {
    const nlohmann::json record = nlohmann::json::parse(line, nullptr, false);
    if (!record.is_object()) return;
    const std::string event = record.value("event", "");
    if (event == "error") error = record.value("message", "");
    if (event == "hint") hint = record.value("message", "");
    const double total = record.value("total", 0.0);
    if (event == "progress" && total > 0)  // people understand the stages of ngs, not those of one program
      progress(step.words[0] == "ngs" ? record.value("stage", step.stage) : step.stage,
               record.value("done", 0.0) / total);
  };
  constexpr double kGrace_s = 2;
  const cli::SignalGrace waits;  // waits until the program has removed its unfinished files
  const cli::ChildResult child = cli::run_child(argv, {.time_s = std::numeric_limits<double>::infinity(),
                                                       .stop = [this] { return stop_.load(); },
                                                       .grace_on_stop_s = kGrace_s,
                                                       .on_line = listen});
  if (child.end == cli::ChildResult::End::kStopped) throw Cancelled{};
  if (child.end == cli::ChildResult::End::kSignalled)
    throw Error(ErrorCode::kEnvironment, step.words[0] + ": ended by signal " + std::to_string(child.code));
  if (child.code != cli::kDone && child.code != cli::kCheckFailed && child.code != cli::kBudgetHit)
    throw Error(ErrorCode(child.code), step.words[0] + ": " + (error.empty() ? child.output_tail : error), hint);
}

nlohmann::ordered_json Job::json() const {
  const std::lock_guard lock(mutex_);
  const bool running = state_ == "running";
  const double now_s = running ? wall_seconds() : end_s_, elapsed_s = now_s - start_s_;
  const double left_s = clock_.left_s(now_s);
  nlohmann::ordered_json remaining;
  if (running && left_s >= 0) remaining = left_s;
  return {{"kind", kind_},
          {"stage", stage_},
          {"done", clock_.done(now_s)},
          {"elapsed_s", elapsed_s},
          {"remaining_s", remaining},
          {"state", state_},
          {"error", error_.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(error_)},
          {"note", note_.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(note_)}};
}

std::vector<Words> export_words(const StateFolder& folder, int object, const ExportChoice& choice) {
  const auto at = [&](const std::string& name) { return folder.of(object, name); };
  Words extract{"ngs-extract", at("flash.ply"), "--unseen", "background", "--scene", at("scene.json")};
  if (!choice.all_pieces) extract = joined(extract, {"--strokes", at("strokes.json")});
  return {{"ngs-variance", at("scene.json"), "-o", at("boundary.ply"), "-w"},
          {"ngs-joint", at("scene.json"), at("boundary.ply"), "--method", "flash", "-o", at("flash.ply"), "-w"},
          joined(extract, outputs_of(folder, object, choice))};
}

std::vector<Words> selection_words(const StateFolder& folder, int object, const std::string& labelled,
                                   const ExportChoice& choice) {
  return {joined(import_words(labelled, folder.of(object, "selection.ply")), outputs_of(folder, object, choice))};
}

Words common_background_words(const StateFolder& folder, const std::string& model, const ExportChoice& choice) {
  return joined(import_words(model, folder.at("objects.ply")),
                {"--background-ply", folder.at("background." + choice.format), "-w"});
}

std::vector<Words> convert_words(const StateFolder& folder, int object, const ExportChoice& choice) {
  const auto at = [&](const std::string& name) { return folder.of(object, "cut/" + name); };
  std::vector<Words> words;
  if (choice.format != "ply")
    for (const std::string side : {"object.", "background."})  // a ball around everything: the whole model
      words.push_back({"ngs-extract", at(side + "ply"), "--keep-sphere", "0,0,0,1e18", "--allow-empty", "--object-ply",
                       at(side + choice.format), "-w"});
  if (choice.fill)
    words.push_back({"ngs-extract", at("labelled.ply"), "--unseen", "background", "--background-filled",
                     at("background-filled." + choice.format), "-w"});
  return words;
}

Words mesh_words(const std::string& folder, const ExportChoice& choice) {
  return {"ngs-mesh",
          folder + "/object." + choice.format,
          "--background",
          folder + "/background." + choice.format,
          "--collider",
          "convex:8",
          "-o",
          folder + "/mesh.glb",
          "-w"};
}

std::vector<Words> refine_words(const StateFolder& folder, int object, const RefineChoice& choice) {
  const auto at = [&](const char* name) { return folder.of(object, name); };
  std::vector<Words> words;
  if (!choice.source.empty()) {
    words.push_back({"ngs-scene", "orbit", choice.source, "-o", at("orbit/scene.json"), "-w"});
    if (!choice.around.empty()) words.back() = joined(words.back(), {"--around", choice.around});
  }
  words.push_back({"ngs", "cut", at("cut.json"), "--strokes", at("marks.json"), "--force", "-o", at("cut"), "-w"});
  const bool quick = choice.quality == kQuickRefine, flash = quick && !choice.source.empty();
  const std::string quality = quick ? "draft" : choice.quality;
  words.back() = joined(words.back(), flash ? Words{"--method", "flash"} : Words{"--quality", quality});
  if (choice.all_pieces) words.back().push_back("--all-pieces");
  return words;
}

namespace {

/// Positions of the selected Gaussians, relative to the cloud's origin.
std::vector<Vec3<double>> selected(const GaussianCloud& cloud, const live::ObjectLabels& labels) {
  std::vector<Vec3<double>> members;
  members.reserve(std::size_t(labels.count));
  for (std::size_t i = 0; i < labels.label.size(); ++i)
    if (labels.label[i] > 0) {
      const float* p = &cloud.position[3 * i];
      members.push_back({double(p[0]), double(p[1]), double(p[2])});
    }
  return members;
}

/// Radius around `centre` that contains the fraction `share` of the members.
double radius_of_share(const std::vector<Vec3<double>>& members, Vec3<double> centre, double share) {
  std::vector<double> distance;
  distance.reserve(members.size());
  for (const Vec3<double>& m : members) distance.push_back(length(m - centre));
  return quantile(std::move(distance), share);
}

Vec3<double> origin_of(const GaussianCloud& cloud) { return {cloud.origin[0], cloud.origin[1], cloud.origin[2]}; }

}  // namespace

std::string ball_around(const GaussianCloud& cloud, const live::ObjectLabels& labels) {
  const std::vector<Vec3<double>> members = selected(cloud, labels);
  if (members.empty()) return {};
  Vec3<double> sum{0, 0, 0};
  for (const Vec3<double>& m : members) sum = sum + m;
  const Vec3<double> centre = (1.0 / double(members.size())) * sum, world = centre + origin_of(cloud);
  constexpr double kShare = 0.97, kMargin = 1.3;  // leaves out distant outliers, includes some surroundings
  const double radius = kMargin * radius_of_share(members, centre, kShare);
  if (!(radius > 0)) return {};
  char text[160];
  std::snprintf(text, sizeof text, "%.6g,%.6g,%.6g,%.6g", world.x, world.y, world.z, radius);
  return text;
}

Focus focus_of(const GaussianCloud& cloud, const live::ObjectLabels& labels) {
  const std::vector<Vec3<double>> members = selected(cloud, labels);
  if (members.empty()) return {};
  const auto median = [&](double Vec3<double>::*axis) {
    std::vector<double> values;
    values.reserve(members.size());
    for (const Vec3<double>& m : members) values.push_back(m.*axis);
    return quantile(std::move(values), 0.5);
  };
  const Vec3<double> centre{median(&Vec3<double>::x), median(&Vec3<double>::y), median(&Vec3<double>::z)};
  constexpr double kShare = 0.8, kMargin = 1.5;  // a first stroke also selects pieces of the wall behind the object
  return {centre + origin_of(cloud), kMargin * radius_of_share(members, centre, kShare)};
}

}  // namespace ngs::studio
