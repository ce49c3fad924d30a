// Image operations: means of cells, medians, differences of images, front layers.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/math/median.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/ops/splat/front_layer.h"
#include "ngs/scene/resize.h"
#include "support/cameras.h"
#include "support/stability.h"

namespace ngs {
namespace {

using test::Random;
using test::Worst;

ImageF noise(int width_px, int height_px, Random& random) {
  ImageF image(width_px, height_px, 1);
  image.data = random.uniform_vector<float>(image.data.size(), 0, 1);
  return image;
}

}  // namespace

HARD_CASE("pictures: the mean of a cell keeps its accuracy however large the cell is, also at the border",
          "side of a cell", {2, 16, 128, 512}, 0.88, {"running mean in float", 70}, 50) {
  const int factor = int(h), left_over = 1 + int(random.below(factor - 1));
  const ImageF image = noise(factor + left_over, factor, random);
  const ImageF cells = shrunk(image, factor);
  long double sum[2] = {0, 0};
  float naive = 0;
  for (int y = 0; y < factor; ++y)
    for (int x = 0; x < image.width_px; ++x) {
      sum[x >= factor] += image.at(x, y);
      if (x < factor) naive += image.at(x, y);
    }
  worst.ours(cells.at(0, 0), sum[0] / factor / factor);
  worst.ours(cells.at(1, 0), sum[1] / left_over / factor);
  worst.naive(naive / float(factor) / float(factor), sum[0] / factor / factor);
}

HARD_CASE("pictures: the median stays within the inliers for outliers of any size", "outliers",
          {1, 1e10, 1e300, INFINITY}, 0, {"mean", test::kWrong}) {
  std::vector<double> values = random.uniform_vector<double>(1 + std::size_t(random.below(20)), 0, 1);
  const std::vector<double> sample = values;
  for (std::size_t outliers = values.size() - 1; outliers > 0; --outliers) values.push_back(random.below(2) ? h : -h);
  const double middle = upper_median(values);
  worst.ours_is(std::count(sample.begin(), sample.end(), middle) == 1);
  const auto below = std::count_if(values.begin(), values.end(), [&](double v) { return v < middle; });
  worst.ours_is(below <= std::ptrdiff_t(values.size() / 2) &&
                std::count(values.begin(), values.end(), middle) + below > std::ptrdiff_t(values.size() / 2));
  double sum = 0;
  for (const double v : values) sum += v;
  worst.naive_is(sum / double(values.size()) >= -1 && sum / double(values.size()) <= 1);
}

HARD_CASE("pictures: the squared difference of nearly equal images keeps its accuracy", "their difference",
          {1e-1, 1e-3, 1e-5, 1e-6}, 3.1, {"E[a²] - 2 E[ab] + E[b²]", 2e12}, 10) {
  const ImageF a = noise(24, 20, random);
  ImageF b = a;
  for (float& v : b.data) v += float(random.uniform(-h, h));
  long double sum = 0;
  float aa = 0, ab = 0, bb = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) {
    const long double d = (long double)(a.data[i]) - b.data[i];
    sum += d * d;
    aa += a.data[i] * a.data[i];
    ab += a.data[i] * b.data[i];
    bb += b.data[i] * b.data[i];
  }
  const auto n = float(a.data.size());
  worst.ours(mean_squared_error({}, a, b), sum / (long double)(a.data.size()));
  worst.naive((aa - 2 * ab + bb) / n, sum / (long double)(a.data.size()));
}

HARD_CASE("front layer: a Gaussian is in front of a surface one ulp behind it, not of one at its own depth",
          "gap over depth", {1e-2, 1e-5, 1e-7, 0, NAN}, 0,
          {"inverse depths, as a depth buffer has them", test::kWrong}) {
  const float depth = float(random.uniform(1, 100));
  const float limit = h == 1e-7 ? std::nextafter(depth, INFINITY) : depth + depth * float(h);
  GaussianCloud cloud;
  cloud.resize(1, 0);
  cloud.position = {0, 0, depth};
  cloud.rotation = {1, 0, 0, 0};
  cloud.logit_opacity = {2};
  cloud.log_scale.assign(3, std::log(depth * 0.05f));
  const Camera camera = test::camera_along_z(16, 16, 20);
  const ImageF surface(16, 16, 1, limit), far(16, 16, 1, 1e30f);
  const std::vector<std::uint8_t> candidate{1}, marked(256, 1);
  const ViewSums sums = FrontView({}, cloud, surface, camera, {}).sums(candidate, marked);
  const double whole = FrontView({}, cloud, far, camera, {}).sums(candidate, marked).weight(0);
  const double front = sums.row.empty() ? 0 : sums.weight(0);
  const double of_marked = sums.row.empty() ? 0 : sums.object_weight(0, 0);
  worst.ours_is(whole > 0.5 && front == (h > 0 ? whole : 0) && of_marked == front);
  worst.naive_is((1 / limit < 1 / depth) == (h > 0));
}

}  // namespace ngs
