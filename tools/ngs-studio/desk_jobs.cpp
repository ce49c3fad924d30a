// Requests of Desk that start jobs: Refine and Export.
#include <algorithm>
#include <filesystem>

#include "desk.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/scene/scene_json.h"
#include "shared/run/environment.h"

namespace ngs::studio {
namespace {

namespace fs = std::filesystem;

/// What a program does, for people.
std::string stage_of(const std::vector<std::string>& words) {
  if (words[0] == "ngs") return "Refining";
  return words[0] == "ngs-scene" ? "Making pictures" : "Writing";
}

/// Removes files of earlier exports, which may hold another selection.
void remove_exports(const std::string& folder, bool keep_ply) {
  std::error_code ignored;
  for (const std::string side : {"/object.", "/background.", "/background-filled."})
    for (const std::string format : kFormats)
      if (!keep_ply || format != "ply" || side == "/background-filled.") fs::remove(folder + side + format, ignored);
}

Json files_in(const std::string& folder, const std::string& shown, const std::string& format) {
  Json files = Json::array();
  std::error_code absent;
  for (const std::string& name : {"object." + format, "background." + format, "background-filled." + format,
                                  std::string("labelled.ply"), std::string("strokes.json"), std::string("masks")}) {
    const fs::path path = fs::path(folder) / name;
    if (!fs::is_directory(path, absent)) {
      if (fs::exists(path, absent)) files.push_back(shown + "/" + name);
      continue;
    }
    std::vector<std::string> masks;
    for (const fs::directory_entry& entry : fs::directory_iterator(path, absent))
      masks.push_back(shown + "/masks/" + entry.path().filename().string());
    std::sort(masks.begin(), masks.end());
    for (const std::string& mask : masks) files.push_back(mask);
  }
  return files;
}

}  // namespace

void Desk::start(std::string kind, std::vector<JobStep> steps, std::function<void()> finished) {
  for (JobStep& step : steps)
    if (place_.device == cli::DeviceChoice::kCpu && !step.words.empty() &&
        cli::has_device_path(step.words[0] == "ngs" ? "ngs cut" : step.words[0]))
      step.words.insert(step.words.end(), {"--device", "cpu"});
  std::shared_ptr<Job> earlier;  // destroyed outside the lock: its thread may wait for mutex_
  {
    const std::lock_guard lock(mutex_);
    if (job_ && job_->is_running())
      throw Refusal(409, job_->kind(), "still running", "a finished job", "wait, or cancel it");
    earlier = std::move(job_);
  }
  earlier.reset();
  auto job = std::make_shared<Job>(std::move(kind), std::move(steps), std::move(finished));
  const std::lock_guard lock(mutex_);
  job_ = std::move(job);
}

Json Desk::job_json() const {
  std::shared_ptr<Job> job;
  {
    const std::lock_guard lock(mutex_);
    job = job_;
  }
  return job ? job->json() : Json();
}

Json Desk::cancel() const {
  std::shared_ptr<Job> job;
  {
    const std::lock_guard lock(mutex_);
    job = job_;
  }
  if (!job) throw Refusal(409, "cancel", "no job is running", "a running Refine or Export");
  job->cancel();
  return job->json();
}

bool Desk::is_refined(const live::ObjectMarks& object) const {
  const std::lock_guard lock(mutex_);
  const auto found = refined_.find(object.id);
  return found != refined_.end() && found->second.views == object.views;
}

std::shared_ptr<const RefinedModel> Desk::refined_of(const live::Marks& marks, int object) const {
  const live::ObjectMarks* marked = marks.find(object);
  if (marked == nullptr || !is_refined(*marked)) return nullptr;
  const std::lock_guard lock(mutex_);
  return refined_.at(object).model;
}

RefineChoice Desk::choice_for(int object, const std::string& quality) const {
  RefineChoice choice{loaded_.is_scene && !loaded_.scene.views.empty() ? "" : loaded_.scene.model_path, "", quality,
                      session_.marks()->all_pieces};
  for (const live::ShownObject& shown : *session_.shown())
    if (shown.id == object && shown.labels) choice.around = ball_around(loaded_.ply.cloud, *shown.labels);
  return choice;
}

Json Desk::refine(Fields request) {
  const std::string quality = request.text("quality", 20);
  if (quality != kQuickRefine && quality != "draft" && quality != "standard" && quality != "high")
    request.refuse("quality", "quick, draft, standard or high");
  request.end();
  const std::shared_ptr<const live::Marks> marks = session_.marks();
  const live::ObjectMarks* found = marks->find(marks->active);
  if (found == nullptr || found->views.empty())
    throw Refusal(409, "refine", "the object has no strokes", "strokes in at least one view", "draw on the object");
  const live::ObjectMarks object = *found;
  const RefineChoice choice = choice_for(object.id, quality);
  std::vector<JobStep> steps;
  steps.push_back({"Writing", 0, {}, [this, object] {
                     folder_.write_scene(session_, object, loaded_.scene);
                     fs::create_directories(folder_.of(object.id, "orbit"));
                   }});
  const auto words = refine_words(folder_, object.id, choice);
  for (std::size_t w = 0; w < words.size(); ++w) {
    const bool last = w + 1 == words.size();
    if (last)
      steps.push_back({"Writing", 0, {}, [this, object, made = !choice.source.empty()] {
                         const std::string orbit = folder_.of(object.id, "orbit/scene.json");
                         folder_.write_cut(object, made ? io::read_scene_json(orbit) : loaded_.scene);
                       }});
    steps.push_back({stage_of(words[w]), last ? 8.0 : 1.5, words[w]});
  }
  start("refine", std::move(steps), [this, object, quality] {
    auto model = std::make_shared<const RefinedModel>(exec_, folder_.of(object.id, "cut/labelled.ply"), loaded_.splat);
    const std::lock_guard lock(mutex_);
    refined_[object.id] = {std::move(model), object.views}, quality_[object.id] = quality;
    for (const char* older : {"labelled.ply", "boundary.ply"}) fs::remove(folder_.of(object.id, older));
    remove_exports(folder_.of(object.id), false);
    remove_exports(folder_.of(object.id, "cut"), true);
    exported_ = nullptr;
    ++version_;
  });
  return state();
}

ExportChoice Desk::export_choice(const live::Marks& marks) const {
  const std::lock_guard lock(mutex_);
  ExportChoice choice = exported_as_;
  choice.all_pieces = marks.all_pieces;
  return choice;
}

Json Desk::export_files(Fields request) {
  const std::shared_ptr<const live::Marks> marks = session_.marks();
  ExportChoice choice{marks->all_pieces, request.has("format") ? request.text("format", 20) : "ply",
                      request.has("fill") && request.boolean("fill")};
  if (std::ranges::find(kFormats, choice.format) == std::end(kFormats))
    request.refuse("format", "ply, compressed.ply, spz or sog");
  request.end();
  std::vector<JobStep> steps;
  std::vector<std::pair<std::string, std::string>> folders;
  for (const live::ObjectMarks& object : marks->objects) {
    if (object.views.empty()) continue;
    const std::string shown = "object-" + std::to_string(object.id);
    const bool refined = is_refined(object);
    const std::string folder = folder_.of(object.id, refined ? "cut" : "");
    folders.emplace_back(folder, shown + (refined ? "/cut" : ""));
    steps.push_back({"Writing", 0, {}, [folder, refined] { remove_exports(folder, refined); }});
    if (refined) {
      for (const auto& words : convert_words(folder_, object.id, choice)) steps.push_back({"Writing", 1, words});
      continue;
    }
    steps.push_back({"Writing", 0, {}, [this, object] { folder_.write_scene(session_, object, loaded_.scene); }});
    for (const auto& words : export_words(folder_, object.id, choice)) steps.push_back({"Writing", 1, words});
  }
  if (folders.empty())
    throw Refusal(409, "export", "no object has strokes", "strokes in at least one view", "draw on the object");
  start("export", std::move(steps), [this, folders, choice] {
    Json files = Json::array();
    for (const auto& [folder, shown] : folders)
      for (const Json& file : files_in(folder, shown, choice.format)) files.push_back(file);
    const std::lock_guard lock(mutex_);
    exported_as_ = choice;
    exported_ = {{"files", std::move(files)},
                 {"format", choice.format},
                 {"folder", fs::path(place_.folder).filename().string()},
                 {"path", fs::absolute(place_.folder).lexically_normal().generic_string()}};
    ++version_;
  });
  return state();
}

Reply Desk::download(Fields request) const {
  const std::string file = request.text("file", 4096);
  bool is_exported = false;
  {
    const std::lock_guard lock(mutex_);
    if (exported_.is_object())
      for (const Json& name : exported_.at("files")) is_exported |= name == file;
  }
  if (!is_exported) request.refuse("file", "a file of the last export");
  request.end();
  const io::MappedFile bytes(folder_.at(file));
  return {200,
          std::string(bytes.text()),
          "application/octet-stream",
          {{"Content-Disposition", "attachment; filename=\"" + fs::path(file).filename().string() + "\""}}};
}

}  // namespace ngs::studio
