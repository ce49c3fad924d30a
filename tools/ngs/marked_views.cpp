#include "marked_views.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "cut_inputs.h"
#include "ngs/core/error.h"
#include "ngs/core/formatted.h"
#include "ngs/core/listed.h"
#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/content_hash.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/ops/image/connected_components.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/ops/image/mask_pair.h"
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

// IoU of right masks at least .81 (a draft of six views of 96x72) and .97 (two recipes, 12 views); 3 px too large or
// too small in 160x120 .65. Cropped to three quarters .33 to .39; of two exchanged masks of six .17 and .26.
constexpr double kApart = 0.5;

/// Of a mask of the result and a given one, at the size of the given one.
MaskOverlap overlap_of(const MaskSamples& result, const ViewMasks& given, std::size_t object) {
  const std::vector<std::uint8_t> shown = object_pixels(result);
  const std::size_t w = std::size_t(given.width_px), h = std::size_t(given.height_px);
  const std::size_t from_w = std::size_t(result.width_px), from_h = std::size_t(result.height_px);
  MaskOverlap overlap;
  for (std::size_t y = 0; y < h; ++y)
    for (std::size_t x = 0; x < w; ++x) {
      const std::size_t p = y * w + x;
      if (!given.known.empty() && given.known[p] == 0) continue;
      const std::size_t from = (y * from_h + from_h / 2) / h * from_w + (x * from_w + from_w / 2) / w;
      overlap.add(shown[from] != 0, is_set(given.target[object][p]));
    }
  return overlap;
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
    if (is_folder(fs::path(path) / ".") && fs::exists(copies, absent))
      out.push_back(copies), all_copies = true;
    else
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

ResultAgreement compare_with_masks(const Scene& scene, const std::string& folder) {
  const std::vector<std::string> names = output_names(scene.views);
  ResultAgreement found;
  std::vector<double> all;
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    if (scene.views[v].mask_path.empty()) continue;
    std::optional<ViewMasks> given;
    for (std::size_t k = 0; k < scene.objects.size(); ++k) {
      const std::string& object = scene.objects[k].name;
      const bool is_alone = scene.objects.size() == 1;
      const std::string path = folder + "/" + (is_alone ? "" : object + "/") + names[v] + ".png";
      if (!exists(path)) continue;
      if (!given) given = io::load_masks(scene, v);
      if (!given->available) continue;
      const io::RawMask result = io::read_mask_raw(path, io::Palette::kMask);
      const MaskOverlap overlap = overlap_of(result.samples(), *given, k);
      if (overlap.either == 0) continue;
      all.push_back(overlap.iou());
      found.least = std::min(found.least, all.back());
      if (all.back() < kApart)
        found.apart.push_back(scene.views[v].camera.name + (is_alone ? "" : " (" + object + ")"));
    }
  }
  found.masks = all.size();
  if (all.empty()) return found;
  std::ranges::sort(all);
  found.median = all[all.size() / 2];
  return found;
}

std::string ResultAgreement::text() const {
  constexpr std::size_t kListed = 4;
  if (apart.empty()) return {};
  const std::string where = listed(apart, kListed);
  if (2 * apart.size() > masks)
    return "the result disagrees with its masks: IoU " + formatted("%.2f", median) + " in the median of " +
           std::to_string(masks) + ", expected more than 0.5: these masks may be cropped, or of other photos";
  return "the result disagrees with " + std::to_string(apart.size()) + " of " + std::to_string(masks) +
         " masks, IoU down to " + formatted("%.2f", least) + ": " + where + "; look at them and leave out wrong ones";
}

}  // namespace ngs::ngs_tool
