#include "marked_views.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "ngs/core/error.h"
#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/content_hash.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/ops/image/connected_components.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/render/render_options.h"
#include "ngs/scene/mask_threshold.h"
#include "ngs/scene/view_names.h"
#include "shared/scene/prompt_input.h"
#include "shared/scene/scene_model.h"

namespace ngs::ngs_tool {
namespace {

namespace fs = std::filesystem;

std::size_t patches(const ViewPrompt& prompt, bool object) {
  PixelMask marked(prompt.hint.size());
  for (std::size_t p = 0; p < marked.size(); ++p)
    marked[p] = object ? prompt.hint[p] == PixelHint::kObject || prompt.hint[p] == PixelHint::kLikelyObject
                       : prompt.hint[p] == PixelHint::kBackground;
  return connected_components({marked.data(), prompt.width_px, prompt.height_px}).size.size();
}

}  // namespace

std::string strokes_text(cli::Run& run, const std::string& scene_path, const std::string& view,
                         const std::vector<std::string>& strokes) {
  if (scene_path.empty()) {
    cli::check_prompt_files(strokes);
    return "strokes: readable; they are compared with the pictures once these are made\n";
  }
  const Scene scene = io::read_scene_json(scene_path);
  std::string text = "strokes:\n";
  bool any_object = false;
  for (const auto& [index, hand] : cli::read_prompts(run, scene, view, strokes)) {
    const Camera& camera = scene.views[index].camera;
    const ViewPrompt prompt = rasterise(hand, camera.width_px, camera.height_px);
    const std::size_t object = patches(prompt, true), background = patches(prompt, false);
    any_object |= object > 0;
    text += "  " + camera.name + "  " + std::to_string(object) + " on the object, " + std::to_string(background) +
            " on the background\n";
  }
  if (!any_object && !strokes.empty()) run.monitor().warn("no stroke is on the object");
  return text;
}

void write_marked_views(cli::Run& run, const StrokeFiles& files, const std::string& folder) {
  const Scene scene = io::read_scene_json(files.scene);
  const cli::Marks marks = cli::read_prompts(run, scene, files.view, files.strokes);
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  fs::create_directories(folder);
  const std::vector<std::string> names = output_names(scene.views);
  for (const auto& [index, hand] : marks) {
    const Camera& camera = scene.views[index].camera;
    if (scene.views[index].image_path.empty())
      throw Error(ErrorCode::kInconsistent, "the strokes: view " + camera.name + " has no photo, expected one",
                  "mark a view that has a photo, or name the folder of photos with --images DIR");
    const ViewPrompt prompt = rasterise(hand, camera.width_px, camera.height_px);
    ImageF picture = io::resize_area(io::read_image_rgb(scene.views[index].image_path, background_of(scene)),
                                     camera.width_px, camera.height_px);
    for (std::size_t p = 0; p < prompt.hint.size(); ++p) {
      const bool object = prompt.hint[p] == PixelHint::kObject;
      if (!object && prompt.hint[p] != PixelHint::kBackground) continue;
      for (std::size_t c = 0; c < 3; ++c) picture.data[3 * p + c] = c == (object ? 1u : 0u) ? 0.9f : 0.1f;
    }
    const fs::path file = fs::path(folder) / (names[index] + ".png");
    fs::create_directories(file.parent_path());
    io::write_png(file.generic_string(), to_bytes(picture));
  }
}

void record_pictures(const std::string& folder, const std::string& record) {
  nlohmann::json hashes = nlohmann::json::object();
  for (const std::string& name : io::list_images(folder)) hashes[name] = io::content_hash(folder + "/" + name).xxh3;
  io::write_file(record, hashes.dump(1) + "\n");
}

std::vector<std::string> PaintedPictures::all() const {
  std::vector<std::string> names = in_place;
  names.insert(names.end(), other_format.begin(), other_format.end());
  return names;
}

PaintedPictures rescue_painted(const std::string& folder, const std::string& record, const std::string& copies) {
  PaintedPictures painted;
  std::error_code absent;
  if (!fs::exists(record, absent)) return painted;
  const nlohmann::json hashes = io::read_json_file(record);
  std::set<std::string> stems;
  for (const auto& entry : hashes.items()) stems.insert(image_stem(entry.key()));
  for (const std::string& name : io::list_images(folder)) {
    if (!hashes.contains(name))
      (stems.contains(image_stem(name)) ? painted.other_format : painted.unknown).push_back(name);
    else if (io::content_hash((fs::path(folder) / name).generic_string()).xxh3 != hashes.at(name))
      painted.in_place.push_back(name);
  }
  for (const std::string& name : painted.all()) {
    fs::create_directories(copies);
    fs::copy_file(fs::path(folder) / name, fs::path(copies) / name, fs::copy_options::overwrite_existing);
  }
  return painted;
}

std::vector<std::string> strokes_on_copies(const std::vector<std::string>& strokes, const std::string& folder,
                                           const std::string& copies, const PaintedPictures& painted) {
  std::vector<std::string> out;
  std::error_code absent;
  // Not "FOLDER/": equivalent() is false for it on Windows.
  const auto is_folder = [&](const fs::path& path) { return fs::equivalent(path, fs::path(folder) / ".", absent); };
  bool all_copies = false;
  for (const std::string& path : strokes) {
    const fs::path copy = fs::path(copies) / fs::path(path).filename();
    if (is_folder(fs::path(path) / ".") && fs::exists(copies, absent)) {
      out.push_back(copies);
      all_copies = true;
    } else
      out.push_back(is_folder(fs::path(path).parent_path() / ".") && fs::exists(copy, absent) ? copy.generic_string()
                                                                                              : path);
  }
  for (const std::string& name : painted.all())
    if (const std::string copy = (fs::path(copies) / name).generic_string();
        !all_copies && !std::ranges::count(out, copy))
      out.push_back(copy);
  return out;
}

std::vector<std::string> not_in_folder(const std::vector<std::string>& strokes, const std::string& folder) {
  std::vector<std::string> out;
  std::error_code absent;
  for (const std::string& path : strokes)
    if (!fs::equivalent(fs::path(path).parent_path() / ".", fs::path(folder) / ".", absent)) out.push_back(path);
  return out;
}

namespace {

constexpr std::size_t kMaxListed = 3;

}  // namespace

StrokeCheck::StrokeCheck(cli::Run& run, const std::string& scene, const std::string& view,
                         const std::vector<std::string>& strokes)
    : run_(run), scene_(io::read_scene_json(scene)) {
  for (const auto& [index, hand] : cli::read_prompts(run, scene_, view, strokes)) {
    const Camera& camera = scene_.views[index].camera;
    marked_.push_back({camera, rasterise(hand, camera.width_px, camera.height_px)});
  }
}

StrokeAgreement StrokeCheck::of(const GaussianCloud& cloud, const std::vector<float>& label, bool all_pieces) const {
  run_.needs_device_memory(cli::device_bytes(double(cloud.size()), cloud.rest_count()));
  return run_.on_device_or_cpu([&] { return agreement(cloud, label, all_pieces); });
}

StrokeAgreement StrokeCheck::agreement(const GaussianCloud& cloud, std::vector<float> label, bool all_pieces) const {
  const SplatOptions splat = prepared_for(run_.exec(), splat_options({}, cloud, scene_), cloud);
  if (!all_pieces) {
    std::vector<ViewSums> strokes;
    for (const auto& [camera, prompt] : marked_)
      std::ranges::move(stroke_weights(run_.exec(), cloud, camera, prompt, splat), std::back_inserter(strokes));
    std::vector<std::uint8_t> member(label.size());
    for (std::size_t i = 0; i < label.size(); ++i) member[i] = is_set(label[i]);
    const PieceSelection pieces = touched_pieces(run_.exec(), cloud, member, strokes);
    for (std::size_t i = 0; i < label.size(); ++i)
      if (member[i] && !pieces.object[i]) label[i] = 0;
  }
  StrokeAgreement agreement;
  for (const auto& [camera, prompt] : marked_)
    add_stroke_agreement(run_.exec(), {cloud, label, splat}, camera, prompt, agreement);
  return agreement;
}

std::string broken_text(const StrokeAgreement& agreement) {
  std::string text;
  for (std::size_t i = 0; i < std::min(kMaxListed, agreement.broken.size()); ++i) {
    const BrokenStroke& stroke = agreement.broken[i];
    text += (i > 0 ? "; " : "") + stroke.view + ": " + std::to_string(std::lround(100 * stroke.wrong)) + " % of the " +
            (stroke.object ? "object" : "background") + " stroke at " + std::to_string(stroke.x) + "," +
            std::to_string(stroke.y) + " is " + (stroke.object ? "background" : "object");
  }
  if (agreement.broken.size() > kMaxListed)
    text += "; and " + std::to_string(agreement.broken.size() - kMaxListed) + " more strokes";
  return text;
}

}  // namespace ngs::ngs_tool
