#include "stage_runner.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "ngs/backend/device_info.h"
#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/json_file.h"
#include "ngs/options/name_of.h"
#include "shared/cli/exit_code.h"
#include "shared/os/machine.h"
#include "shared/run/child_process.h"
#include "shared/run/console.h"
#include "shared/run/environment.h"
#include "shared/run/signals.h"
#include "shared/text/layout.h"

namespace ngs::ngs_tool {
namespace {

namespace fs = std::filesystem;

/// A tool that does not end within this time after a signal is killed; ngs cut must end within one second.
constexpr double kGrace_s = 0.7;

/// Removes unfinished files of a tool that had to be killed.
void remove_unfinished(const std::string& folder) {
  std::error_code failed;
  std::vector<fs::path> found;
  for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(".ngs-") && name.find(".tmp") != name.npos) found.push_back(entry->path());
  }
  for (const fs::path& path : found) fs::remove(path, failed);
}

}  // namespace

StageRunner::StageRunner(cli::Run& run, std::string folder, int threads, std::set<std::string> own_flags)
    : run_(run), folder_(std::move(folder)), threads_(threads), own_flags_(std::move(own_flags)) {
  run_.monitor().on_progress = [this](const std::string&, std::int64_t done, std::int64_t total) {
    show_progress(done, total);
  };
}

StageRunner::~StageRunner() { run_.monitor().on_progress = nullptr; }

void StageRunner::plan(std::vector<PlannedStep> steps) {
  steps_ = std::move(steps), step_ = 0;
  std::vector<cli::ChainStep> parts;
  for (const PlannedStep& step : steps_) parts.push_back({step.share, step.has_passes});
  clock_ = cli::ChainClock(std::move(parts));
}

void StageRunner::begin(const std::string& name) {
  const auto found = std::ranges::find(steps_, name, &PlannedStep::name);
  if (found == steps_.end()) return;
  step_ = std::size_t(found - steps_.begin());
  clock_.begin(step_, wall_seconds());
  show_progress(0, 0);
}

void StageRunner::show_progress(std::int64_t done, std::int64_t total) {
  if (step_ >= steps_.size()) return;
  if (total > 0) clock_.update(double(done) / double(total));
  const double now_s = wall_seconds();
  run_.progress({steps_[step_].words, step_ + 1, steps_.size(), clock_.done(now_s), clock_.left_s(now_s)});
}

bool StageRunner::names_flag_of_stage(const std::string& text) const {
  for (std::size_t at = text.find("--"); at != text.npos; at = text.find("--", at + 2)) {
    const std::size_t end = text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_", at);
    const std::string flag = text.substr(at, end - at);
    const std::string positive = flag.starts_with("--no-") ? "--" + flag.substr(5) : flag;
    const bool of_another = flag.find('_') != flag.npos || text.rfind("ngs-", at) != text.npos;
    if (!of_another && !own_flags_.contains(flag) && !own_flags_.contains(positive)) return true;
  }
  return false;
}

std::string StageRunner::hint_for(const Words& words) const {
  if (!names_flag_of_stage(hint_)) return hint_;
  return words[0] + (words[0] == "ngs-scene" ? " " + words[1] : "") + ": " + hint_ + "; the command was " +
         commands_.back();
}

const nlohmann::json& StageRunner::report(const std::string& name) const {
  static const nlohmann::json none;
  const auto found = std::find(names_.rbegin(), names_.rend(), name);
  return found == names_.rend() ? none : results_[std::size_t(names_.rend() - found - 1)].report;
}

void StageRunner::on_output_line(const std::string& line) {
  const nlohmann::json record = nlohmann::json::parse(line, nullptr, false);
  if (!record.is_object() || !record.contains("event")) return;
  const std::string event = record.value("event", ""), message = record.value("message", "");
  if (event == "progress") show_progress(record.value("done", 0), record.value("total", 0));
  if (event == "error") error_ = message;
  if (event == "hint") hint_ = message;
  if (event == "warning") warnings_.push_back(record.value("tool", "") + ": " + message);
}

bool StageRunner::run(const std::string& name, const Words& words) {
  Words argv = words;
  const std::string report = folder_ + "/reports/" + name + ".json";
  for (const std::string& word : {std::string("-w"), std::string("-j"), std::to_string(threads_), std::string("--seed"),
                                  std::to_string(run_.seed()), std::string("--report"), report})
    argv.push_back(word);
  if (const cli::DeviceChoice device = run_.device_choice();
      device != cli::DeviceChoice::kAuto && cli::has_device_path(words[0]))
    argv.insert(argv.end(), {"--device", std::string(name_of(cli::kDevices, device))});
  commands_.push_back(cli::quoted_line(argv));
  if (run_.dry_run()) return true;
  if (run_.monitor().stop_requested()) return false;
  fs::create_directories(folder_ + "/reports");
  io::write_file(folder_ + "/reports/" + name + ".sh", commands_.back() + "\n");
  argv = cli::sibling_command(std::move(argv));
  for (const char* word : {"--log-format", "json"}) argv.emplace_back(word);

  const auto timed = run_.monitor().scope(name);
  begin(name);
  os::set_variable("NGS_PROGRESS_S", "0.3", true);  // short enough to update the progress of ngs cut
  if (run_.exec().device == Device::kCuda) release_freed_device_memory();  // the stage needs it
  const double start_s = wall_seconds();
  error_.clear(), hint_.clear();
  const cli::SignalGrace waits;  // until the tool has ended and removed its unfinished files
  const cli::ChildResult child =
      cli::run_child(argv, {.time_s = std::numeric_limits<double>::infinity(),
                            .stop = [this] { return run_.monitor().stop_requested(); },
                            .grace_on_stop_s = kGrace_s,
                            .on_line = [this](const std::string& line) { on_output_line(line); }});
  if (child.end == cli::ChildResult::End::kStopped) return remove_unfinished(folder_), false;
  if (child.end == cli::ChildResult::End::kSignalled) {
    remove_unfinished(folder_);
    throw Error(ErrorCode::kEnvironment, words[0] + ": ended by signal " + std::to_string(child.code),
                child.code == 9 ? "possibly out of memory: estimate it with --dry-run of the tool" : "");
  }
  if (child.code != cli::kDone && child.code != cli::kCheckFailed && child.code != cli::kBudgetHit)
    throw Error(ErrorCode(child.code), words[0] + ": " + (error_.empty() ? child.output_tail : error_),
                hint_for(words));
  names_.push_back(name);
  results_.push_back({words[0], wall_seconds() - start_s, io::read_json_file(report)});
  return true;
}

