#include "ngs/ops/image/grab_cut.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "ngs/core/check.h"

namespace ngs {
namespace {

constexpr std::size_t kComponents = 5;         // of the mixture of each side, fixed in OpenCV
constexpr std::size_t kMostSamples = 1 << 15;  // per side; more do not change a mixture of five

/// The part of the image that may change, with a margin.
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

/// Pixels of one side for its mixture: the certain ones, and where they are too few the likely ones too.
std::vector<cv::Vec3b> samples_of(const cv::Mat& photo, const cv::Mat& hints, bool object) {
  std::vector<cv::Vec3b> samples;
  for (const bool likely_too : {false, true}) {
    samples.clear();
    for (int y = 0; y < photo.rows; ++y)
      for (int x = 0; x < photo.cols; ++x) {
        const auto hint = PixelHint(hints.at<std::uint8_t>(y, x));
        if (is_object(hint) == object && (likely_too || is_certain(hint))) samples.push_back(photo.at<cv::Vec3b>(y, x));
      }
    if (samples.size() >= kComponents) break;
  }
  if (samples.size() <= kMostSamples) return samples;
  std::vector<cv::Vec3b> fewer(kMostSamples);
  for (std::size_t i = 0; i < kMostSamples; ++i) fewer[i] = samples[i * samples.size() / kMostSamples];
  return fewer;
}

/// Cuts run side by side, each on one thread; the setting is the process's, and must not be made while another runs.
void one_thread() {
  static const bool set = (cv::setNumThreads(1), true);
  (void)set;
}

struct Mixtures {
  cv::Mat background, object;
};

Mixtures learn(const std::vector<cv::Vec3b>& background, const std::vector<cv::Vec3b>& object) {
  cv::Mat row(1, int(background.size() + object.size()), CV_8UC3), sides(row.size(), CV_8UC1);
  for (int i = 0; i < row.cols; ++i) {
    const bool is_object = std::size_t(i) >= background.size();
    row.at<cv::Vec3b>(0, i) = is_object ? object[std::size_t(i) - background.size()] : background[std::size_t(i)];
    sides.at<std::uint8_t>(0, i) = is_object ? cv::GC_FGD : cv::GC_BGD;
  }
  Mixtures mixtures;
  cv::grabCut(row, sides, {}, mixtures.background, mixtures.object, 1, cv::GC_INIT_WITH_MASK);
  return mixtures;
}

}  // namespace

PixelMask grab_cut(const ImageU8& photo, const ViewPrompt& prompt, const GrabCutOptions& options) {
  NGS_CHECK(photo.channels == 3 && photo.width_px == prompt.width_px && photo.height_px == prompt.height_px &&
                prompt.hint.size() == std::size_t(photo.pixels()),
            "GrabCut needs an RGB photo of the prompt's size");
  PixelMask mask(prompt.hint.size());
  for (std::size_t p = 0; p < mask.size(); ++p) mask[p] = is_object(prompt.hint[p]);
  const cv::Rect region = region_of_interest(prompt, options.margin_px);
  if (region.empty()) return mask;

  one_thread();
  cv::theRNG().state = 0x9e3779b97f4a7c15ull ^ options.seed;
  const cv::Mat whole(photo.height_px, photo.width_px, CV_8UC3, const_cast<std::uint8_t*>(photo.data.data()));
  const cv::Mat colours = whole(region).clone();
  cv::Mat hints(region.size(), CV_8UC1);
  const auto index = [&](int x, int y) {
    return std::size_t(y + region.y) * std::size_t(photo.width_px) + std::size_t(x + region.x);
  };
  for (int y = 0; y < hints.rows; ++y)
    for (int x = 0; x < hints.cols; ++x) hints.at<std::uint8_t>(y, x) = std::uint8_t(prompt.hint[index(x, y)]);
  const std::vector<cv::Vec3b> background = samples_of(colours, hints, false),
                               object = samples_of(colours, hints, true);
  if (background.size() < kComponents || object.size() < kComponents) return mask;

  Mixtures mixtures = learn(background, object);
  cv::grabCut(colours, hints, {}, mixtures.background, mixtures.object, 1, cv::GC_EVAL_FREEZE_MODEL);
  if (options.iterations > 1)
    cv::grabCut(colours, hints, {}, mixtures.background, mixtures.object, options.iterations - 1, cv::GC_EVAL);
  for (int y = 0; y < hints.rows; ++y)
    for (int x = 0; x < hints.cols; ++x) mask[index(x, y)] = is_object(PixelHint(hints.at<std::uint8_t>(y, x)));
  return mask;
}

}  // namespace ngs
