#include "inpainted_input.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "ngs/core/folded_name.h"
#include "ngs/core/formatted.h"
#include "ngs/core/listed.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/image/image_file.h"
#include "ngs/render/render_options.h"
#include "ngs/scene/view_names.h"

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

constexpr int kMaxPadding_px = 63;         // some networks pad pictures at the right and bottom to multiples of 64
constexpr double kUsualDifference = 0.05;  // of codecs and networks outside of the hole, mean over channels
constexpr float kFlatRange = 2 / 255.f;    // within it all pixels have one colour

/// The view of an inpainting program's result: NAME, NAME_mask*, NAME_inpainted and the like. names.size(): none.
std::size_t view_of_result(const std::vector<std::string>& names, const std::string& stem) {
  std::size_t found = names.size();
  for (std::size_t v = 0; v < names.size(); ++v) {
    if (stem == names[v]) return v;
    if (!stem.starts_with(names[v]) || (found < names.size() && names[found].size() >= names[v].size())) continue;
    const std::string rest = lower_case(stem.substr(names[v].size()));
    for (const char* word : {"mask", "inpaint", "result", "out", "clean", "fill"})
      if (rest.size() > 1 && (rest[0] == '_' || rest[0] == '-' || rest[0] == '.') && rest.substr(1).starts_with(word))
        found = v;
  }
  return found;
}

bool is_flat(const ImageF& picture) {
  float low[3], high[3];
  for (std::size_t c = 0; c < 3; ++c) low[c] = high[c] = picture.data[c];
  for (std::size_t i = 0; i < picture.data.size(); ++i) {
    low[i % 3] = std::min(low[i % 3], picture.data[i]);
    high[i % 3] = std::max(high[i % 3], picture.data[i]);
  }
  return high[0] - low[0] <= kFlatRange && high[1] - low[1] <= kFlatRange && high[2] - low[2] <= kFlatRange;
}

/// Mean difference of two pictures over the pixels outside of `hole`; 0: there are none.
double difference_outside(const ImageF& a, const ImageF& b, const PixelMask& hole) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) {
    if (hole[i / 3]) continue;
    sum += std::abs(double(a.data[i]) - double(b.data[i]));
    ++count;
  }
  return count == 0 ? 0 : sum / double(count);
}

}  // namespace

InpaintedPictures::InpaintedPictures(const Scene& scene, const std::string& folder, const InpaintOptions& options)
    : scene_(scene), folder_(folder), options_(options), names_(output_names(scene.views)), paths_(names_.size()) {
  for (const std::string& file : pictures_in(folder)) {
    const std::size_t v = view_of_result(names_, image_stem(file));
    const std::string path = folder + "/" + file;
    if (v == names_.size())
      throw Error(ErrorCode::kInconsistent,
                  path + ": is the picture of no view, expected names such as " + names_.front() + ".png", kAsWritten);
    if (!paths_[v].empty())
      throw Error(ErrorCode::kInconsistent, path + ": is the second picture of a view, expected one", "remove one");
    const Camera& camera = scene.views[v].camera;
    const io::ImageSize size = io::read_image_size(path), wanted{camera.width_px, camera.height_px};
    const int surplus_x = size.width_px - wanted.width_px, surplus_y = size.height_px - wanted.height_px;
    if (std::min(surplus_x, surplus_y) < 0 || std::max(surplus_x, surplus_y) > kMaxPadding_px)
      throw Error(ErrorCode::kInconsistent,
                  path + ": has " + io::to_string(size) + " pixels, expected " + io::to_string(wanted), kAsWritten);
    padded_ += surplus_x > 0 || surplus_y > 0;
    paths_[v] = path;
  }
}

ImageF InpaintedPictures::picture(std::size_t v) const {
  const ImageF read = io::read_image_rgb(paths_[v], background_of(scene_));
  const Camera& camera = scene_.views[v].camera;
  ImageF cut(camera.width_px, camera.height_px, 3);
  for (int y = 0; y < cut.height_px; ++y)
    for (int x = 0; x < cut.width_px; ++x)
      for (int c = 0; c < 3; ++c) cut.at(x, y, c) = read.at(x, y, c);
  return cut;
}

void InpaintedPictures::find_holes(Run& run, const Extractor& extractor) {
  const auto timed = run.monitor().scope("holes");
  const GaussianCloud& cloud = extractor.cloud();
  const SplatOptions splat = prepared_for(run.exec(), splat_options({}, cloud, scene_), cloud);
  const std::vector<std::uint8_t> seen = seen_gaussians(run.exec(), run.monitor(), cloud, scene_, splat);
  const InpaintModel model{cloud, extractor.object(), seen, background_of(scene_)};
  holes_.resize(names_.size());
  std::vector<std::string> different;
  std::string flat;
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
    const ImageF given = picture(v);
    if (flat.empty() && is_flat(given) && !is_flat(found.colour)) flat = paths_[v];
    const double difference = difference_outside(given, found.colour, found.dilated);
    if (difference > kUsualDifference) different.push_back(names_[v] + " by " + formatted("%.2f", difference));
    holes_[v] = std::move(found.dilated);
    with_hole_.push_back(v);
  }
  if (!flat.empty())
    throw Error(ErrorCode::kInconsistent, flat + ": all of one colour, expected the picture with its hole filled",
                "run the inpainting program again: its network may have failed");
  if (padded_ > 0)
    run.monitor().warn(folder_ + ": " + std::to_string(padded_) +
                       " pictures are larger than their cameras: cut off at the right and bottom");
  if (!different.empty())
    run.monitor().warn(folder_ + ": outside of the holes " + std::to_string(different.size()) + " of " +
                       std::to_string(with_hole_.size()) + " pictures differ from those of --inpaint (" +
                       listed(different, 3) + " of 1); are they pictures of this scene?");
}

InpaintedViews InpaintedPictures::views(const Run& run, const GaussianCloud& cloud) const {
  return {scene_,
          with_hole_,
          [this](std::size_t v) { return picture(v); },
          [this](std::size_t v) -> const PixelMask& { return holes_[v]; },
          splat_options({}, cloud, scene_),
          background_of(scene_),
          run.seed()};
}

}  // namespace ngs::cli
