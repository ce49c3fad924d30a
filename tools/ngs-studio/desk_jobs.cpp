// Requests of Desk that start jobs: Refine and Export.
#include <algorithm>
#include <filesystem>

#include "desk.h"
#include "ngs/interactive/hand_edit.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/ply/gaussian_ply.h"
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
  fs::remove(folder + "/mesh.glb", ignored);
}

constexpr const char* kNothingBetter =
    "Refine found nothing better than your selection, which stays as it is: correct it by strokes or by hand, or "
    "export "
    "it.";

Json files_in(const std::string& folder, const std::string& shown, const std::string& format) {
  Json files = Json::array();
  std::error_code absent;
  for (const std::string& name :
       {"object." + format, "background." + format, "background-filled." + format, std::string("mesh.glb"),
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

void Desk::relabel_refined(const live::ObjectMarks& object) {
  const std::lock_guard lock(mutex_);
  const auto found = refined_.find(object.id);
  if (found == refined_.end() || found->second.views != object.views) return;
  Refined& refined = found->second;
  if (refined.labels && refined.edits == object.edits && refined.keeps_dropped == object.keeps_dropped) return;
  live::ObjectLabels labels = refined.model->found.labels;
  for (std::size_t i = 0; object.keeps_dropped && i < labels.label.size(); ++i)
    if (refined.model->found.dropped.label[i] > 0) {
      labels.label[i] = 1;
      ++labels.count;
    }
  const live::HandEdits none;
  labels = live::with_edits(exec_, {refined.model->ply.cloud, refined.model->splat}, std::move(labels),
                            object.edits ? *object.edits : none);
  refined.labels = std::make_shared<const live::ObjectLabels>(std::move(labels));
  refined.edits = object.edits;
  refined.keeps_dropped = object.keeps_dropped;
}

std::shared_ptr<const live::ObjectLabels> Desk::labels_of(const live::Marks& marks, int object) const {
  const live::ObjectMarks* marked = marks.find(object);
  if (marked != nullptr && is_refined(*marked)) {
    const std::lock_guard lock(mutex_);
    return refined_.at(object).labels;
  }
  for (const live::ShownObject& shown : *session_.shown())
    if (shown.id == object) return shown.labels;
  return nullptr;
}

bool Desk::is_by_hand(const live::Marks& marks, const live::ObjectMarks& object) const {
  if (place_.without_programs) return true;
  if (object.edits) return true;
  if (const std::shared_ptr<const RefinedModel> refined = refined_of(marks, object.id))
    return refined->found.restored > 0 || (object.keeps_dropped && refined->found.dropped.count > 0);
  return !object.locked && !object.hidden && std::ranges::any_of(marks.objects, [&](const live::ObjectMarks& other) {
    return other.id != object.id && (other.locked || other.hidden) && !other.is_empty();
  });
}

std::vector<std::vector<std::string>> Desk::words_of(const live::ObjectMarks& object, const live::Marks& marks,
                                                     const ExportChoice& choice) const {
  const bool refined = is_refined(object), by_hand = is_by_hand(marks, object);
  const std::string labelled = refined ? folder_.of(object.id, "cut/labelled.ply") : loaded_.scene.model_path;
  std::vector<std::vector<std::string>> words = by_hand   ? selection_words(folder_, object.id, labelled, choice)
                                                : refined ? convert_words(folder_, object.id, choice)
                                                          : export_words(folder_, object.id, choice);
  if (choice.mesh) words.push_back(mesh_words(folder_.of(object.id, refined && !by_hand ? "cut" : ""), choice));
  return words;
}

void Desk::write_selection(const live::Marks& marks, const live::ObjectMarks& object) const {
  const std::shared_ptr<const live::ObjectLabels> labels = labels_of(marks, object.id);
  const std::shared_ptr<const RefinedModel> refined = refined_of(marks, object.id);
  fs::create_directories(folder_.of(object.id));
  io::write_strict_ply(folder_.of(object.id, "selection.ply"), refined ? refined->ply : loaded_.ply,
                       {labels->label.begin(), labels->label.end()});
}

/// A refined object may have other Gaussians than the model: then those of its strokes and edits.
void Desk::write_all_objects(const live::Marks& marks) const {
  std::vector<std::uint8_t> object(std::size_t(loaded_.ply.cloud.size()));
  for (const live::ShownObject& shown : *session_.shown()) {
    std::shared_ptr<const live::ObjectLabels> labels = labels_of(marks, shown.id);
    if (labels && labels->label.size() != object.size()) labels = shown.labels;
    for (std::size_t i = 0; labels && i < object.size(); ++i) object[i] |= labels->label[i] > 0;
  }
  io::write_strict_ply(folder_.at("objects.ply"), loaded_.ply, object);
}

RefineChoice Desk::choice_for(int object, const std::string& quality) const {
  RefineChoice choice{loaded_.is_scene && !loaded_.scene.views.empty() ? "" : loaded_.scene.model_path, "", quality,
                      session_.marks()->all_pieces};
  for (const live::ShownObject& shown : *session_.shown())
    if (shown.id == object && shown.labels) choice.around = ball_around(loaded_.ply.cloud, *shown.labels);
  return choice;
}

Json Desk::refine(const io::JsonReader& request) {
  const std::string quality = request.text("quality");
  if (quality != kQuickRefine && quality != "draft" && quality != "standard" && quality != "high")
    request.fail("quality", "quick, draft, standard or high");
  request.refuse_unknown_keys();
  const std::shared_ptr<const live::Marks> marks = session_.marks();
  const live::ObjectMarks* found = marks->find(marks->active);
  if (found == nullptr || found->views.empty() || shown_count(found->id) == 0)
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
    steps.push_back({stage_of(words[w]), last ? 8.0 : 1.5, words[w], {}, kNothingBetter});
  }
  start("refine", std::move(steps), [this, object, quality] {
    auto model =
        std::make_shared<const RefinedModel>(exec_, folder_.of(object.id, "cut/labelled.ply"), loaded_, object);
    {
      const std::lock_guard lock(mutex_);
      refined_[object.id] = {std::move(model), object.views, nullptr, nullptr, false};
      quality_[object.id] = quality;
    }
    relabel_refined(object);
    const std::lock_guard lock(mutex_);
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

Json Desk::export_files(const io::JsonReader& request) {
  const std::shared_ptr<const live::Marks> marks = session_.marks();
  ExportChoice choice{marks->all_pieces, request.text_or("format", "ply"), request.boolean_or("fill", false),
                      request.boolean_or("mesh", false)};
  if (std::ranges::find(kFormats, choice.format) == std::end(kFormats))
    request.fail("format", "ply, compressed.ply, spz or sog");
  request.refuse_unknown_keys();
  std::vector<JobStep> steps;
  std::vector<std::pair<std::string, std::string>> folders;
  for (const live::ObjectMarks& object : marks->objects) {
    if (object.is_empty()) continue;
    if (shown_count(object.id) == 0)
      throw Refusal(409, object.name, "no Gaussian is selected", "a selection",
                    "draw on the object, undo the last step, or remove the object");
    const std::string shown = "object-" + std::to_string(object.id);
    const bool by_hand = is_by_hand(*marks, object), in_cut = is_refined(object) && !by_hand;
    const std::string folder = folder_.of(object.id, in_cut ? "cut" : "");
    folders.emplace_back(folder, shown + (in_cut ? "/cut" : ""));
    steps.push_back({"Writing", 0, {}, [folder, in_cut] { remove_exports(folder, in_cut); }});
    if (by_hand) steps.push_back({"Writing", 0, {}, [this, marks, object] { write_selection(*marks, object); }});
    if (!in_cut && !object.views.empty())
      steps.push_back({"Writing", 0, {}, [this, object] { folder_.write_scene(session_, object, loaded_.scene); }});
    for (const auto& words : words_of(object, *marks, choice)) steps.push_back({"Writing", 1, words});
  }
  if (folders.empty())
    throw Refusal(409, "export", "no object has strokes", "strokes in at least one view", "draw on the object");
  steps.push_back({"Writing", 0, {}, [this] { remove_exports(folder_.path(), false); }});
  if (folders.size() > 1) {
    steps.push_back({"Writing", 0, {}, [this, marks] { write_all_objects(*marks); }});
    steps.push_back({"Writing", 1, common_background_words(folder_, loaded_.scene.model_path, choice)});
  }
  start("export", std::move(steps), [this, folders, choice] {
    Json files = Json::array();
    for (const auto& [folder, shown] : folders)
      for (const Json& file : files_in(folder, shown, choice.format)) files.push_back(file);
    if (folders.size() > 1) files.push_back("background." + choice.format);
    if (place_.without_programs) files.push_back("visit.jsonl");
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

Reply Desk::download(const io::JsonReader& request) const {
  const std::string file = request.text("file");
  bool is_exported = false;
  {
    const std::lock_guard lock(mutex_);
    if (exported_.is_object())
      for (const Json& name : exported_.at("files")) is_exported |= name == file;
  }
  if (!is_exported) request.fail("file", "a file of the last export");
  request.refuse_unknown_keys();
  const io::MappedFile bytes(folder_.at(file));
  return {200,
          std::string(bytes.text()),
          "application/octet-stream",
          {{"Content-Disposition", "attachment; filename=\"" + fs::path(file).filename().string() + "\""}}};
}

}  // namespace ngs::studio
