#include "state_folder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/ops/image/metrics.h"

namespace ngs::studio {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMarker = ".ngs-studio";

void write_mask(const std::string& path, const live::MarkedView& view) {
  ImageU8 image(view.camera.width_px, view.camera.height_px, 1);
  for (std::size_t p = 0; p < image.data.size(); ++p) image.data[p] = view.mask[p] ? 255 : 0;
  io::write_png(path, image);
}

PixelMask read_mask(const std::string& path, const Camera& camera) {
  const io::RawMask raw = io::read_mask_raw(path, io::Palette::kMask);
  if (raw.width_px != camera.width_px || raw.height_px != camera.height_px || raw.channels != 1)
    throw Error(ErrorCode::kBadInput,
                path + ": " + std::to_string(raw.width_px) + "x" + std::to_string(raw.height_px) + " px, expected " +
                    std::to_string(camera.width_px) + "x" + std::to_string(camera.height_px) + " as for the saved view",
                "start a new session in a new folder: -o FOLDER");
  PixelMask mask(raw.data.size());
  for (std::size_t p = 0; p < mask.size(); ++p) mask[p] = raw.data[p] >= kMaskThreshold;
  return mask;
}

Scene scene_like(const Scene& like) {
  Scene scene = like;
  scene.views.clear();
  scene.objects = {SceneObject{}};
  scene.use_binary_masks();
  scene.missing_mask = MissingMask::kUnknown;
  return scene;
}

constexpr double kMaxRadius_px = 500;
constexpr std::size_t kMaxPoints = 20'000, kMaxStrokes = 20'000;
constexpr int kFreeBand_px = 3;  // on both sides of a mask's contour

int id_of(const io::JsonReader& reader, const char* key, int least) { return int(reader.integer(key, least, 1 << 20)); }

PromptStroke stroke_of(const io::JsonReader& stroke) {
  PromptStroke out;
  const std::string label = stroke.text("label");
  if (label != "object" && label != "background") stroke.fail("label", "object or background");
  out.object = label == "object";
  out.radius_px = stroke.number("radius_px", 0.5, kMaxRadius_px);
  out.points = points_of(stroke, "points");
  stroke.refuse_unknown_keys();
  return out;
}

Json prompt_strokes(const std::vector<PromptStroke>& strokes) {
  Json list = Json::array();
  for (const PromptStroke& s : strokes)
    list.push_back({{"object", s.object}, {"radius", s.radius_px}, {"points", s.points}});
  return list;
}

/// Adds one stroke per horizontal run of pixels in `side`.
void add_rows(const PixelMask& side, int width_px, int height_px, bool object, Json& strokes) {
  for (int y = 0; y < height_px; ++y)
    for (int x = 0, end = 0; x < width_px; x = end + 1) {
      const auto at = [&](int column) { return side[std::size_t(y) * std::size_t(width_px) + std::size_t(column)]; };
      for (end = x; end < width_px && at(end); ++end) {
      }
      if (end == x) continue;
      strokes.push_back({{"object", object}, {"radius", 0.5}, {"points", {{x + 0.5, y + 0.5}, {end - 0.5, y + 0.5}}}});
    }
}

/// Pixels of one side that are farther than the band from the contour.
PixelMask outside_band(const PixelMask& mask, bool object, int width_px, int height_px) {
  PixelMask side(mask.size());
  for (std::size_t p = 0; p < side.size(); ++p) side[p] = (mask[p] != 0) == object;
  const auto depth = chessboard_distance({side.data(), width_px, height_px}, Outside::kUnknown);
  for (std::size_t p = 0; p < side.size(); ++p) side[p] = depth[p] > kFreeBand_px;
  return side;
}

live::MarkedView view_of(const io::JsonReader& view) {
  live::MarkedView out;
  out.name = view.text("name");
  if (out.name.size() != 8 || out.name.find_first_not_of("0123456789") != 4 || !out.name.ends_with(".png"))
    view.fail("name", "a name such as 0001.png");
  out.viewpoint = viewpoint_of(view.object("look"));
  out.strokes = {out.name, out.viewpoint.width_px, out.viewpoint.height_px, strokes_of(view), {}, {}, {}};
  view.refuse_unknown_keys();
  return out;
}

Json edits_json(const live::HandEdits& edits) {
  Json list = Json::array();
  for (const auto& of : edits) {
    const live::HandEdit& edit = *of;
    Json one{{"action", int(edit.action)}};
    if (!edit.outline.empty()) one.update({{"look", json_of(edit.viewpoint)}, {"outline", edit.outline}});
    if (edit.visible_only) one["visible_only"] = true;
    if (edit.radius > 0)
      one.update({{"centre", {edit.centre.x, edit.centre.y, edit.centre.z}}, {"radius", edit.radius}});
    list.push_back(std::move(one));
  }
  return list;
}

live::HandEdit edit_of(const io::JsonReader& edit) {
  live::HandEdit out;
  out.action = live::EditAction(edit.integer("action", 0, int(live::EditAction::kShrink)));
  if (edit.has("outline")) {
    out.viewpoint = viewpoint_of(edit.object("look"));
    out.outline = points_of(edit, "outline");
  }
  out.visible_only = edit.boolean_or("visible_only", false);
  if (edit.has("radius")) {
    out.centre = vector_of(edit, "centre");
    out.radius = edit.number("radius", 0, 1e9);
  }
  edit.refuse_unknown_keys();
  return out;
}

live::ObjectMarks object_of(const io::JsonReader& object) {
  live::ObjectMarks out;
  out.id = id_of(object, "id", 1);
  out.name = object.text("name", 60);
  out.colour = colour_of(object, "colour");
  out.next_view = id_of(object, "next_view", 1);
  for (const nlohmann::json& view : object.array("views"))
    out.views.push_back(std::make_shared<const live::MarkedView>(view_of({view, "view"})));
  live::HandEdits edits;
  if (object.has("edits"))
    for (const nlohmann::json& edit : object.array("edits"))
      edits.push_back(std::make_shared<const live::HandEdit>(edit_of({edit, "edit"})));
  if (!edits.empty()) out.edits = std::make_shared<const live::HandEdits>(std::move(edits));
  out.hidden = object.boolean_or("hidden", false);
  out.locked = object.boolean_or("locked", false);
  out.keeps_dropped = object.boolean_or("keeps_dropped", false);
  object.refuse_unknown_keys();
  return out;
}

}  // namespace

