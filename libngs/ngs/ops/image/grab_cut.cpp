#include "ngs/ops/image/grab_cut.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "ngs/core/check.h"

namespace ngs {
namespace {

constexpr std::size_t kComponents = 5;  // of the mixture of each side, fixed in OpenCV
constexpr int kMaxSamples = 1 << 15;    // per side; more do not change a mixture of five

using Colours = std::vector<std::array<std::uint8_t, 3>>;

/// The part of the image that can change, with a margin.
cv::Rect region_of_interest(const ViewPrompt& prompt, int margin_px) {
  int left = prompt.width_px, right = -1, top = prompt.height_px, bottom = -1;
  for (int y = 0; y < prompt.height_px; ++y)
    for (int x = 0; x < prompt.width_px; ++x) {
      if (prompt.hint[std::size_t(y) * std::size_t(prompt.width_px) + std::size_t(x)] == PixelHint::kBackground)
        continue;
      left = std::min(left, x), right = std::max(right, x), top = std::min(top, y), bottom = std::max(bottom, y);
    }
  if (right < 0) return {};
  left = std::max(0, left - margin_px), top = std::max(0, top - margin_px);
  right = std::min(prompt.width_px - 1, right + margin_px), bottom = std::min(prompt.height_px - 1, bottom + margin_px);
  return {left, top, right - left + 1, bottom - top + 1};
}

struct Source {
  const ImageU8& photo;
  const ViewPrompt& prompt;
  cv::Rect region;
};

/// Sample colours of one side for its mixture: the certain pixels; if they are too few, the likely ones too.
Colours samples_of(const Source& from, bool object, std::size_t max_samples) {
  Colours samples;
  for (const bool likely_too : {false, true}) {
    samples.clear();
    for (int y = from.region.y; y < from.region.y + from.region.height; ++y)
      for (int x = from.region.x; x < from.region.x + from.region.width; ++x) {
        const PixelHint hint = from.prompt.hint[std::size_t(y) * std::size_t(from.prompt.width_px) + std::size_t(x)];
        if (is_object(hint) == object && (likely_too || is_certain(hint)))
          samples.push_back({from.photo.at(x, y, 0), from.photo.at(x, y, 1), from.photo.at(x, y, 2)});
      }
    if (samples.size() >= kComponents) break;
  }
  if (samples.size() <= max_samples) return samples;
  Colours fewer(max_samples);
  for (std::size_t i = 0; i < max_samples; ++i) fewer[i] = samples[i * samples.size() / max_samples];
  return fewer;
}

/// Cuts run in parallel, each on one thread. The setting of OpenCV is global and must not change while a cut runs, so
/// it is made once.
void one_thread() {
  static const bool set = (cv::setNumThreads(1), true);
  (void)set;
}

struct Mixtures {
  cv::Mat background, object;
};

Mixtures learn(const Colours& background, const Colours& object) {
  cv::Mat row(1, int(background.size() + object.size()), CV_8UC3), sides(row.size(), CV_8UC1);
  for (int i = 0; i < row.cols; ++i) {
    const bool is_object = std::size_t(i) >= background.size();
    const auto& colour = is_object ? object[std::size_t(i) - background.size()] : background[std::size_t(i)];
    row.at<cv::Vec3b>(0, i) = cv::Vec3b(colour[0], colour[1], colour[2]);
    sides.at<std::uint8_t>(0, i) = is_object ? cv::GC_FGD : cv::GC_BGD;
  }
  Mixtures mixtures;
  cv::grabCut(row, sides, {}, mixtures.background, mixtures.object, 1, cv::GC_INIT_WITH_MASK);
  return mixtures;
}

SideColours colours_in(const Source& from, int max_samples) {
  return {samples_of(from, true, std::size_t(max_samples)), samples_of(from, false, std::size_t(max_samples))};
}

void check(const ImageU8& photo, const ViewPrompt& prompt) {
  NGS_CHECK(photo.channels == 3 && photo.width_px == prompt.width_px && photo.height_px == prompt.height_px &&
                prompt.hint.size() == std::size_t(photo.pixels()),
            "GrabCut needs an RGB photo of the prompt's size");
}

PixelMask cut_in(const Source& from, const GrabCutOptions& options, const SideColours& known) {
  const ImageU8& photo = from.photo;
  const ViewPrompt& prompt = from.prompt;
  const cv::Rect& region = from.region;
  PixelMask mask(prompt.hint.size());
  for (std::size_t p = 0; p < mask.size(); ++p) mask[p] = is_object(prompt.hint[p]);
  if (region.empty() || known.background.size() < kComponents || known.object.size() < kComponents) return mask;

  one_thread();
  cv::theRNG().state = 0x9e3779b97f4a7c15ull ^ options.seed;
  const cv::Mat full(photo.height_px, photo.width_px, CV_8UC3, const_cast<std::uint8_t*>(photo.data.data()));
  const cv::Mat colours = full(region).clone();
  cv::Mat hints(region.size(), CV_8UC1);
  const auto index = [&](int x, int y) {
    return std::size_t(y + region.y) * std::size_t(photo.width_px) + std::size_t(x + region.x);
  };
  for (int y = 0; y < hints.rows; ++y)
    for (int x = 0; x < hints.cols; ++x) hints.at<std::uint8_t>(y, x) = std::uint8_t(prompt.hint[index(x, y)]);
  Mixtures mixtures = learn(known.background, known.object);
  cv::grabCut(colours, hints, {}, mixtures.background, mixtures.object, 1, cv::GC_EVAL_FREEZE_MODEL);
  if (options.iterations > 1)
    cv::grabCut(colours, hints, {}, mixtures.background, mixtures.object, options.iterations - 1, cv::GC_EVAL);
  for (int y = 0; y < hints.rows; ++y)
    for (int x = 0; x < hints.cols; ++x) mask[index(x, y)] = is_object(PixelHint(hints.at<std::uint8_t>(y, x)));
  return mask;
}

}  // namespace

PixelMask grab_cut(const ImageU8& photo, const ViewPrompt& prompt, const GrabCutOptions& options) {
  check(photo, prompt);
  const Source from{photo, prompt, region_of_interest(prompt, options.margin_px)};
  return cut_in(from, options, colours_in(from, kMaxSamples));
}

SideColours side_colours(const ImageU8& photo, const ViewPrompt& prompt, int max_samples) {
  check(photo, prompt);
  return colours_in({photo, prompt, {0, 0, photo.width_px, photo.height_px}}, max_samples);
}

PixelMask grab_cut(const ImageU8& photo, const ViewPrompt& prompt, const GrabCutOptions& options,
                   const SideColours& colours) {
  check(photo, prompt);
  return cut_in({photo, prompt, region_of_interest(prompt, options.margin_px)}, options, colours);
}

}  // namespace ngs
