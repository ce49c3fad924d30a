#include "state_folder.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/scene/scene_json.h"
#include "state_json.h"

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
  scene.views.clear(), scene.objects = {SceneObject{}};
  scene.use_binary_masks();
  scene.missing_mask = MissingMask::kUnknown;
  return scene;
}

}  // namespace

StateFolder::StateFolder(std::string path) : path_(std::move(path)) {
  std::error_code absent;
  if (fs::exists(path_, absent) && !fs::is_empty(path_, absent) && !fs::exists(at(kMarker), absent))
    throw Error(ErrorCode::kUsage, path_ + ": contains files that are not from ngs-studio",
                "choose another folder with -o");
  fs::create_directories(path_);
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

}  // namespace ngs::studio
