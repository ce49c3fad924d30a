#include "ngs/io/scene/scene_json.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include "ngs/core/error.h"
#include "ngs/io/capture/pose.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/image/annotations.h"
#include "ngs/scene/view_names.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using nlohmann::ordered_json;

template <class E>
struct Name {
  E value;
  const char* name;
};
constexpr std::array kModes{Name<MaskMode>{MaskMode::kBinary, "binary"}, Name<MaskMode>{MaskMode::kLabel, "label"},
                            Name<MaskMode>{MaskMode::kSoft, "soft"}, Name<MaskMode>{MaskMode::kBands, "bands"}};
constexpr std::array kMissing{Name<MissingMask>{MissingMask::kUnknown, "unknown"},
                              Name<MissingMask>{MissingMask::kEmpty, "empty"},
                              Name<MissingMask>{MissingMask::kError, "error"}};
constexpr std::array kCompats{Name<Compat>{Compat::kInria, "inria"}, Name<Compat>{Compat::kGsplat, "gsplat"}};
constexpr std::array kSplits{Name<Split>{Split::kTrain, "train"}, Name<Split>{Split::kHeldOut, "held-out"}};

template <class E, std::size_t N>
const char* name_of(const std::array<Name<E>, N>& names, E value) {
  return std::find_if(names.begin(), names.end(), [&](const Name<E>& n) { return n.value == value; })->name;
}

template <class E, std::size_t N>
E value_of(const std::array<Name<E>, N>& names, const JsonReader& reader, const std::string& key) {
  const std::string found = reader.text(key);
  std::string expected = "one of";
  for (const Name<E>& n : names) {
    if (found == n.name) return n.value;
    expected += std::string(" ") + n.name;
  }
  reader.fail(key, expected);
}

SceneView parse_view(const JsonReader& reader, const std::string& folder) {
  SceneView view;
  Camera& camera = view.camera;
  camera.name = reader.text("name");
  camera.width_px = int(reader.integer("width", 1, kMaxSide));
  camera.height_px = int(reader.integer("height", 1, kMaxSide));
  camera.fx = reader.number("fx");
  camera.fy = reader.number("fy");
  camera.cx = reader.number("cx");
  camera.cy = reader.number("cy");
  const std::vector<double> r = reader.matrix("rotation", 9, 0), t = reader.matrix("translation", 3, 0);
  std::copy(r.begin(), r.end(), camera.rotation.m);
  camera.translation = vec3(t.data());
  view.image_path = path_from_folder(folder, reader.text_or("image", ""));
  view.mask_path = path_from_folder(folder, reader.text_or("mask", ""));
  view.split = value_of(kSplits, reader, "split");
  reader.refuse_unknown_keys();
  return view;
}

ordered_json view_to_json(const SceneView& view, const FileFolder& folder) {
  const Camera& c = view.camera;
  ordered_json out{{"name", c.name},
                   {"width", c.width_px},
                   {"height", c.height_px},
                   {"fx", c.fx},
                   {"fy", c.fy},
                   {"cx", c.cx},
                   {"cy", c.cy},
                   {"rotation", std::vector<double>(c.rotation.m, c.rotation.m + 9)},
                   {"translation", {c.translation.x, c.translation.y, c.translation.z}}};
  if (!view.image_path.empty()) out["image"] = path_to_folder(folder, view.image_path);
  if (!view.mask_path.empty()) out["mask"] = path_to_folder(folder, view.mask_path);
  out["split"] = name_of(kSplits, view.split);
  return out;
}

RenderedPhotos parse_renders(const JsonReader& reader) {
  if (reader.text("note") != kRenderedPhotosNote) reader.fail("note", std::string("\"") + kRenderedPhotosNote + "\"");
  const RenderedPhotos renders{reader.number("coverage")};
  if (!(renders.coverage >= 0 && renders.coverage <= 1)) reader.fail("coverage", "a share in [0, 1]");
  reader.refuse_unknown_keys();
  return renders;
}

/// Readable and diff-friendly: one line per top-level key, per object and per view.
std::string one_line_per_entry(const ordered_json& root) {
  std::string text = "{";
  for (const auto& item : root.items()) {
    text += (text.size() > 1 ? ",\n \"" : "\n \"") + item.key() + "\": ";
    if (!item.value().is_array() || item.value().front().is_number()) {
      text += item.value().dump();
      continue;
    }
    text += "[";
    for (const auto& entry : item.value()) text += (text.back() == '[' ? "\n  " : ",\n  ") + entry.dump();
    text += "\n ]";
  }
  return text + "\n}\n";
}

