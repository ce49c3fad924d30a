// Pose steps, contour refinement and Anderson acceleration on underdetermined data.         paper.md §5.3, §5.10, §5.11
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/ops/image/contour_refine.h"
#include "ngs/ops/optim/anderson.h"
#include "ngs/ops/optim/pose_step.h"
#include "support/cameras.h"
#include "support/stability.h"

namespace ngs {
namespace {

using test::Random;
using test::Worst;

constexpr int kWidth = 48, kHeight = 40;
constexpr double kFocal_px = 60, kDepth = 5;

ImageF picture(const auto& colour_at) {
  ImageF image(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = float(colour_at(x, y, c));
  return image;
}

Camera front_camera() { return test::camera_along_z(kWidth, kHeight, kFocal_px); }

/// A fronto-parallel plane that fills the image.
RenderedView front_view(const auto& colour_at) {
  const ImageF alpha(kWidth, kHeight, 1, 1.f), depth(kWidth, kHeight, 1, float(kDepth));
  return {kWidth, kHeight, picture(colour_at), {}, alpha, depth};
}

std::vector<std::uint8_t> left_of(int edge) {
  std::vector<std::uint8_t> mask;
  for (int p = 0; p < kWidth * kHeight; ++p) mask.push_back(p % kWidth < edge);
  return mask;
}

std::vector<float> refined(const std::vector<std::uint8_t>& mask, const ImageF& photo) {
  return refine_contour({}, {mask.data(), kWidth, kHeight}, photo);
}

bool contour_is_at(const std::vector<float>& soft, int edge) {
  for (std::size_t p = 0; p < soft.size(); ++p)
    if (!(soft[p] >= 0 && soft[p] <= 1 && (soft[p] > 0.5f) == (int(p) % kWidth < edge))) return false;
  return true;
}

double norm(const std::vector<double>& v) {
  double square = 0;
  for (const double x : v) square += x * x;
  return std::sqrt(square);
}

/// The normal equations of a shift from image gradients, in the textbook form.
struct NormalEquations {
  float xx = 0, xy = 0, yy = 0, xr = 0, yr = 0;
};
NormalEquations normal_equations(const RenderedView& view, const ImageF& photo) {
  NormalEquations n;
  for (int y = 1; y + 1 < kHeight; ++y)
    for (int x = 1; x + 1 < kWidth; ++x) {
      const float gx = view.colour.at(x + 1, y, 0) - view.colour.at(x - 1, y, 0),
                  gy = view.colour.at(x, y + 1, 0) - view.colour.at(x, y - 1, 0),
                  r = photo.at(x, y, 0) - view.colour.at(x, y, 0);
      n.xx += gx * gx;
      n.xy += gx * gy;
      n.yy += gy * gy;
      n.xr += gx * r;
      n.yr += gy * r;
    }
  return n;
}

/// Length of the shift.
double flow_by_cramer_px(const NormalEquations& n) {
  const float det = n.xx * n.yy - n.xy * n.xy;
  return 2 *
         std::hypot((n.xr * n.yy - n.yr * n.xy) / det, (n.xx * n.yr - n.xy * n.xr) / det);  // 2: differences over 2 px
}

}  // namespace

HARD_CASE("pose step: with image structure in one direction only, the step stays within the observed shift",
          "contrast along the stripes", {1, 1e-2, 1e-4, 0}, 0, {"2x2 normal equations by Cramer's rule", test::kWrong},
          20) {
  const double phase = random.uniform(0, 6), shift_px = random.uniform(0.1, 0.4);
  const auto stripes = [&](double x, double y) {
    return 0.5 + 0.2 * std::sin(0.4 * x + phase) + 0.2 * h * std::sin(0.3 * y + phase);
  };
  const RenderedView view = front_view([&](int x, int y, int) { return stripes(x, y); });
  const ImageF photo = picture([&](int x, int y, int) { return stripes(x - shift_px, y); });
  const PoseStep step = pose_step(view, smoothed_for_pose(photo), front_camera(), {});
  worst.ours_is(step.determined && step.flow_px > 0.5 * shift_px && step.flow_px < 1.5 * shift_px);
  const double naive_px = flow_by_cramer_px(normal_equations(view, photo));
  worst.naive_is(naive_px > 0.5 * shift_px && naive_px < 1.5 * shift_px);
}

HARD_CASE("pose step: a photo with another exposure than the renders gives the same camera motion", "gain of the photo",
          {1, 0.9, 0.75, 0.5, 0.3}, 0, {"Gauss-Newton on the colours as they are", test::kWrong}, 20) {
  const double phase = random.uniform(0, 6), shift_px = random.uniform(0.1, 0.4), offset = random.uniform(0, 1 - h);
  // brighter on one side, as under real light: gradient and colour are then not independent
  const auto lit = [&](double x, double y) {
    return 0.3 + 0.008 * x + 0.1 * std::sin(0.5 * x + 0.2 * y + phase) + 0.1 * std::sin(0.4 * y - 0.3 * x);
  };
  const RenderedView view = front_view([&](int x, int y, int) { return lit(x, y); });
  const ImageF photo = picture([&](int x, int y, int) { return offset + h * lit(x - shift_px, y); });
  const PoseStep step = pose_step(view, smoothed_for_pose(photo), front_camera(), {});
  const double moved_px = kFocal_px * (step.motion.turn.y + step.motion.move.x / kDepth);
  worst.ours_is(step.determined && std::abs(moved_px - shift_px) < 0.2 * shift_px);
  double xx = 0, xr = 0;
  for (int y = 1; y + 1 < kHeight; ++y)
    for (int x = 1; x + 1 < kWidth; ++x) {
      const double gx = 0.5 * double(view.colour.at(x + 1, y, 0) - view.colour.at(x - 1, y, 0));
      xx += gx * gx;
      xr -= gx * double(photo.at(x, y, 0) - view.colour.at(x, y, 0));
    }
  worst.naive_is(std::abs(xr / xx - shift_px) < 0.2 * shift_px);
}

HARD_CASE("pose step: a motion of several pixels is found on one render", "shift in px", {0.3, 1, 2, 3}, 0,
          {"one Gauss-Newton step", test::kWrong}, 20) {
  const double phase = random.uniform(0, 6);
  const auto texture = [&](double x, double y) {
    return 0.5 + 0.15 * std::sin(0.4 * x + 0.1 * y + phase) + 0.15 * std::sin(0.3 * y - 0.2 * x);
  };
  const RenderedView view = front_view([&](int x, int y, int) { return texture(x, y); });
  const ImageF photo = picture([&](int x, int y, int) { return texture(x - h, y); });
  const PoseStep step = pose_step(view, smoothed_for_pose(photo), front_camera(), {});
  worst.ours_is(step.determined && std::abs(step.flow_px - h) < 0.05);
  worst.naive_is(std::abs(flow_by_cramer_px(normal_equations(view, photo)) - h) < 0.05);
}

HARD_CASE("pose step: a photo without texture, or with a NaN, moves no camera", "amplitude of the texture",
          {0.2, 1e-4, 1e-6, 0, NAN}, 0, {"2x2 normal equations by Cramer's rule", test::kWrong}, 20) {
  const double shade = random.uniform(0.2, 0.8), phase = random.uniform(0, 6);
  const auto texture = [&](double x, double y) {
    return shade + (h > 0 ? h : 0.0) * 0.5 * (std::sin(0.4 * x + phase) + std::sin(0.3 * y + phase));
  };
  const RenderedView view = front_view([&](int x, int y, int) { return texture(x, y); });
  ImageF photo = picture([&](int x, int y, int) { return texture(x - 0.3, y) + 1e-3 * random.uniform(-1, 1); });
  if (std::isnan(h)) photo.at(5 + int(random.below(kWidth - 10)), 5 + int(random.below(kHeight - 10))) = NAN;
  const PoseStep step = pose_step(view, smoothed_for_pose(photo), front_camera(), {});
  const double naive_px = flow_by_cramer_px(normal_equations(view, photo));
  if (h > 0.1) {
    worst.ours_is(step.determined && std::abs(step.flow_px - 0.3) < 0.15);
    worst.naive_is(std::abs(naive_px - 0.3) < 0.15);
    return;
  }
  worst.ours_is(!step.determined && step.flow_px == 0 && norm({step.motion.turn.x, step.motion.move.x}) == 0);
  worst.naive_is(naive_px < 1e-3);
}

HARD_CASE("contour refinement: colours without variance still have a density, and the contour finds the edge",
          "noise of the photo", {1e-2, 1e-4, 1e-6, 0}, 0,
          {"normal density with the sample covariance as it is", test::kWrong}, 50) {
  const int edge = 20 + int(random.below(8)), start = edge - 3 + int(random.below(7));
  const double contrast = random.uniform(0.2, 0.5);
  const ImageF photo = picture(
      [&](int x, int, int c) { return 0.4 + (x < edge ? contrast * (c + 1) / 3 : 0.0) + h * random.uniform(-1, 1); });
  worst.ours_is(contour_is_at(refined(left_of(start), photo), edge));
  float n = 0, sum = 0, square = 0;
  for (int x = 0; x < edge; ++x) {
    const float v = photo.at(x, 3, 0);
    n += 1;
    sum += v;
    square += v * v;
  }
  const float variance = square / n - sum / n * (sum / n);
  worst.naive_is(variance > 0);
}

HARD_CASE("contour refinement: a photo with almost no contrast leaves the contour unchanged",
          "contrast at another place", {0.3, 1e-3, 1e-4, 1e-5, 0}, 0,
          {"weights exp(-d² / mean d²) alone", test::kWrong}, 50) {
  const int start = 16 + int(random.below(16)), edge = start + (random.below(2) ? 3 : -3);
  const double shade = random.uniform(0.2, 0.8);
  const ImageF photo = picture([&](int x, int, int) { return shade + (x < edge ? h : 0.0); });
  const bool moves = h > 0.1;
  worst.ours_is(contour_is_at(refined(left_of(start), photo), moves ? edge : start));
  float steps = 0, n = 0;
  for (int x = 0; x + 1 < kWidth; ++x, ++n) {
    const float d = photo.at(x + 1, 0, 0) - photo.at(x, 0, 0);
    steps += d * d;
  }
  float across[2];  // the weight at the given contour and at the photo's edge
  for (const int at : {start, edge}) {
    const float d = photo.at(at, 0, 0) - photo.at(at - 1, 0, 0);
    across[at == edge] = std::exp(-d * d / (steps / n));
  }
  worst.naive_is((across[0] > across[1]) == moves);
}

HARD_CASE("contour refinement: NaN and Inf colours are ignored, and the contour finds the edge", "non-finite colours",
          {0, 1, 20, 200}, 0, {"colours relative to their mean", test::kWrong}, 50) {
  const int edge = 20 + int(random.below(8)), start = edge - 2 + int(random.below(5));
  ImageF photo = picture([&](int x, int, int c) { return 0.4 + (x < edge ? 0.1 * (c + 1) : 0.0); });
  for (int i = 0; i < int(h); ++i) {  // away from the edge: on it there would be no contrast
    const int x = (edge + 3 + int(random.below(kWidth - 6))) % kWidth, y = int(random.below(kHeight));
    photo.at(x, y, int(random.below(3))) = random.below(2) ? NAN : INFINITY;
  }
  worst.ours_is(contour_is_at(refined(left_of(start), photo), edge));
  float sum = 0;
  for (const float v : photo.data) sum += v;
  worst.naive_is(std::isfinite(sum / float(photo.data.size())));
}

HARD_CASE("contour refinement: in images of a few columns the contour finds the edge; below 4 columns it stays",
          "columns", {16, 4, 2, 1}, 0, {"mean step along the rows", test::kWrong}, 50) {
  const int width = int(h), height = random.below(8) > 0 ? 40 : 1;
  const int edge = 18 + int(random.below(4)), start = edge - 2 + int(random.below(5));
  ImageF photo(width, height, 3);
  std::vector<std::uint8_t> mask;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      mask.push_back(y < start);
      for (int c = 0; c < 3; ++c) photo.at(x, y, c) = y < edge ? 0.7f : 0.3f;
    }
  const std::vector<float> soft = refine_contour({}, {mask.data(), width, height}, photo);
  const int found = width >= 4 ? edge : start;
  bool fine = true;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float here = soft[std::size_t(y * width + x)];
      fine &= here >= 0 && here <= 1 && (here > 0.5f) == (y < found);
    }
  worst.ours_is(fine);
  float steps = 0;
  for (int x = 0; x + 1 < width; ++x) steps += std::abs(photo.at(x + 1, 0, 0) - photo.at(x, 0, 0));
  worst.naive_is(std::isfinite(steps / float(width - 1)));
}