StateFolder::StateFolder(std::string path) : path_(std::move(path)) {
  std::error_code absent;
  if (fs::exists(path_, absent) && !fs::is_empty(path_, absent) && !fs::exists(at(kMarker), absent))
    throw Error(ErrorCode::kUsage, path_ + ": contains files that are not from ngs-studio",
                "choose another folder with -o");
  fs::create_directories(path_);
  lock_.emplace(path_);
  io::write_file(at(kMarker), "a folder of ngs-studio\n");
}

std::string StateFolder::of(int object, const std::string& name) const {
  return at("object-" + std::to_string(object)) + (name.empty() ? "" : "/" + name);
}

std::optional<live::Marks> StateFolder::load(const std::string& source) const {
  std::error_code absent;
  const std::string file = at("studio.json");
  if (!fs::exists(file, absent)) return std::nullopt;
  live::Marks marks = with_context(file, [&] { return marks_of(io::read_json_file(file), source); });
  for (live::ObjectMarks& object : marks.objects)
    for (std::shared_ptr<const live::MarkedView>& view : object.views) {
      live::MarkedView with_mask = *view;
      const Camera camera = live::at_segmented_size(live::camera_of(with_mask.viewpoint));
      with_mask.mask = read_mask(of(object.id, "masks/" + with_mask.name), camera);
      view = std::make_shared<const live::MarkedView>(std::move(with_mask));
    }
  return marks;
}

void StateFolder::save_masks(const live::ObjectMarks& object) {
  auto& saved = saved_[object.id];
  std::error_code ignored;
  std::map<std::string, std::shared_ptr<const live::MarkedView>> now;
  for (const auto& view : object.views) {
    now[view->name] = view;
    if (saved.contains(view->name) && saved[view->name] == view) continue;
    fs::create_directories(of(object.id, "masks"));
    write_mask(of(object.id, "masks/" + view->name), *view);
  }
  for (const auto& [name, view] : saved)
    if (!now.contains(name)) fs::remove(of(object.id, "masks/" + name), ignored);
  saved = std::move(now);
}

void StateFolder::save(const live::Marks& marks, const std::string& source) {
  for (const live::ObjectMarks& object : marks.objects) save_masks(object);
  io::write_file(at("studio.json"), json_of(marks, source).dump(1) + "\n");
}

void StateFolder::note(const std::string& line) const {
  std::ofstream file(at("visit.jsonl"), std::ios::app | std::ios::binary);
  if (!(file << line << "\n" << std::flush))
    throw Error(ErrorCode::kEnvironment, at("visit.jsonl") + ": cannot be written", "is the disk full?");
}

void StateFolder::write_scene(const live::Session& session, const live::ObjectMarks& object, const Scene& like) const {
  Scene scene = scene_like(like);
  fs::create_directories(of(object.id, "images"));
  for (const auto& view : object.views) {
    const std::string image = of(object.id, "images/" + view->name);
    io::write_png(image, session.picture(view->camera));
    scene.views.push_back({view->camera, image, of(object.id, "masks/" + view->name), Split::kTrain});
  }
  scene.renders = RenderedPhotos{};
  io::write_scene_json(of(object.id, "scene.json"), scene);
  io::write_file(of(object.id, "strokes.json"), strokes_json(object).dump(1) + "\n");
}

void StateFolder::write_cut(const live::ObjectMarks& object, const Scene& base) const {
  Scene scene = scene_like(base);
  for (const SceneView& view : base.views) {
    scene.views.push_back(view);
    scene.views.back().mask_path.clear();
  }
  for (const auto& view : object.views) {
    Camera camera = view->camera;
    camera.name = marked_name(*view);
    scene.views.push_back({camera, of(object.id, "images/" + view->name), {}, Split::kTrain});
  }
  std::ranges::sort(scene.views, {}, [](const SceneView& view) { return view.camera.name; });
  io::write_scene_json(of(object.id, "cut.json"), scene);
  io::write_file(of(object.id, "marks.json"), marks_json(object).dump() + "\n");
}

