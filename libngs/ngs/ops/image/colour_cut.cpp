#include "ngs/ops/image/colour_cut.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace ngs {
namespace {

using Colours = std::vector<std::array<std::uint8_t, 3>>;

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

}  // namespace

void colour_cut(HintedRegion& region, const SideColours& known, int iterations, std::uint64_t seed) {
  one_thread();
  cv::theRNG().state = 0x9e3779b97f4a7c15ull ^ seed;
  const cv::Mat colours(region.height_px, region.width_px, CV_8UC3, region.colour.data());
  cv::Mat hints(colours.size(), CV_8UC1, region.hint.data());  // the values of a hint are those of OpenCV
  Mixtures mixtures = learn(known.background, known.object);
  cv::grabCut(colours, hints, {}, mixtures.background, mixtures.object, 1, cv::GC_EVAL_FREEZE_MODEL);
  if (iterations > 1)
    cv::grabCut(colours, hints, {}, mixtures.background, mixtures.object, iterations - 1, cv::GC_EVAL);
}

}  // namespace ngs