[[noreturn]] void refuse(const std::string& object, const std::string& text) {
  throw Error(ErrorCode::kBadInput, object + ": " + text);
}

void validate_objects(const Scene& scene, const std::string& object) {
  if (scene.objects.empty()) refuse(object, "no objects, expected at least one");
  std::set<std::string> names;
  std::set<std::uint32_t> ids;
  for (const SceneObject& o : scene.objects) {
    if (!is_folder_name(o.name)) refuse(object, "object name \"" + o.name + "\", expected a name that can be a folder");
    if (!names.insert(o.name).second) refuse(object, "object name \"" + o.name + "\" twice, expected once");
    if (scene.mask_mode != MaskMode::kLabel) continue;
    if (scene.void_id == o.id)
      refuse(object,
             "id " + std::to_string(o.id) + " is both void and object \"" + o.name + "\", expected one of them");
    if (o.id > 65535) refuse(object, "object id " + std::to_string(o.id) + ", expected 0..65535");
    if (!ids.insert(o.id).second) refuse(object, "object id " + std::to_string(o.id) + " twice, expected once");
  }
  if (scene.mask_mode == MaskMode::kLabel && scene.mask_invert)
    refuse(object, "inverted label maps, expected invert only with binary, soft or bands");
  const bool has_plain_mask = std::any_of(scene.views.begin(), scene.views.end(), [](const SceneView& v) {
    return !v.mask_path.empty() && v.mask_path.find("{object}") == std::string::npos && !is_annotations(v.mask_path);
  });
  if (scene.objects.size() > 1 && scene.mask_mode != MaskMode::kLabel && has_plain_mask)
    refuse(object, std::to_string(scene.objects.size()) +
                       " objects in one mask per view, expected label maps or one "
                       "folder per object (\"{object}\" in the mask's path)");
  if (scene.void_id && (scene.mask_mode != MaskMode::kLabel || *scene.void_id > 65535))
    refuse(object,
           "void id " + std::to_string(*scene.void_id) + ", expected 0..65535 with label maps, none with other masks");
}

/// Relative paths start from the folder of the link, so that a link may select other files. If they do not exist from
/// there but do exist from the folder of the linked file, the link was a mistake.
void refuse_lost_link(const json& root, const Scene& scene, const std::string& path) {
  std::error_code ignored;
  if (!fs::is_symlink(path, ignored)) return;
  const fs::path file = fs::weakly_canonical(path, ignored);
  const Scene meant = parse_scene_json(root, file.parent_path().generic_string(), path);
  const auto check = [&](const std::string& found, const std::string& there) {
    if (found.empty() || fs::exists(found, ignored) || !fs::exists(there, ignored)) return;
    throw Error(ErrorCode::kBadInput,
                path + ": is a link, and " + found +
                    " does not exist; expected the scene's files at paths relative to the link",
                "name the file itself: " + file.generic_string());
  };
  check(scene.model_path, meant.model_path);
  check(scene.views[0].image_path, meant.views[0].image_path);
}

}  // namespace

void validate_scene(const Scene& scene, const std::string& object) {
  if (scene.views.empty()) refuse(object, "no views, expected at least one");
  if (!(scene.image_scale > 0 && scene.image_scale <= 1))
    refuse(object, "image_scale " + std::to_string(scene.image_scale) + ", expected (0, 1]");
  if (!(scene.filter_px2 > 0 && scene.filter_px2 <= 1e4))
    refuse(object, "filter_px2 " + std::to_string(scene.filter_px2) + ", expected (0, 10000] px²");
  if (!(scene.world_unit > 0 && scene.world_unit <= 1))
    refuse(object, "world_unit " + std::to_string(scene.world_unit) + ", expected (0, 1]");
  if (!(scene.mask_threshold >= 0 && scene.mask_threshold <= 255))
    refuse(object, "mask threshold " + std::to_string(scene.mask_threshold) + ", expected [0, 255]");
  if (const auto& b = scene.background)
    for (const double channel : {b->x, b->y, b->z})
      if (!(channel >= 0 && channel <= 1))
        refuse(object, "background " + std::to_string(channel) + ", expected three numbers in [0, 1]");
  std::set<std::string> names;
  for (const SceneView& view : scene.views) {
    validate_camera(view.camera, object);
    if (!names.insert(view.camera.name).second) refuse(object, "view " + view.camera.name + " twice, expected once");
  }
  validate_objects(scene, object);
}

