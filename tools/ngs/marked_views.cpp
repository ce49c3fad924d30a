#include "marked_views.h"

#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/ops/image/connected_components.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/scene/view_names.h"
#include "shared/scene/prompt_input.h"

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

}  // namespace ngs::ngs_tool
