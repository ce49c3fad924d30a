#include "ngs/ops/image/image_metrics.h"

#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/ops/losses/photometric.h"

namespace ngs {

double mean_squared_error(const Exec& exec, const ImageF& a, const ImageF& b, const ImageF* weight) {
  NGS_CHECK(a.width_px == b.width_px && a.height_px == b.height_px && a.channels == b.channels,
            "mean_squared_error: the images differ in size");
  std::vector<double> row_sum(std::size_t(a.height_px)), row_weight(std::size_t(a.height_px));
  for_each_index(exec, a.height_px, [&](std::int64_t y) {
    double sum = 0, weights = 0;
    for (int x = 0; x < a.width_px; ++x) {
      const double w = weight ? double(weight->at(x, int(y))) : 1.0;
      for (int c = 0; c < a.channels; ++c) {
        const double d = double(a.at(x, int(y), c)) - double(b.at(x, int(y), c));
        sum += w * d * d;
      }
      weights += w;
    }
    row_sum[std::size_t(y)] = sum, row_weight[std::size_t(y)] = weights;
  });
  double sum = 0, weights = 0;
  for (std::size_t y = 0; y < row_sum.size(); ++y) sum += row_sum[y], weights += row_weight[y];
  return sum / (weights * a.channels);
}

double psnr_db(const Exec& exec, const ImageF& a, const ImageF& b, const ImageF* weight) {
  return -10.0 * std::log10(mean_squared_error(exec, a, b, weight));
}

double ssim_index(const Exec& exec, const ImageF& a, const ImageF& b, const ImageF* weight) {
  return PhotometricPass<float>().evaluate(exec, {}, {a, b, weight}, nullptr).ssim;
}

}  // namespace ngs