HARD_CASE("anderson: steps that have become parallel still lead to the fixed point", "angle between the steps",
          {1, 1e-4, 1e-8, 1e-12, 0}, 0, {"normal equations by Cramer's rule", test::kWrong}, 10) {
  const double rate = random.uniform(0.2, 0.8);
  const std::vector<double> fixed = random.uniform_vector<double>(4, -1, 1);
  std::vector<double> x = random.uniform_vector<double>(4, -1, 1);
  const std::vector<double> start = x, weight(4, 1.0);
  Anderson accelerated(3);
  std::vector<std::vector<double>> step;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> f(4);
    for (std::size_t i = 0; i < 4; ++i) f[i] = (i == 0 ? rate + h * 0.1 : rate) * (fixed[i] - x[i]);
    step.push_back(f);
    const std::vector<double> next = accelerated.next(x, f, weight);
    if (k < 2)
      for (std::size_t i = 0; i < 4; ++i) x[i] += f[i];
    else
      x = next;
  }
  double error = 0, distance = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    error = std::max(error, std::abs(x[i] - fixed[i]));
    distance = std::max(distance, std::abs(start[i] - fixed[i]));
  }
  worst.ours_is(error <= 1e-4 * distance);
  double aa = 0, ab = 0, bb = 0, ra = 0, rb = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double a = step[1][i] - step[0][i], b = step[2][i] - step[1][i];
    aa += a * a;
    ab += a * b;
    bb += b * b;
    ra += a * step[2][i];
    rb += b * step[2][i];
  }
  const double det = aa * bb - ab * ab, g0 = (ra * bb - rb * ab) / det, g1 = (aa * rb - ab * ra) / det;
  double naive = 0;
  for (std::size_t i = 0; i < 4; ++i)
    naive = std::max(naive, std::abs(step[2][i] - g0 * (step[1][i] - step[0][i]) - g1 * (step[2][i] - step[1][i])));
  worst.naive_is(naive <= 1e-4 * distance);
}