std::vector<std::array<double, 2>> points_of(const io::JsonReader& reader, const std::string& key) {
  const std::size_t count = reader.array(key).size();
  if (count == 0 || count > kMaxPoints) reader.fail(key, "1 to " + std::to_string(kMaxPoints) + " points");
  const std::vector<double> flat = reader.matrix(key, count, 2);
  if (std::ranges::any_of(flat, [](double v) { return std::abs(v) > 1e5; })) reader.fail(key, "pixels");
  std::vector<std::array<double, 2>> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back({flat[2 * i], flat[2 * i + 1]});
  return points;
}

std::string colour_of(const io::JsonReader& reader, const std::string& key) {
  std::string colour = reader.text(key);
  if (colour.size() != 7 || colour[0] != '#' || colour.find_first_not_of("0123456789abcdefABCDEF", 1) != colour.npos)
    reader.fail(key, "a colour such as #ff8c1a");
  return colour;
}

std::vector<PromptStroke> strokes_of(const io::JsonReader& request) {
  const nlohmann::json& list = request.array("strokes");
  if (list.empty() || list.size() > kMaxStrokes) request.fail("strokes", "a list of at least one stroke");
  std::vector<PromptStroke> strokes;
  for (std::size_t i = 0; i < list.size(); ++i)
    strokes.push_back(stroke_of({list[i], "strokes[" + std::to_string(i) + "]"}));
  return strokes;
}

Json json_of(const std::vector<PromptStroke>& strokes) {
  Json list = Json::array();
  for (const PromptStroke& s : strokes)
    list.push_back({{"label", s.object ? "object" : "background"}, {"radius_px", s.radius_px}, {"points", s.points}});
  return list;
}

Json json_of(const live::Marks& marks, const std::string& source) {
  Json objects = Json::array();
  for (const live::ObjectMarks& object : marks.objects) {
    Json views = Json::array();
    for (const auto& view : object.views)
      views.push_back(
          {{"name", view->name}, {"look", json_of(view->viewpoint)}, {"strokes", json_of(view->strokes.strokes)}});
    objects.push_back({{"id", object.id},
                       {"name", object.name},
                       {"colour", object.colour},
                       {"next_view", object.next_view},
                       {"views", std::move(views)}});
    if (object.edits) objects.back()["edits"] = edits_json(*object.edits);
    for (const auto& [name, is_set] : {std::pair{"hidden", object.hidden}, std::pair{"locked", object.locked},
                                       std::pair{"keeps_dropped", object.keeps_dropped}})
      if (is_set) objects.back()[name] = true;
  }
  return {{"ngs_studio", 1},
          {"source", source},
          {"active", marks.active},
          {"next_id", marks.next_id},
          {"all_pieces", marks.all_pieces},
          {"objects", std::move(objects)}};
}

live::Marks marks_of(const nlohmann::json& root, const std::string& source) {
  try {
    const io::JsonReader fields(root, "");
    live::Marks marks;
    fields.integer("ngs_studio", 1, 1);
    if (fields.text("source") != source)
      fields.fail("source", source + ": a folder belongs to one model; choose another with -o");
    marks.active = id_of(fields, "active", 0);
    marks.next_id = id_of(fields, "next_id", 1);
    marks.all_pieces = fields.boolean_or("all_pieces", false);
    for (const nlohmann::json& object : fields.array("objects")) marks.objects.push_back(object_of({object, "object"}));
    fields.refuse_unknown_keys();
    return marks;
  } catch (const Error& e) {
    throw Error(ErrorCode::kBadInput, e.what(), "start a new session in a new folder: -o FOLDER");
  }
}

Json strokes_json(const live::ObjectMarks& object) {
  Json views = Json::array();
  for (const auto& view : object.views)
    views.push_back({{"view", view->name},
                     {"width", view->viewpoint.width_px},
                     {"height", view->viewpoint.height_px},
                     {"strokes", prompt_strokes(view->strokes.strokes)}});
  return {{"ngs_prompts", 2}, {"views", std::move(views)}};
}

Json marks_json(const live::ObjectMarks& object) {
  Json views = Json::array();
  for (const auto& view : object.views) {
    const int w = view->camera.width_px, h = view->camera.height_px;
    Json strokes = Json::array();
    for (const bool side : {false, true}) add_rows(outside_band(view->mask, side, w, h), w, h, side, strokes);
    views.push_back({{"view", marked_name(*view)}, {"width", w}, {"height", h}, {"strokes", std::move(strokes)}});
  }
  return {{"ngs_prompts", 2}, {"views", std::move(views)}};
}

std::string marked_name(const live::MarkedView& view) { return "marked-" + view.name; }

}  // namespace ngs::studio
