#include "ngs/render/background.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "ngs/backend/for_each.h"
#include "ngs/core/error.h"
#include "ngs/core/progress_count.h"
#include "ngs/math/median.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/render/render_options.h"

namespace ngs {
namespace {

using Rgb = std::array<double, 3>;
constexpr double kMinOpen = 1.0 / 255;                     // least T of a pixel that shows the background: one level
constexpr std::size_t kMaxSamples = std::size_t(1) << 16;  // per view; the median is accurate to 1 % of the spread
constexpr double kWarnDifference = 0.1;

Vec3<double> vec(const Rgb& c) { return {c[0], c[1], c[2]}; }

struct Sample {
  double value, weight;
};

/// The smallest value with at least half of the weight at or below it.
double weighted_median(std::vector<Sample>& samples) {
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.value < b.value; });
  double half = 0, below = 0;
  for (const Sample& s : samples) half += s.weight / 2;
  for (const Sample& s : samples)
    if ((below += s.weight) >= half) return s.value;
  return samples.back().value;
}

/// arg min over b of Σ |r - T b|: the median of r / T with weights T. With squares, pixels that no trainer has fitted
/// would dominate: the largest holes at the edges of the captured region.
double least_deviations(const std::vector<std::size_t>& pixels, const RenderedView& view, const ImageF& photo, int c) {
  std::vector<Sample> samples;
  for (const std::size_t p : pixels) {
    const double t = 1 - double(view.alpha.data[p]);
    const std::size_t at = 3 * p + std::size_t(c);
    samples.push_back({(double(photo.data[at]) - double(view.colour.data[at])) / t, t});
  }
  return weighted_median(samples);
}

/// PSNR gain of background b over black, in dB: Σ r² / Σ (r - T b)².
double gain_db(const BackgroundMeasurement& w, const Rgb& b) {
  double black = 0, over = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    black += w.residual2[c];
    over += w.residual2[c] - 2 * b[c] * w.residual[c] + b[c] * b[c] * w.open2;
  }
  constexpr double kMinError = 1e-12;  // avoids division by 0 for an exact match
  return 10 * std::log10(std::max(black, kMinError) / std::max(over, kMinError));
}

}  // namespace

Vec3<float> parse_background(const std::string& text) {
  if (text == "black") return {0, 0, 0};
  if (text == "white") return {1, 1, 1};
  std::istringstream in(text + ",");
  std::vector<float> value;
  bool good = true;
  for (std::string part; good && std::getline(in, part, ',');) {
    char* end = nullptr;
    value.push_back(std::strtof(part.c_str(), &end));
    good = end != part.c_str() && *end == '\0' && value.back() >= 0.f && value.back() <= 1.f;
  }
  if (!good || value.size() != 3)
    throw Error(ErrorCode::kUsage, "--background: '" + text + "', expected three numbers in [0, 1], black or white",
                "for example 0.5,0.5,0.5");
  return {value[0], value[1], value[2]};
}

std::string background_text(Vec3<float> colour) {
  std::ostringstream text;
  text << std::setprecision(9) << colour.x << ',' << colour.y << ',' << colour.z;
  return text.str();
}

void choose_background(const std::string& given, Monitor& monitor, Scene& scene) {
  if (given.empty()) return;
  const Vec3<float> colour = parse_background(given), known = background_of(scene);
  const Vec3<float> off = colour - known;
  const double difference = std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)});
  if (scene.background && difference > kWarnDifference)
    monitor.warn("--background " + given + " is not the scene's, " + background_text(known) +
                 "; leave it out to use the scene's");
  scene.background = Vec3<double>{colour.x, colour.y, colour.z};
}

RenderedView over_background(RenderedView view, Vec3<float> background) {
  const float behind[3] = {background.x, background.y, background.z};
  for (std::size_t p = 0; p < view.alpha.data.size(); ++p)
    for (std::size_t c = 0; c < 3; ++c) view.colour.data[3 * p + c] += (1 - view.alpha.data[p]) * behind[c];
  return view;
}

