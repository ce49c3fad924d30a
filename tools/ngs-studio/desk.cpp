#include "desk.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "ngs/core/monitor.h"
#include "ngs/interactive/hand_edit.h"
#include "ngs/io/image/image_file.h"
#include "ngs/options/name_of.h"
#include "ngs/os/process_usage.h"
#include "shared/run/child_process.h"
#include "state_folder.h"

namespace ngs::studio {
namespace {

nlohmann::ordered_json quantile(std::vector<double> ms, double share) {
  if (ms.empty()) return nullptr;
  std::sort(ms.begin(), ms.end());
  return std::round(10 * ms[std::size_t(std::lround(share * double(ms.size() - 1)))]) / 10;
}

namespace fs = std::filesystem;

constexpr NamedValue<live::Layer> kLayers[] = {{live::Layer::kBoth, "both"},
                                               {live::Layer::kObject, "object"},
                                               {live::Layer::kBackground, "background"},
                                               {live::Layer::kBoundary, "boundary"}};
constexpr NamedValue<live::EditAction> kActions[] = {{live::EditAction::kAdd, "add"},
                                                     {live::EditAction::kTake, "take"},
                                                     {live::EditAction::kInvert, "invert"},
                                                     {live::EditAction::kGrow, "grow"},
                                                     {live::EditAction::kShrink, "shrink"}};
constexpr std::array<float, 3> kDroppedColour{1, 0.1f, 0.9f};
constexpr int kJpegQuality = 85, kMovingQuality = 70;
constexpr std::size_t kMaxViews = 400;  // views of a scene to list

Json list(Vec3<double> v) { return Json{v.x, v.y, v.z}; }
double ms(double seconds) { return std::round(1e4 * seconds) / 10; }

std::string name_of_object(const io::JsonReader& fields) {
  std::string name = fields.text("name", 60);
  if (name.empty()) fields.fail("name", "a name");
  for (const char c : name)
    if (std::uint8_t(c) < 32 || c == 127) fields.fail("name", "a name without control characters");
  return name;
}

std::size_t count_marked(const live::Marks& marks) {
  return std::size_t(std::ranges::count_if(marks.objects, [](const auto& object) { return !object.is_empty(); }));
}

}  // namespace

Stopwatch::Stopwatch() : wall_start_s(wall_seconds()), cpu_start_s(os::cpu_seconds()) {}
double Stopwatch::wall_s() const { return wall_seconds() - wall_start_s; }
double Stopwatch::cpu_s() const { return os::cpu_seconds() - cpu_start_s; }

nlohmann::ordered_json Latencies::json() const {
  return {{"n", wall_ms_.size()},
          {"median_ms", quantile(wall_ms_, 0.5)},
          {"p95_ms", quantile(wall_ms_, 0.95)},
          {"median_cpu_ms", quantile(cpu_ms_, 0.5)},
          {"p95_cpu_ms", quantile(cpu_ms_, 0.95)}};
}

Desk::Desk(const Exec& exec, StudioPlace place)
    : exec_(exec),
      place_(std::move(place)),
      loaded_(exec, place_.source),
      folder_(place_.folder),
      session_(exec, loaded_.model()) {
  if (std::optional<live::Marks> earlier = folder_.load(place_.source)) {
    session_.restore(std::move(*earlier));
    note("/api/forget", nlohmann::json::object());
  }
  folder_.save(*session_.marks(), place_.source);
}

void Desk::note(const std::string& path, const nlohmann::json& body) const {
  folder_.note(Json{{"path", path}, {"body", body}}.dump());
}

Json Desk::changed() {
  const std::shared_ptr<const live::Marks> marks = session_.marks();
  folder_.save(*marks, place_.source);
  for (const live::ObjectMarks& object : marks->objects) relabel_refined(object);
  {
    const std::lock_guard lock(mutex_);
    exported_ = nullptr;  // the exported files no longer match the selection
  }
  ++version_;
  return state();
}

void Desk::refuse_while_busy() const {
  const std::lock_guard lock(mutex_);
  if (job_ && job_->is_running() && job_->kind() == "export")
    throw Refusal(409, "export", "still running", "a finished job", "wait, or cancel it");
}

Json Desk::strokes(const io::JsonReader& request) {
  refuse_while_busy();
  const Stopwatch watch;
  const int object = int(request.integer("object", 1, 1 << 20));
  const live::Viewpoint viewpoint = viewpoint_of(request.object("camera"));
  const std::vector<PromptStroke> drawn = strokes_of(request);
  request.refuse_unknown_keys();
  const std::int64_t before = shown_count(object);
  const live::StrokeAnswer answer = session_.mark(object, viewpoint, drawn);
  Json out = changed();
  const double all_s = watch.wall_s();
  const std::int64_t count = shown_count(object);
  out["answer"] = {{"mask_ms", ms(answer.mask_s)}, {"lift_ms", ms(answer.lift_s)}, {"ms", ms(all_s)},
                   {"gaussians", count},           {"change", count - before},     {"coverage", answer.coverage}};
  const std::lock_guard lock(mutex_);
  stroke_ms_.add(watch);
  (answer.is_first ? first_ms_ : correction_ms_).add(watch);
  return out;
}

std::int64_t Desk::shown_count(int object) const {
  const std::shared_ptr<const live::ObjectLabels> labels = labels_of(*session_.marks(), object);
  return labels ? labels->count : 0;
}

Json Desk::edit(const io::JsonReader& request) {
  refuse_while_busy();
  const int object = int(request.integer("object", 1, 1 << 20));
  const std::string action = request.text("action");
  const auto* named = std::ranges::find(kActions, action, &NamedValue<live::EditAction>::name);
  if (named == std::end(kActions)) request.fail("action", "add, take, invert, grow or shrink");
  live::HandEdit edit;
  if (named->value == live::EditAction::kAdd || named->value == live::EditAction::kTake) {
    const live::Viewpoint viewpoint = viewpoint_of(request.object("camera"));
    if (request.has("ball")) {
      const io::JsonReader ball = request.object("ball");
      const double x = ball.number("x", 0, viewpoint.width_px), y = ball.number("y", 0, viewpoint.height_px),
                   radius_px = ball.number("radius_px", 0.5, 4096);
      ball.refuse_unknown_keys();
      const live::Model model = loaded_.model();
      edit = live::ball_at(exec_, model.cloud, model.splat, viewpoint, {x, y, radius_px});
    } else {
      edit.viewpoint = viewpoint;
      edit.outline = points_of(request, "outline");
      edit.visible_only = request.boolean_or("visible_only", false);
      if (edit.outline.size() < 3) request.fail("outline", "at least three points");
    }
  }
  edit.action = named->value;
  request.refuse_unknown_keys();
  const std::int64_t before = shown_count(object);
  session_.edit_by_hand(object, edit);
  Json out = changed();
  const std::int64_t count = shown_count(object);
  out["answer"] = {{"gaussians", count}, {"change", count - before}};
  return out;
}

/// Keeps, or drops again, what the strokes select and Refine dropped.
Json Desk::keep(const io::JsonReader& request) {
  refuse_while_busy();
  const int object = int(request.integer("object", 1, 1 << 20));
  const bool keep = request.boolean("keep");
  request.refuse_unknown_keys();
  session_.keep_dropped(object, keep);
  return changed();
}

Json Desk::undo(const io::JsonReader& request) {
  request.refuse_unknown_keys();
  refuse_while_busy();
  if (!session_.undo()) throw Refusal(409, "undo", "nothing to undo", "an earlier step");
  return changed();
}

Json Desk::redo(const io::JsonReader& request) {
  request.refuse_unknown_keys();
  refuse_while_busy();
  if (!session_.redo()) throw Refusal(409, "redo", "nothing to redo", "an undone step");
  return changed();
}

Json Desk::forget(const io::JsonReader& request) {
  request.refuse_unknown_keys();
  session_.forget_steps();
  return changed();
}

Json Desk::objects(const io::JsonReader& request) {
  refuse_while_busy();
  if (request.has("add")) {
    const io::JsonReader added = request.object("add");
    const std::string name = added.has("name") ? name_of_object(added) : "";
    added.refuse_unknown_keys();
    request.refuse_unknown_keys();
    session_.add_object(name);
  } else if (request.has("remove")) {
    const int id = int(request.integer("remove", 1, 1 << 20));
    request.refuse_unknown_keys();
    session_.remove_object(id);
  } else if (request.has("active")) {
    const int id = int(request.integer("active", 1, 1 << 20));
    request.refuse_unknown_keys();
    session_.activate(id);
  } else if (request.has("all_pieces")) {
    const bool all = request.boolean("all_pieces");
    request.refuse_unknown_keys();
    session_.show_all_pieces(all);
  } else {
    const int id = int(request.integer("id", 1, 1 << 20));
    const std::string flag = request.has("hidden") ? "hidden" : request.has("locked") ? "locked" : "";
    const bool is_set = !flag.empty() && request.boolean(flag);
    const std::string name = request.has("name") ? name_of_object(request) : "",
                      colour = request.has("colour") ? colour_of(request, "colour") : "";
    if (flag.empty() && name.empty() && colour.empty())
      request.fail("name", "a name, a colour, or one of hidden and locked");
    request.refuse_unknown_keys();
    if (flag == "hidden") session_.set_hidden(id, is_set);
    if (flag == "locked") session_.set_locked(id, is_set);
    if (!name.empty() || !colour.empty()) session_.edit_object(id, name, colour);
  }
  return changed();
}

live::FrameRequest Desk::frame_request(const io::JsonReader& request, bool& moving) const {
  live::FrameRequest frame;
  live::Viewpoint viewpoint = viewpoint_of(request.object("camera"));
  if (request.has("layer")) {
    const std::string layer = request.text("layer");
    const auto* named = std::ranges::find(kLayers, layer, &NamedValue<live::Layer>::name);
    if (named == std::end(kLayers)) request.fail("layer", "both, object, background or boundary");
    frame.layer = named->value;
  }
  if (request.has("fade")) frame.fade = request.number("fade", 0, 1);
  if (request.has("object")) frame.object = int(request.integer("object", 0, 1 << 20));
  if (request.has("highlight")) frame.highlight = request.boolean("highlight");
  moving = request.boolean_or("moving", false);
  request.refuse_unknown_keys();
  if (moving) {
    viewpoint.width_px = (viewpoint.width_px + 1) / 2;
    viewpoint.height_px = (viewpoint.height_px + 1) / 2;
  }
  frame.camera = live::camera_of(viewpoint);
  return frame;
}

Reply Desk::frame(const io::JsonReader& request) {
  const Stopwatch watch;
  bool moving = false;
  const live::FrameRequest wanted = frame_request(request, moving);
  const int version = version_;
  const std::shared_ptr<const live::Marks> marks = session_.marks();
  const std::shared_ptr<const std::vector<live::ShownObject>> shown = session_.shown();
  const int object = wanted.object == 0 ? marks->active : wanted.object;
  const std::shared_ptr<const RefinedModel> refined = shows_before_ ? nullptr : refined_of(*marks, object);
  std::vector<live::ShownObject> objects = *shown;
  if (refined) {
    std::erase_if(objects, [&](const live::ShownObject& o) { return o.id != object; });
    for (live::ShownObject& o : objects) o.labels = labels_of(*marks, object);
    const bool shows_dropped = wanted.layer == live::Layer::kBoth && wanted.fade == 0.5 && wanted.highlight;
    if (shows_dropped && refined->found.dropped.count > 0 && !marks->find(object)->keeps_dropped)
      objects.push_back({object, kDroppedColour,
                         std::shared_ptr<const live::ObjectLabels>(refined, &refined->found.dropped), nullptr, false});
  }
  const ImageU8 picture = [&] {
    const std::lock_guard lock(drawing_);
    const live::Model model = loaded_.model();
    if (!refined) return live::draw_frame(exec_, model, objects, wanted, moving ? nullptr : &last_still_);
    return live::draw_frame(exec_, {refined->ply.cloud, refined->splat, model.background}, objects, wanted);
  }();
  const io::PagePicture file = io::encode_for_page(picture, moving ? kMovingQuality : kJpegQuality);
  {
    const std::lock_guard lock(mutex_);
    (moving ? moving_ms_ : still_ms_).add(watch);
  }
  return {
      200,
      {file.bytes.begin(), file.bytes.end()},
      file.type,
      {{"X-Ngs-Ms", std::to_string(std::lround(1000 * watch.wall_s()))}, {"X-Ngs-Version", std::to_string(version)}}};
}

Json Desk::before(const io::JsonReader& request) {
  shows_before_ = request.boolean("show");
  request.refuse_unknown_keys();
  ++version_;
  return state();
}

Json Desk::log() const {
  const std::lock_guard lock(mutex_);
  return {{"strokes", stroke_ms_.json()},
          {"first", first_ms_.json()},
          {"corrections", correction_ms_.json()},
          {"frames", {{"moving", moving_ms_.json()}, {"still", still_ms_.json()}}}};
}

Json Desk::objects_json(const live::Marks& marks) const {
  Json out = Json::array();
  const auto shown = session_.shown();
  for (const live::ObjectMarks& object : marks.objects) {
    const std::shared_ptr<const RefinedModel> refined = refined_of(marks, object.id);
    std::int64_t left_out = 0;
    Focus focus;
    for (const live::ShownObject& s : *shown)
      if (s.id == object.id && s.labels) {
        left_out = refined ? 0 : s.labels->removed;
        if (s.id == marks.active) focus = focus_of(loaded_.ply.cloud, *s.touched);
      }
    out.push_back({{"id", object.id},
                   {"name", object.name},
                   {"colour", object.colour},
                   {"gaussians", shown_count(object.id)},
                   {"left_out", left_out},
                   {"strokes", object.strokes()},
                   {"views", object.views.size()},
                   {"edits", object.edits ? object.edits->size() : 0},
                   {"hidden", object.hidden},
                   {"locked", object.locked},
                   {"refined", refined != nullptr},
                   {"dropped", refined ? refined->found.dropped.count : 0},
                   {"keeps_dropped", object.keeps_dropped}});
    if (focus.radius > 0) out.back()["focus"] = {{"centre", list(focus.centre)}, {"radius", focus.radius}};
  }
  return out;
}

Json Desk::views_json() const {
  Json out = Json::array();
  for (const SceneView& view : loaded_.scene.views) {
    if (out.size() == kMaxViews) break;
    const Vec3<double> line = loaded_.first.centre - view.camera.centre();
    out.push_back({{"name", view.camera.name},
                   {"camera", json_of(viewpoint_of_view(view.camera, std::max(1e-6, length(line))))}});
  }
  return out;
}

/// Shell commands that reproduce the files; of a page without programs, that take its session to the installed studio.
Json Desk::commands_json(const live::Marks& marks) const {
  Json lines = Json::array();
  const auto add = [&](const std::vector<std::string>& words) { lines.push_back(cli::quoted_line(words)); };
  if (place_.without_programs) {
    add({"ngs-studio", place_.source, "--replay", "visit.jsonl", "-o", place_.folder});
    add({"ngs-studio", place_.source, "-o", place_.folder});
    return lines;
  }
  add({"ngs-studio", place_.source, "--replay", folder_.at("visit.jsonl"), "-o", place_.folder + "-again"});
  for (const live::ObjectMarks& object : marks.objects) {
    if (object.is_empty()) continue;
    const bool refined = is_refined(object);
    std::string quality = "standard";
    {
      const std::lock_guard lock(mutex_);
      if (const auto found = quality_.find(object.id); found != quality_.end()) quality = found->second;
    }
    if (refined)
      for (const auto& words : refine_words(folder_, object.id, choice_for(object.id, quality))) add(words);
    for (const auto& words : words_of(object, marks, export_choice(marks))) add(words);
  }
  if (count_marked(marks) > 1) add(common_background_words(folder_, loaded_.scene.model_path, export_choice(marks)));
  return lines;
}

Json Desk::state() const {
  const std::shared_ptr<const live::Marks> marks = session_.marks();
  const live::InitialViewpoint& first = loaded_.first;
  Json out{{"version", version_.load()},
           {"title", fs::path(place_.source).filename().string()},
           {"gaussians", loaded_.ply.cloud.size()},
           {"bounds", {{"centre", list(first.centre)}, {"radius", first.radius}, {"up", list(first.up)}}},
           {"start", json_of(first.viewpoint)},
           {"views", views_json()},
           {"objects", objects_json(*marks)},
           {"active", marks->active},
           {"all_pieces", marks->all_pieces},
           {"undo", session_.steps_back()},
           {"redo", session_.steps_again()},
           {"job", job_json()},
           {"folder", fs::path(place_.folder).filename().string()},
           {"commands", commands_json(*marks)},
           {"before", shows_before_.load()}};
  const std::lock_guard lock(mutex_);
  if (!exported_.is_null()) out["export"] = exported_;
  return out;
}

}  // namespace ngs::studio
