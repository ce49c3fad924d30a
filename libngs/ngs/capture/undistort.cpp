#include "ngs/capture/undistort.h"

#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/core/error.h"
#include "ngs/math/pixel_grid.h"

namespace ngs {
namespace {

constexpr double kLargest = 2, kScanStep = 0.01;

Vec2<double> photo_px(const Camera& camera, const Lens& lens, Vec2<double> p) {
  const Vec2<double> at = distort(lens, p);
  return {camera.fx * at.x + camera.cx, camera.fy * at.y + camera.cy};
}

/// Whether the distorted radius grows all the way from the principal point to p, within the photo.
bool is_monotonic(const Camera& camera, const Lens& lens, Vec2<double> p) {
  constexpr int kSteps = 32;
  constexpr double kRounding_px = 1e-6;
  double before = 0;
  for (int i = 1; i <= kSteps; ++i) {
    const double left = 1 - double(i) / kSteps, part = 1 - left * left;  // dense near p, where a fold would begin
    const Vec2<double> at = photo_px(camera, lens, {part * p.x, part * p.y});
    const double out = std::hypot(at.x - camera.cx, at.y - camera.cy);
    const bool within = at.x >= -kRounding_px && at.x <= camera.width_px + kRounding_px && at.y >= -kRounding_px &&
                        at.y <= camera.height_px + kRounding_px;
    if (!within || !(out > before)) return false;
    before = out;
  }
  return true;
}

/// Whether the photo's rectangle, scaled around the principal point, lies in the photo after distortion.
bool fits(const Camera& camera, const Lens& lens, double scale) {
  constexpr int kSamples = 64;  // per side
  const double x0 = -scale * camera.cx / camera.fx, x1 = scale * (camera.width_px - camera.cx) / camera.fx;
  const double y0 = -scale * camera.cy / camera.fy, y1 = scale * (camera.height_px - camera.cy) / camera.fy;
  for (int i = 0; i <= kSamples; ++i) {
    const double part = double(i) / kSamples, x = x0 + part * (x1 - x0), y = y0 + part * (y1 - y0);
    for (const Vec2<double> p : {Vec2<double>{x, y0}, {x, y1}, {x0, y}, {x1, y}})
      if (!is_monotonic(camera, lens, p)) return false;
  }
  return true;
}

/// The largest scale up to which all scales fit.
double largest_scale(const Camera& camera, const Lens& lens) {
  double good = 0, bad = kScanStep;
  while (bad <= kLargest && fits(camera, lens, bad)) {
    good = bad;
    bad += kScanStep;
  }
  if (bad > kLargest) return kLargest;
  for (int i = 0; i < 30; ++i) {
    const double middle = (good + bad) / 2;
    (fits(camera, lens, middle) ? good : bad) = middle;
  }
  return good;
}

}  // namespace

Camera undistorted_camera(const LensCamera& distorted) {
  const auto& [camera, lens] = distorted;
  const double scale = largest_scale(camera, lens), width = scale * camera.width_px, height = scale * camera.height_px;
  if (width < 1 || height < 1)
    throw Error(ErrorCode::kBadInput,
                camera.name +
                    ": the lens allows no undistorted image, expected one that keeps the order of"
                    " directions and a principal point in the photo",
                "check its distortion parameters");
  Camera pinhole = camera;
  pinhole.width_px = int(width);
  pinhole.height_px = int(height);
  pinhole.cx = scale * camera.cx - (width - pinhole.width_px) / 2;
  pinhole.cy = scale * camera.cy - (height - pinhole.height_px) / 2;
  return pinhole;
}

std::vector<std::uint16_t> undistorted(const Exec& exec, const MaskSamples& photo, const LensCamera& distorted,
                                       const Camera& to, Resampling resampling) {
  const Camera from = resized(distorted.camera, photo.width_px, photo.height_px);
  const auto channels = std::size_t(photo.channels), row = std::size_t(to.width_px) * channels;
  const auto sample = [&](Vec2<double> at, std::size_t channel) {
    return read_bilinear(at.x, at.y, photo.width_px, photo.height_px, [&](int i, int j) {
      return photo.data[(std::size_t(j) * std::size_t(photo.width_px) + std::size_t(i)) * channels + channel];
    });
  };
  std::vector<std::uint16_t> out(row * std::size_t(to.height_px));
  for_each_index(exec, to.height_px, [&](std::int64_t y) {
    for (int x = 0; x < to.width_px; ++x) {
      Vec2<double> at = photo_px(from, distorted.lens, {(x + 0.5 - to.cx) / to.fx, (double(y) + 0.5 - to.cy) / to.fy});
      if (resampling == Resampling::kNearest) at = {std::floor(at.x) + 0.5, std::floor(at.y) + 0.5};
      for (std::size_t c = 0; c < channels; ++c)
        out[std::size_t(y) * row + std::size_t(x) * channels + c] = std::uint16_t(std::lround(sample(at, c)));
    }
  });
  return out;
}

}  // namespace ngs
