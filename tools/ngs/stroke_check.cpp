#include "stroke_check.h"

#include <algorithm>
#include <cmath>

#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/render/render_options.h"
#include "ngs/scene/mask_threshold.h"
#include "shared/scene/memory_model.h"
#include "shared/scene/prompt_input.h"

namespace ngs::ngs_tool {
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
