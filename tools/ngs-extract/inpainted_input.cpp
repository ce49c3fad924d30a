#include "inpainted_input.h"

#include <algorithm>
#include <filesystem>

#include "ngs/io/files/folder_index.h"
#include "ngs/io/image/image_file.h"
#include "ngs/scene/view_names.h"
#include "ngs/stages/render/render_options.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAsWritten = "give the folder of the pictures that --inpaint wrote to images/, inpainted";

/// All image files below `folder`, relative to it, sorted.
std::vector<std::string> pictures_in(const std::string& folder) {
  std::error_code failed;
  std::vector<std::string> found;
  for (fs::recursive_directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
    if (at->is_regular_file(failed) && has_image_extension(at->path().filename().string()))
      found.push_back(fs::relative(at->path(), folder).generic_string());
  if (failed || found.empty())
    throw Error(ErrorCode::kBadInput, folder + ": no picture, expected those of the scene's views", kAsWritten);
  std::ranges::sort(found);
  return found;
}

}  // namespace

void check_inpainted_options(const Input& inpainted, const Input& scene, const Outputs& out) {
  if (!inpainted) return;
  if (!scene) throw Error(ErrorCode::kUsage, "--inpainted needs the cameras", "give --scene scene.json");
  if (!out.background_filled && !out.filled)
    throw Error(ErrorCode::kUsage, "--inpainted changes only the filled background",
                "give --background-filled FILE or --filled FILE");
}

InpaintedPictures::InpaintedPictures(const Scene& scene, const std::string& folder, const InpaintOptions& options)
    : scene_(scene), folder_(folder), options_(options), names_(output_names(scene.views)), paths_(names_.size()) {
  for (const std::string& file : pictures_in(folder)) {
    const auto at = std::ranges::find(names_, image_stem(file));
    const std::string path = folder + "/" + file;
    if (at == names_.end())
      throw Error(ErrorCode::kInconsistent,
                  path + ": is the picture of no view, expected names such as " + names_.front() + ".png", kAsWritten);
    const auto v = std::size_t(at - names_.begin());
    if (!paths_[v].empty())
      throw Error(ErrorCode::kInconsistent, path + ": is the second picture of a view, expected one", "remove one");
    const Camera& camera = scene.views[v].camera;
    const io::ImageSize size = io::read_image_size(path), wanted{camera.width_px, camera.height_px};
    if (!(size == wanted))
      throw Error(ErrorCode::kInconsistent,
                  path + ": has " + io::to_string(size) + " pixels, expected " + io::to_string(wanted), kAsWritten);
    paths_[v] = path;
  }
}

void InpaintedPictures::find_holes(Run& run, const Extractor& extractor) {
  const auto timed = run.monitor().scope("holes");
  const GaussianCloud& cloud = extractor.cloud();
  const SplatOptions splat = prepared_for(run.exec(), splat_options({}, cloud, scene_), cloud);
  const std::vector<std::uint8_t> seen = seen_gaussians(run.exec(), run.monitor(), cloud, scene_, splat);
  const InpaintModel model{cloud, extractor.object(), seen, background_of(scene_)};
  holes_.resize(names_.size());
  for (std::size_t v = 0; v < names_.size(); ++v) {
    ViewHole found = find_hole(run.exec(), options_, model, scene_.views[v].camera, splat);
    const auto pixels = std::ranges::count(found.hole, std::uint8_t(1));
    run.monitor().progress(std::int64_t(v + 1), std::int64_t(names_.size()));
    if (pixels == 0) continue;
    if (paths_[v].empty())
      throw Error(ErrorCode::kBadInput,
                  folder_ + ": no picture of view " + names_[v] + ", expected " + names_[v] + ".png, as its hole has " +
                      std::to_string(pixels) + " pixels",
                  kAsWritten);
    holes_[v] = std::move(found.dilated);
    with_hole_.push_back(v);
  }
}

InpaintedViews InpaintedPictures::views(const Run& run, const GaussianCloud& cloud) const {
  return {scene_,
          with_hole_,
          [this](std::size_t v) { return io::read_image_rgb(paths_[v], background_of(scene_)); },
          [this](std::size_t v) -> const PixelMask& { return holes_[v]; },
          splat_options({}, cloud, scene_),
          background_of(scene_),
          run.seed()};
}

}  // namespace ngs::cli