namespace {

/// Times of ngs-joint, as of the other steps measured on splats of some 80,000 Gaussians with 29 pictures.
double joint_share(Quality quality) {
  switch (quality) {
    case Quality::kDraft: return 12;
    case Quality::kStandard: return 60;
    case Quality::kHigh: return 150;
    case Quality::kReference: return 400;
  }
  return 60;
}

void add_masks_of_strokes(const CutOptions& options, const CutInputs& inputs, std::vector<PlannedStep>& steps) {
  if (inputs.has_renders) steps.push_back({"first look", "finding the object", "ngs cut", "marked/", 5, true});
  const double share = options.quality == Quality::kDraft ? 12 : 30;
  steps.push_back({"ngs-mask", "outlining the object in the pictures", "ngs-mask", "strokes/", share, true});
}

}  // namespace

std::vector<PlannedStep> planned_steps(const CutOptions& options, const CutInputs& inputs, const PlanFacts& facts) {
  std::vector<PlannedStep> steps;
  if (inputs.kind == SourceKind::kSplat && !facts.reuses_pictures)
    steps.push_back({"ngs-scene", "making pictures of the splat", "ngs-scene", "orbit/images/, orbit/sheet.jpg", 5});
  if (inputs.kind == SourceKind::kCapture)
    steps.push_back({"ngs-scene", "reading the capture", "ngs-scene", "capture.json", 3});
  if (options.all) {
    steps.push_back({"ngs-group", "finding the objects", "ngs-group", "groups/, objects.json", 10});
    steps.push_back({"ngs-variance", "finding the splats on the edges", "ngs-variance", "boundary.ply", 4});
    steps.push_back({"ngs-joint", "labelling the splats", "ngs-joint", "labelled.ply",
                     inputs.trains_all ? joint_share(options.quality) : 2, inputs.trains_all});
    steps.push_back({"ngs-extract", "writing the objects", "ngs-extract", "objects/, background.ply", 6});
    steps.push_back({"ngs-render", "drawing the masks of the result", "ngs-render", "masks/", 4});
    steps.push_back({"page", "writing the page", "ngs cut", "report.html", 2});
    return steps;
  }
  if (!facts.marked && !facts.has_masks) return steps;
  if (options.method == CutMethod::kFlash) {
    steps.push_back(
        {"flash", "finding the object", "ngs cut", "object.ply, background.ply, labelled.ply, masks/", 5, true});
    if (options.mends_halves())
      steps.push_back({"ngs-extract", "mending both halves", "ngs-extract", "object.ply, background-filled.ply", 2});
    steps.push_back({"ngs-report", "writing the pages", "ngs-report", "report.html, object.html", 3});
    return steps;
  }
  if (facts.marked) add_masks_of_strokes(options, inputs, steps);
  steps.push_back({"ngs-variance", "finding the splats on the edge", "ngs-variance", "boundary.ply", 4});
  steps.push_back(
      {"ngs-joint", "sharpening the edge", "ngs-joint", "labelled.ply", joint_share(options.quality), true});
  steps.push_back({"ngs-extract", "writing the object", "ngs-extract", "object.ply, background.ply", 4});
  steps.push_back({"ngs-render", "drawing the masks of the result", "ngs-render", "masks/", 4});
  if (inputs.truth.empty() && facts.marked) {
    steps.push_back({"ngs-eval-agreement", "comparing the result with its masks", "ngs-eval", "agreement.json", 2});
  } else if (!inputs.truth.empty() || !options.hold_out.empty()) {
    steps.push_back({"ngs-render-alone", "drawing the object alone", "ngs-render", "", 1});
    steps.push_back({"ngs-eval", "scoring the result", "ngs-eval", "metrics.json", 2});
  }
  steps.push_back({"ngs-report", "writing the pages", "ngs-report", "report.html, object.html", 4});
  return steps;
}

std::string plan_text(const std::vector<PlannedStep>& steps, const std::string& out) {
  int words = 0, tool = 0;
  for (const PlannedStep& step : steps)
    words = std::max(words, cli::columns_of(step.words)), tool = std::max(tool, cli::columns_of(step.tool));
  std::string text = "steps, with their files in " + out + "/:\n";
  for (std::size_t k = 0; k < steps.size(); ++k)
    text += cli::padded(std::to_string(k + 1) + ".", 4) + cli::padded(steps[k].words, words + 2) +
            cli::padded(steps[k].tool, tool + 2) + steps[k].files + "\n";
  return text;
}

}  // namespace ngs::ngs_tool
