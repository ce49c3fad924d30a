#include "ngs/eval/error_atlas.h"

#include <cmath>

#include "ngs/core/check.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

constexpr float kRarelySeenViews = 2;
constexpr double kOccluderDistance = 0.1;  // fraction of the object's radius
enum Channel : std::size_t { kObject, kRarelySeen, kBoundary, kChannels };

/// RMS distance of the object's Gaussians from their mean, world.
double object_radius(const GaussianCloud& cloud, const std::vector<std::uint8_t>& object) {
  double count = 0, sum[3] = {}, squares = 0;
  for (std::size_t i = 0; i < object.size(); ++i) {
    if (!object[i] || !cloud.usable[i]) continue;
    count += 1;
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = double(cloud.position[3 * i + a]);
      sum[a] += x, squares += x * x;
    }
  }
  if (count == 0) return 0;
  const double mean2 = (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / (count * count);
  return std::sqrt(std::max(0.0, squares / count - mean2));
}

struct Renders {
  RenderedView whole;            // label: kObject, kRarelySeen, kBoundary
  RenderedView object;           // the object alone, with depth
  RenderedView others;           // all but the object, with depth
  double occluder_distance = 0;  // world: least distance of an occluder in front of the object
};

Renders rendered(const Exec& exec, const AtlasInput& in) {
  const auto n = std::size_t(in.cloud.size());
  std::vector<float> value(n * kChannels);
  std::vector<std::uint8_t> object(n), other(n);
  for (std::size_t i = 0; i < n; ++i) {
    value[i * kChannels + kObject] = in.labels.label[i];
    value[i * kChannels + kRarelySeen] = in.labels.views[i] <= kRarelySeenViews;
    value[i * kChannels + kBoundary] = in.labels.boundary[i];
    object[i] = label_is_foreground(in.labels.label[i]), other[i] = !object[i];
  }
  RenderRequest request{.colour = false, .label = {value.data(), in.cloud.size(), int(kChannels)}};
  Renders r;
  r.whole = render(exec, in.cloud, in.camera, in.splat, request);
  request.label = {}, request.depth = true, request.include = object.data();
  r.object = render(exec, in.cloud, in.camera, in.splat, request);
  request.include = other.data();
  r.others = render(exec, in.cloud, in.camera, in.splat, request);
  r.occluder_distance = kOccluderDistance * object_radius(in.cloud, object);
  return r;
}

bool is_occluded(const Renders& r, std::size_t p) {
  const double behind = double(r.object.alpha.data[p]), before = double(r.others.alpha.data[p]);
  if (!(behind > 0.5) || !(before > 0)) return false;
  return double(r.others.depth.data[p]) / before < double(r.object.depth.data[p]) / behind - r.occluder_distance;
}

ErrorCause cause_at(const AtlasInput& in, const Renders& r, std::size_t p) {
  const bool truth = in.truth.data[p] != 0;
  const double alpha = double(r.whole.alpha.data[p]);
  const float* value = &r.whole.label.data[p * kChannels];
  if (alpha < 0.5) return ErrorCause::kReach;
  if (double(value[kRarelySeen]) > 0.5 * alpha) return ErrorCause::kUnseen;
  if (truth && is_occluded(r, p)) return ErrorCause::kFloater;
  if (in.input.data != nullptr && (in.input.data[p] != 0) != truth) return ErrorCause::kInputMask;
  if (double(value[kBoundary]) > 0.5 * alpha) return ErrorCause::kStraddler;
  if (value[kObject] > 0.25f && value[kObject] < 0.75f) return ErrorCause::kSoftEdge;
  return ErrorCause::kLabel;
}

}  // namespace

std::int64_t ErrorAtlas::wrong() const {
  std::int64_t sum = 0;
  for (std::size_t c = 1; c < kErrorCauses; ++c) sum += pixels[c];
  return sum;
}

ErrorAtlas error_atlas(const Exec& exec, const AtlasInput& in) {
  NGS_CHECK(in.camera.width_px == in.truth.width_px && in.camera.height_px == in.truth.height_px &&
                in.predicted.pixels() == in.truth.pixels(),
            "camera, prediction and truth have one size");
  const Renders r = rendered(exec, in);
  ErrorAtlas atlas;
  atlas.cause.assign(std::size_t(in.truth.pixels()), ErrorCause::kNone);
  for (std::size_t p = 0; p < atlas.cause.size(); ++p) {
    if ((in.predicted.data[p] != 0) != (in.truth.data[p] != 0)) atlas.cause[p] = cause_at(in, r, p);
    ++atlas.pixels[std::size_t(atlas.cause[p])];
  }
  return atlas;
}

}  // namespace ngs