HARD_CASE("anderson: after parallel steps, a step in a new direction is not extrapolated beyond its own length",
          "angle between the steps before", {1, 1e-6, 1e-8, 1e-10, 1e-12, 0}, 0.8,
          {"normal equations by elimination", test::kWrong}) {
  constexpr std::size_t kUnknowns = 6, kPast = 4;
  const std::vector<double> direction = random.uniform_vector<double>(kUnknowns, -1, 1), weight(kUnknowns, 1.0);
  std::vector<double> x = random.uniform_vector<double>(kUnknowns, -1, 1), f(kUnknowns);
  const double rate = random.uniform(0.3, 0.6);
  Anderson accelerated(kPast);
  std::vector<std::vector<double>> points, steps;
  double size = 1;
  for (std::size_t k = 0; k <= kPast; ++k, size *= rate) {
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      const double noise = random.uniform(-1, 1);
      f[i] = size * (k < kPast ? direction[i] + h * noise : noise);
    }
    points.push_back(x);
    steps.push_back(f);
    x = accelerated.next(x, f, weight);
  }
  std::vector<double> move(kUnknowns);
  for (std::size_t i = 0; i < kUnknowns; ++i) move[i] = x[i] - points[kPast][i];
  if (h < 1) worst.ours_ratio(norm(move) / norm(f));

  double gram[kPast][kPast + 1] = {};
  const auto change = [](const auto& of, std::size_t k, std::size_t i) { return of[k + 1][i] - of[k][i]; };
  for (std::size_t a = 0; a < kPast; ++a)
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      for (std::size_t b = 0; b < kPast; ++b) gram[a][b] += change(steps, a, i) * change(steps, b, i);
      gram[a][kPast] += change(steps, a, i) * f[i];
    }
  for (std::size_t a = 0; a < kPast; ++a)
    for (std::size_t r = 0; r < kPast; ++r) {
      const double share = r == a ? 0 : gram[r][a] / gram[a][a];
      for (std::size_t c = a; c <= kPast; ++c) gram[r][c] -= share * gram[a][c];
    }
  std::vector<double> naive = f;
  for (std::size_t a = 0; a < kPast; ++a)
    for (std::size_t i = 0; i < kUnknowns; ++i)
      naive[i] -= gram[a][kPast] / gram[a][a] * (change(points, a, i) + change(steps, a, i));
  std::vector<double> difference(kUnknowns);
  for (std::size_t i = 0; i < kUnknowns; ++i) difference[i] = naive[i] - move[i];
  // steps in all directions determine the solution: both forms agree
  worst.naive_ratio(h < 1 ? norm(naive) / norm(f) : norm(difference) / norm(move));
}