Scene parse_scene_json(const json& root, const std::string& folder, const std::string& object) {
  const JsonReader reader(root, object);
  const std::int64_t version = reader.integer("ngs_scene", 0, 1000000);
  if (version != kSceneVersion)
    throw Error(ErrorCode::kBadInput,
                object + ": scene version " + std::to_string(version) + ", expected " + std::to_string(kSceneVersion),
                "write it again with this version: ngs-scene import SOURCE -o scene.json");
  Scene scene;
  scene.model_path = path_from_folder(folder, reader.text_or("model", ""));
  reader.text_or("truth", "");  // truth_of_scene_json()
  scene.image_scale = reader.number("image_scale");
  scene.filter_px2 = reader.number_or("filter_px2", scene.filter_px2);
  if (reader.has("compat")) scene.compat = value_of(kCompats, reader, "compat");
  scene.world_unit = reader.number_or("world_unit", scene.world_unit);
  if (reader.has("antialiased")) scene.antialiased = reader.boolean("antialiased");
  if (reader.has("background")) scene.background = vec3(reader.matrix("background", 3, 0).data());
  if (reader.has("renders")) scene.renders = parse_renders(reader.object("renders"));
  const JsonReader masks = reader.object("masks");
  scene.mask_mode = value_of(kModes, masks, "mode");
  scene.mask_invert = masks.boolean("invert");
  scene.mask_threshold = masks.number("threshold");
  scene.missing_mask = value_of(kMissing, masks, "missing");
  if (masks.has("void_id")) scene.void_id = std::uint32_t(masks.integer("void_id", 0, 65535));
  masks.refuse_unknown_keys();
  for (const json& entry : reader.array("objects")) {
    const JsonReader o(entry, object + ": objects[" + std::to_string(scene.objects.size()) + "]");
    scene.objects.push_back({o.text("name"), std::uint32_t(o.integer("id", 0, 65535))});
    o.refuse_unknown_keys();
  }
  for (const json& entry : reader.array("views"))
    scene.views.push_back(
        parse_view(JsonReader(entry, object + ": views[" + std::to_string(scene.views.size()) + "]"), folder));
  reader.refuse_unknown_keys();
  std::stable_sort(scene.views.begin(), scene.views.end(),
                   [](const SceneView& a, const SceneView& b) { return a.camera.name < b.camera.name; });
  validate_scene(scene, object);
  return scene;
}

Scene read_scene_json(const std::string& path) {
  const json root = read_json_file(path);
  Scene scene = parse_scene_json(root, folder_of_file(path), path);
  refuse_lost_link(root, scene, path);
  return scene;
}

std::string truth_of_scene_json(const std::string& path) {
  const json root = read_json_file(path);
  return path_from_folder(folder_of_file(path), JsonReader(root, path).text_or("truth", ""));
}

void write_scene_json(const std::string& path, const Scene& scene, StoredPaths stored, const std::string& truth_dir) {
  validate_scene(scene, path);
  const FileFolder folder = stored_folder(path, stored);
  ordered_json out{{"ngs_scene", kSceneVersion}, {"model", path_to_folder(folder, scene.model_path)}};
  if (!truth_dir.empty()) out["truth"] = path_to_folder(folder, truth_dir);
  out["image_scale"] = scene.image_scale;
  out["filter_px2"] = scene.filter_px2;
  out["compat"] = name_of(kCompats, scene.compat);
  if (scene.world_unit != 1) out["world_unit"] = scene.world_unit;
  if (scene.antialiased) out["antialiased"] = *scene.antialiased;
  if (const auto& b = scene.background) out["background"] = {b->x, b->y, b->z};
  if (scene.renders) out["renders"] = {{"note", kRenderedPhotosNote}, {"coverage", scene.renders->coverage}};
  out["masks"] = {{"mode", name_of(kModes, scene.mask_mode)},
                  {"invert", scene.mask_invert},
                  {"threshold", scene.mask_threshold},
                  {"missing", name_of(kMissing, scene.missing_mask)}};
  if (scene.void_id) out["masks"]["void_id"] = *scene.void_id;
  out["objects"] = ordered_json::array();
  for (const SceneObject& o : scene.objects) out["objects"].push_back({{"name", o.name}, {"id", o.id}});
  out["views"] = ordered_json::array();
  for (const SceneView& view : scene.views) out["views"].push_back(view_to_json(view, folder));
  try {
    write_file(path, one_line_per_entry(out));
  } catch (const json::exception&) {
    throw Error(ErrorCode::kBadInput, path + ": a name or path is not UTF-8, expected names that JSON can hold",
                "rename the files");
  }
}

}  // namespace ngs::io
