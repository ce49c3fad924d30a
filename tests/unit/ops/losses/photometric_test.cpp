#include "ngs/ops/losses/photometric.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "ngs/core/rng.h"
#include "ngs/ops/image/metrics.h"

namespace ngs {
namespace {

// The loss of 3DGS, written directly: a 2-D window, zero outside, not separable, in double.
PhotometricLoss reference_loss(const ImageF& x, const ImageF& y, double lambda, const ImageF* weight = nullptr,
                               PixelRect box = {}) {
  double window[11][11], total = 0;
  for (int j = 0; j < 11; ++j)
    for (int i = 0; i < 11; ++i)
      total += window[j][i] = std::exp(-((i - 5) * (i - 5) + (j - 5) * (j - 5)) / (2 * 1.5 * 1.5));
  if (box.empty()) box = {0, 0, x.width_px, x.height_px};
  double l1 = 0, ssim = 0, weights = 0;
  for (int py = box.y0; py < box.y1; ++py)
    for (int px = box.x0; px < box.x1; ++px) {
      const double w = weight ? double(weight->at(px, py)) : 1;
      weights += w;
      for (int c = 0; c < x.channels; ++c) {
        double mx = 0, my = 0, xx = 0, yy = 0, xy = 0;
        for (int j = -5; j <= 5; ++j)
          for (int i = -5; i <= 5; ++i) {
            if (px + i < 0 || py + j < 0 || px + i >= x.width_px || py + j >= x.height_px) continue;
            const double g = window[j + 5][i + 5] / total;
            const double a = double(x.at(px + i, py + j, c)), b = double(y.at(px + i, py + j, c));
            mx += g * a;
            my += g * b;
            xx += g * a * a;
            yy += g * b * b;
            xy += g * a * b;
          }
        l1 += w * std::abs(double(x.at(px, py, c)) - double(y.at(px, py, c)));
        ssim += w * (2 * mx * my + 1e-4) * (2 * (xy - mx * my) + 9e-4) /
                ((mx * mx + my * my + 1e-4) * (xx - mx * mx + yy - my * my + 9e-4));
      }
    }
  const double n = weights * x.channels;
  return {(1 - lambda) * l1 / n + lambda * (1 - ssim / n), l1 / n, ssim / n};
}

ImageF random_image(int w, int h, int c, std::uint64_t seed, float centre = 0.5f, float spread = 0.5f) {
  ImageF image(w, h, c);
  for (std::size_t i = 0; i < image.data.size(); ++i)
    image.data[i] = centre + spread * float(2 * rng_uniform(seed, RngStream::kTest, i) - 1);
  return image;
}

PhotometricLoss photometric_loss(const Exec& exec, const ImageF& rendered, const ImageF& target) {
  const auto value = PhotometricPass<float>().evaluate(exec, {}, {rendered, target}, nullptr);
  return {value.total, value.l1, value.ssim};
}

}  // namespace

TEST_CASE("the photometric loss equals a direct double-precision evaluation at every size around the window") {
  for (const int c : {1, 3, 4})
    for (const auto& size : {std::pair{1, 1}, {2, 1}, {1, 7}, {5, 6}, {10, 11}, {11, 12}, {33, 17}}) {
      const int w = size.first, h = size.second;
      CAPTURE(w);
      CAPTURE(h);
      CAPTURE(c);
      const ImageF x = random_image(w, h, c, 1), y = random_image(w, h, c, 2);
      const PhotometricLoss want = reference_loss(x, y, 0.2), got = photometric_loss({.threads = 2}, x, y);
      CHECK(got.l1 == doctest::Approx(want.l1).epsilon(1e-6));  // |x - y| is rounded to float once
      CHECK(std::abs(got.ssim - want.ssim) < 2e-6);
      CHECK(std::abs(got.total - want.total) < 1e-6);
    }
}

TEST_CASE("SSIM of nearly flat bright images stays within the rounding of its variances") {
  // σ² is the difference of numbers near 1 with 22 roundings each: |Δσ²| ≲ 22·6e-8, against C2 = 9e-4.
  const ImageF x = random_image(40, 30, 3, 5, 0.97f, 0.002f), y = random_image(40, 30, 3, 6, 0.97f, 0.002f);
  CHECK(std::abs(photometric_loss({}, x, y).ssim - reference_loss(x, y, 0.2).ssim) < 22 * 6e-8 / 9e-4);
}

// Rendered colours have no upper bound. The rounding error of 10⁴ - 10⁴ is as large as C2, with either sign.
TEST_CASE("SSIM of a flat image far above 1 stays between 0 and 1") {
  for (const float level : {30.f, 100.f, 300.f, 1000.f}) {
    CAPTURE(level);
    const ImageF bright = random_image(40, 40, 1, 3, level, 0), target = random_image(40, 40, 1, 3, 0.8f, 0);
    ImageF gradient(40, 40, 1);
    PhotometricPass<float> pass;
    const auto value = pass.evaluate({}, {.dssim_weight = 1, .box = {10, 10, 30, 30}}, {bright, target}, &gradient);
    CHECK(value.ssim >= 0);
    CHECK(value.ssim <= 1);
    CHECK(std::all_of(gradient.data.begin(), gradient.data.end(), [](float g) { return std::isfinite(g); }));
  }
}

TEST_CASE("a box and pixel weights restrict the loss to their pixels but not the windows") {
  const ImageF x = random_image(31, 27, 3, 7), y = random_image(31, 27, 3, 8), w = random_image(31, 27, 1, 9);
  for (const PixelRect box : {PixelRect{}, PixelRect{0, 0, 5, 4}, PixelRect{12, 9, 13, 10}, PixelRect{20, 20, 31, 27},
                              PixelRect{3, 2, 30, 26}})
    for (const ImageF* weight : {static_cast<const ImageF*>(nullptr), &w}) {
      ImageF gradient;
      const PhotometricOptions options{.dssim_weight = 0.3, .box = box};
      const auto got = PhotometricPass<float>().evaluate({}, options, {x, y, weight}, &gradient);
      CHECK(std::abs(got.total - reference_loss(x, y, 0.3, weight, box).total) < 2e-6);
      if (box.empty()) continue;
      for (int py = 0; py < 27; ++py)
        for (int px = 0; px < 31; ++px)  // nothing outside any window is touched
          if (px < box.x0 - 5 || px >= box.x1 + 5 || py < box.y0 - 5 || py >= box.y1 + 5)
            CHECK(gradient.at(px, py, 1) == 0.f);
    }
}

TEST_CASE("weights that are all zero give zero loss and zero gradient") {
  const ImageF x = random_image(8, 8, 3, 7), y = random_image(8, 8, 3, 8), w(8, 8, 1);
  ImageF gradient;
  const auto value = PhotometricPass<float>().evaluate({}, {}, {x, y, &w}, &gradient);
  CHECK(value.total == 0.0);
  CHECK(gradient.data == std::vector<float>(gradient.data.size(), 0.f));
}

TEST_CASE("the photometric gradient has the same bytes for any thread count") {
  const ImageF x = random_image(67, 41, 3, 7), y = random_image(67, 41, 3, 8);
  ImageF one, three;
  const auto a = PhotometricPass<float>().evaluate({.threads = 1}, {}, {x, y}, &one);
  const auto b = PhotometricPass<float>().evaluate({.threads = 3}, {}, {x, y}, &three);
  CHECK(a.total == b.total);
  CHECK(one.data == three.data);
}

TEST_CASE("a photometric pass reused for other image sizes gives the bytes of a new one") {
  Exec serial;
  PhotometricPass<float> used;
  for (const auto& size : {std::pair{140, 30}, {33, 17}, {47, 160}, {140, 30}, {9, 3}}) {
    CAPTURE(size.first);
    CAPTURE(size.second);
    const ImageF x = random_image(size.first, size.second, 3, 11), y = random_image(size.first, size.second, 3, 12);
    ImageF g, h;
    CHECK(used.evaluate(serial, {}, {x, y}, &g).total ==
          PhotometricPass<float>().evaluate(serial, {}, {x, y}, &h).total);
    CHECK(g.data == h.data);
  }
}

TEST_CASE("psnr_db measures a known error and is infinite for equal images") {
  ImageF x(4, 3, 3, 0.25f), y(4, 3, 3, 0.35f);
  CHECK(psnr_db({}, x, y) == doctest::Approx(20.0).epsilon(1e-6));
  CHECK(std::isinf(psnr_db({}, x, x)));
  CHECK(ssim_index({}, x, x) == doctest::Approx(1.0));
  ImageF weight(4, 3, 1);
  weight.at(2, 1) = 1;
  y.at(2, 1, 0) = y.at(2, 1, 1) = y.at(2, 1, 2) = 1.25f;
  CHECK(psnr_db({}, x, y, &weight) == doctest::Approx(0.0));
}

}  // namespace ngs
