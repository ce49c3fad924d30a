#include "ngs/ops/splat/front_layer.h"

#include <doctest/doctest.h>

#include "support/splat_reference.h"

namespace ngs {
namespace {

struct FrontCase {
  test::SplatCase splat;
  GaussianCloud cloud;
  ImageF limit;
  std::vector<std::uint8_t> candidate, marked;
  std::vector<float> value;  // [N, 2]
};

FrontCase front_case(std::uint64_t seed, int gaussians) {
  FrontCase c{test::splat_case(seed, gaussians, 45, 37), {}, ImageF(45, 37, 1), {}, {}, {}};
  c.cloud = test::float_cloud(c.splat);
  for (std::size_t p = 0; p < c.limit.data.size(); ++p) {
    c.limit.data[p] = p % 7 == 0 ? 0.f : 2.5f + float(p % 5);  // the depths lie in 1.5 to 6
    c.marked.push_back(p % 3 == 0);
  }
  for (int i = 0; i < gaussians; ++i) {
    c.candidate.push_back(i % 4 != 0);
    c.value.push_back(float(i));
    c.value.push_back(0.5f);
  }
  return c;
}

}  // namespace

// The error of a weight per pixel is below 1e-6 (see evidence_test), or a whole contribution where the reference lies
// at a threshold; such cases are skipped. A row sums at most 1665 pixels, a value is at most 60.
TEST_CASE("front view: layers and sums in front of a surface equal a brute-force evaluation in double") {
  int compared = 0;
  for (const int gaussians : {0, 1, 2, 60})
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      CAPTURE(gaussians);
      CAPTURE(seed);
      FrontCase c = front_case(seed, gaussians);
      if (seed % 2)  // tiles without surface
        for (int y = 0; y < c.limit.height_px; ++y)
          for (int x = 16; x < c.limit.width_px; ++x) c.limit.at(x, y, 0) = 0;
      const auto image = test::reference_render(c.splat, {});
      std::vector<double> depth, front(c.candidate.size()), marked = front;
      for (int i = 0; i < gaussians; ++i) depth.push_back(test::reference_gaussian(c.splat, i, {}).z);
      std::vector<double> layer(image.size() * 3, 0.0);
      bool clear = true;
      for (std::size_t p = 0; p < image.size(); ++p) {
        clear &= image[p].closest_threshold > 1e-5;
        for (const auto& [g, w] : image[p].weight) {
          const auto i = std::size_t(g);
          if (!c.candidate[i] || !(depth[i] < double(c.limit.data[p]))) continue;
          front[i] += w;
          marked[i] += c.marked[p] ? w : 0;
          for (std::size_t k = 0; k < 2; ++k) layer[3 * p + k] += w * double(c.value[2 * i + k]);
          layer[3 * p + 2] += w;
        }
      }
      if (!clear) continue;
      ++compared;
      for (const int threads : {1, 3}) {
        std::vector<double> left = front;
        const Exec exec{.threads = threads};
        const FrontView view(exec, c.cloud, c.limit, c.splat.camera, {});
        const RowNumbers of(c.candidate);  // every row but each fourth: a row's number is not its place in the model
        std::vector<float> value;
        for (const std::int64_t i : of.row)
          value.insert(value.end(), {c.value[std::size_t(2 * i)], c.value[std::size_t(2 * i + 1)]});
        const ImageF got = view.layer({of, {value.data(), of.size(), 2}});
        double worst = 0;
        for (std::size_t i = 0; i < layer.size(); ++i)
          worst = std::max(worst, std::abs(double(got.data[i]) - layer[i]));
        CHECK(worst < 1e-6 * 60 * 4);
        const ImageF weight = view.layer(c.candidate);
        for (std::size_t p = 0; p < image.size(); ++p) CHECK(weight.data[p] == got.data[3 * p + 2]);
        const ViewSums sums = view.sums(c.candidate, c.marked);
        for (std::size_t k = 0; k < sums.size(); ++k) {
          const std::size_t i = sums.row[k];
          CHECK(std::abs(sums.weight(k) - front[i]) < 2e-3);
          CHECK(std::abs(sums.object_weight(k, 0) - marked[i]) < 2e-3);
          left[i] = 0;
        }
        for (const double missed : left) CHECK(missed < 2e-3);
      }
    }
  CHECK(compared >= 12);
}

TEST_CASE("front view: a surface of another size than the view throws") {
  const FrontCase c = front_case(3, 40);
  for (const ImageF& limit : {ImageF(45, 37, 3), ImageF(44, 37, 1), ImageF(450, 370, 1)})
    CHECK_THROWS(FrontView({}, c.cloud, limit, c.splat.camera, {}));
}

TEST_CASE("front view: without a surface nothing is in front") {
  FrontCase c = front_case(3, 40);
  CHECK(!FrontView({}, c.cloud, c.limit, c.splat.camera, {}).sums(c.candidate, c.marked).row.empty());
  c.limit = ImageF(45, 37, 1);
  CHECK(FrontView({}, c.cloud, c.limit, c.splat.camera, {}).sums(c.candidate, c.marked).row.empty());
}

}  // namespace ngs