HARD_CASE("anderson: components of weight 0 do not affect the step, for any size of their own steps",
          "step of weight 0", {0, 1, 1e4, 1e8, 1e150}, 0, {"least squares over all components", test::kWrong}) {
  const double rate = random.uniform(0.2, 0.8), fixed = random.uniform(-1, 1);
  double x[2] = {random.uniform(-1, 1), 0}, f[2][2];
  Anderson accelerated(2);
  std::vector<double> to{x[0], 0};
  for (int k = 0; k < 2; ++k) {
    x[k] = to[0];
    f[k][0] = rate * (fixed - x[k]);
    f[k][1] = h * random.uniform(-1, 1);
    to = accelerated.next({x[k], to[1]}, {f[k][0], f[k][1]}, {1, 0});
  }
  worst.ours_is(std::abs(to[0] - fixed) < 1e-9);  // two points of one linear unknown determine it
  double square = 0, along = 0;
  for (int i = 0; i < 2; ++i) {
    square += (f[1][i] - f[0][i]) * (f[1][i] - f[0][i]);
    along += (f[1][i] - f[0][i]) * f[1][i];
  }
  const double naive = x[1] + f[1][0] - along / square * (x[1] - x[0] + f[1][0] - f[0][0]);
  worst.naive_is(std::abs(naive - fixed) < 1e-9);
}

}  // namespace ngs