BackgroundMeasurement measure_background(const RenderedView& view, const ImageF& photo) {
  BackgroundMeasurement w;
  std::vector<std::size_t> pixels;
  for (std::size_t p = 0; p < view.alpha.data.size(); ++p) {
    const double t = 1 - double(view.alpha.data[p]);
    if (t >= kMinOpen) pixels.push_back(p);
    w.open2 += t * t;
    for (std::size_t c = 0; c < 3; ++c) {
      const double r = double(photo.data[3 * p + c]) - double(view.colour.data[3 * p + c]);
      w.residual[c] += t * r;
      w.residual2[c] += r * r;
    }
  }
  w.open = !pixels.empty();
  w.shown = w.open2 / double(view.alpha.data.size());
  if (!w.open) return w;
  const std::size_t stride = (pixels.size() + kMaxSamples - 1) / kMaxSamples;
  std::vector<std::size_t> some;
  for (std::size_t i = 0; i < pixels.size(); i += stride) some.push_back(pixels[i]);
  for (int c = 0; c < 3; ++c) w.colour[std::size_t(c)] = least_deviations(some, view, photo, c);
  return w;
}

BackgroundFinding find_background(std::span<const BackgroundMeasurement> measurements) {
  BackgroundFinding found;
  std::array<std::vector<double>, 3> values;
  for (const BackgroundMeasurement& w : measurements)
    for (std::size_t c = 0; w.open && c < 3; ++c) values[c].push_back(w.colour[c]);
  found.views = int(values[0].size());
  if (found.views == 0) return found;
  Rgb fitted{}, error{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double middle = upper_median(values[c]);
    fitted[c] = std::clamp(std::round(255 * middle) / 255, 0.0, 1.0) + 0.0;  // no -0
    for (double& v : values[c]) v = std::abs(v - middle);
    // For normal values the deviation is 1.4826 MAD and the standard error of the median √(π/2) that of the mean.
    error[c] = 1.4826 * 1.2533 * upper_median(values[c]) / std::sqrt(double(found.views));
  }
  std::vector<double> gains, shown;
  for (const BackgroundMeasurement& w : measurements) {
    gains.push_back(gain_db(w, fitted));
    shown.push_back(w.shown);
  }
  found.fitted = vec(fitted);
  found.error = vec(error);
  found.gain_db = upper_median(gains);
  found.shown = upper_median(shown);
  const bool agreed = *std::max_element(error.begin(), error.end()) <= kMaxBackgroundError;
  if (found.shown >= kMinShown && agreed && found.gain_db >= kBackgroundMarginDb) found.colour = found.fitted;
  return found;
}

BackgroundFinding find_background(const Exec& exec, Monitor& monitor, const PhotographedModel& model,
                                  const std::vector<std::size_t>& views) {
  const SplatOptions splat = prepared_for(exec, splat_options({}, model.cloud, model.scene), model.cloud);
  std::vector<BackgroundMeasurement> measurements(views.size());
  ProgressCount progress(monitor, std::int64_t(views.size()));
  for_each_task(exec, std::int64_t(views.size()), [&](std::int64_t i) {
    const std::size_t v = views[std::size_t(i)];
    measurements[std::size_t(i)] =
        measure_background(render({}, model.cloud, model.scene.views[v].camera, splat, {}), model.load_photo(v));
    progress.add_one();
  });
  return find_background(measurements);
}

double psnr_over_background(const Exec& exec, const GaussianCloud& cloud, const Scene& scene,
                            const std::vector<std::size_t>& views,
                            const std::function<ImageF(std::size_t view)>& load_photo) {
  RenderRequest request;
  request.background = background_of(scene);
  const SplatOptions splat = prepared_for(exec, splat_options({}, cloud, scene), cloud);
  double sum = 0;
  for (const std::size_t v : views)
    sum += psnr_db(exec, render(exec, cloud, scene.views[v].camera, splat, request).colour, load_photo(v));
  return views.empty() ? 0 : sum / double(views.size());
}

}  // namespace ngs
