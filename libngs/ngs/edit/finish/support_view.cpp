#include "ngs/edit/finish/support_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/core/check.h"
#include "ngs/edit/extract/inpaint_stage.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs::finish {
namespace {

constexpr float kOpaque = 0.5f;                             // least alpha of a pixel that shows a surface
constexpr double kStoredReach = 3;                          // standard deviations of a Gaussian that are stored
constexpr int kRenderedMargin_px = 1, kGivenMargin_px = 2;  // by which masks are dilated
constexpr float kHaze = 0.1f;                               // least alpha of contradicting pixels farther than kRim_px
constexpr int kRim_px = 3;                                  // soft edge of a rendered mask
// Bits of a pixel: in the dilated rendered mask; in the dilated given mask; given mask unknown; in an exact mask; near
// an exact mask; in all exact masks.
constexpr std::uint8_t kRendered = 1, kGiven = 2, kNoEvidence = 4, kExact = 8, kNearExact = 16, kInAll = 32;
// Bits of a pixel of the object alone.
constexpr std::uint8_t kHazyBit = 1, kSolidBit = 2, kBehindBit = 4;

}  // namespace

ObjectLabels::ObjectLabels(const GaussianCloud& cloud, const std::vector<std::vector<std::uint8_t>>& objects)
    : cloud_(cloud), count_(int(objects.size())), any_(std::size_t(cloud.size())) {
  labels_.resize(any_.size() * objects.size());
  for (std::size_t k = 0; k < objects.size(); ++k) {
    NGS_CHECK(objects[k].size() == any_.size(), "one entry per Gaussian");
    for (std::size_t i = 0; i < any_.size(); ++i) {
      labels_[i * objects.size() + k] = objects[k][i];
      any_[i] |= objects[k][i];
    }
  }
}

RenderedView ObjectLabels::render(const Exec& exec, const SplatOptions& splat, const Camera& camera) const {
  RenderRequest request;
  request.colour = false;
  request.depth = true;
  request.label = {labels_.data(), cloud_.size(), count_};
  request.tiles_touching = any_.data();  // pixels of other tiles are never read
  return ngs::render(exec, cloud_, camera, splat, request);
}

SupportView::SupportView(const FinishModel& model, const Camera& camera, const RenderedObject& in_view,
                         const std::vector<GivenMask>& given_mask)
    : scene_camera_(camera), camera_(relative_to(camera, model.cloud.origin)) {
  NGS_CHECK(std::int64_t(model.object.size()) == model.cloud.size(), "one entry per Gaussian");
  crop(model);
  if (width_ == 0) return;
  const RenderedView& view = in_view.view;
  const int width_px = camera.width_px, height_px = camera.height_px;
  PixelMask rendered(view.alpha.data.size());
  const std::size_t channels = view.label.data.size() / rendered.size();
  for (std::size_t p = 0; p < rendered.size(); ++p)
    rendered[p] = label_is_foreground(view.label.data[p * channels + std::size_t(in_view.channel)]);
  PixelMask exact = rendered, in_all = rendered;
  for (std::size_t p = 0; p < given_mask.size(); ++p) {
    exact[p] = rendered[p] || given_mask[p] == GivenMask::kObject;
    in_all[p] = rendered[p] && given_mask[p] != GivenMask::kBackground;
  }
  const PixelMask near_exact = dilated(exact, width_px, height_px, kRim_px);
  rendered = dilated(rendered, width_px, height_px, kRenderedMargin_px);
  PixelMask given(rendered.size());
  NGS_CHECK(given_mask.empty() || given_mask.size() == given.size(), "a mask has the size of its camera");
  if (!given_mask.empty()) {
    for (std::size_t p = 0; p < given.size(); ++p) given[p] = given_mask[p] == GivenMask::kObject;
    given = dilated(given, width_px, height_px, kGivenMargin_px);
  }
  depth_.resize(std::size_t(width_) * std::size_t(height_));
  mask_.resize(depth_.size());
  for (int y = y_; y < y_ + height_; ++y)
    for (int x = x_; x < x_ + width_; ++x) {
      const std::size_t p = view.alpha.index(x, y), q = index(x, y);
      const float alpha = view.alpha.data[p];
      depth_[q] = alpha >= kOpaque ? view.depth.data[p] / alpha : std::numeric_limits<float>::infinity();
      const bool known = !given_mask.empty() && given_mask[p] != GivenMask::kUnknown;
      mask_[q] = std::uint8_t((rendered[p] ? kRendered : 0) | (given[p] ? kGiven : 0) | (known ? 0 : kNoEvidence) |
                              (exact[p] ? kExact : 0) | (near_exact[p] ? kNearExact : 0) | (in_all[p] ? kInAll : 0));
    }
}

void SupportView::crop(const FinishModel& model) {
  const Camera& c = camera_;
  double left = c.width_px, right = 0, top = c.height_px, bottom = 0;
  for (std::size_t i = 0; i < model.object.size(); ++i) {
    if (!model.object[i] || !model.cloud.usable[i]) continue;
    const float* p = &model.cloud.position[3 * i];
    const Vec3<double> at = c.rotation * Vec3<double>{double(p[0]), double(p[1]), double(p[2])} + c.translation;
    const double reach = kStoredReach * largest_scale(model.cloud, std::int64_t(i));
    if (at.z + reach <= 0) continue;
    if (at.z <= 2 * reach) {  // its outline is not bounded by the corners below
      left = top = 0;
      right = c.width_px;
      bottom = c.height_px;
      break;
    }
    for (const double z : {at.z - reach, at.z + reach}) {
      left = std::min(left, c.fx * (at.x - reach) / z + c.cx);
      right = std::max(right, c.fx * (at.x + reach) / z + c.cx);
      top = std::min(top, c.fy * (at.y - reach) / z + c.cy);
      bottom = std::max(bottom, c.fy * (at.y + reach) / z + c.cy);
    }
  }
  x_ = int(std::clamp(std::floor(left), 0.0, double(c.width_px)));
  y_ = int(std::clamp(std::floor(top), 0.0, double(c.height_px)));
  width_ = int(std::clamp(std::ceil(right), 0.0, double(c.width_px))) - x_;
  height_ = int(std::clamp(std::ceil(bottom), 0.0, double(c.height_px))) - y_;
  if (width_ <= 0 || height_ <= 0) width_ = height_ = 0;
}

bool SupportView::project(Vec3<double> point, Pixel& at) const {
  const Vec3<double> p = camera_.rotation * point + camera_.translation;
  if (!(p.z > 0)) return false;
  const double x = camera_.fx * p.x / p.z + camera_.cx, y = camera_.fy * p.y / p.z + camera_.cy;
  if (!(x >= x_ && y >= y_ && x < x_ + width_ && y < y_ + height_)) return false;
  at = {int(x), int(y), p.z};
  return true;
}

Vec3<double> SupportView::surface_point(int x, int y) const {
  const double z = depth_[index(x, y)];
  const Vec3<double> ray{(x + 0.5 - camera_.cx) / camera_.fx, (y + 0.5 - camera_.cy) / camera_.fy, 1};
  return transpose(camera_.rotation) * (z * ray - camera_.translation);
}

SupportView::Statuses SupportView::statuses(Vec3<double> point, double behind) const {
  Pixel at;
  if (!project(point, at)) return {};
  const std::size_t q = index(at.x, at.y);
  const bool visible = at.z <= double(depth_[q]) + behind;
  const PointStatus within = visible ? PointStatus::kVisibleInMask : PointStatus::kOccludedInMask,
                    beyond = visible ? PointStatus::kVisibleOutside : PointStatus::kOccludedOutside;
  const std::uint8_t mask = mask_[q];
  Statuses found{mask & kRendered ? within : beyond, mask & kGiven ? within : beyond};
  if (mask & kNoEvidence) found.given = PointStatus::kUnknown;
  return found;
}

Camera SupportView::window() const {
  Camera window = scene_camera_;
  window.width_px = width_;
  window.height_px = height_;
  window.cx -= x_;
  window.cy -= y_;
  return window;
}

std::vector<std::uint8_t> SupportView::seen_alone(const RenderedView& alone, double behind) const {
  NGS_CHECK(alone.alpha.data.size() == mask_.size(), "rendered in the window");
  std::vector<std::uint8_t> seen(mask_.size());
  for (std::size_t q = 0; q < seen.size(); ++q) {
    const float alpha = alone.alpha.data[q];
    const bool is_behind = alone.depth.data[q] > alpha * (depth_[q] + float(behind));
    seen[q] = std::uint8_t((alpha >= kHaze ? kHazyBit : 0) | (alpha >= kOpaque ? kSolidBit : 0) |
                           (is_behind ? kBehindBit : 0));
  }
  return seen;
}

ViewMasks SupportView::masks_alone(const std::vector<std::uint8_t>& seen) const {
  const std::size_t pixels = mask_.size();
  ViewMasks masks{width_, height_, std::vector(2, std::vector<float>(pixels)), {}, true};
  masks.known.resize(pixels);
  for (std::size_t q = 0; q < pixels; ++q) {
    const bool within = mask_[q] & kExact;
    masks.known[q] = within || (seen[q] & (mask_[q] & kNearExact ? kSolidBit : kHazyBit)) != 0;
    masks.target[0][q] = within;
    masks.target[1][q] = !within && (seen[q] & kBehindBit) != 0;
  }
  return masks;
}

WrongPixels SupportView::wrong_pixels(const std::vector<std::uint8_t>& seen) const {
  WrongPixels wrong;
  for (std::size_t q = 0; q < mask_.size(); ++q) {
    const bool is_solid = seen[q] & kSolidBit;
    wrong.beyond += is_solid && !(mask_[q] & kExact);
    wrong.missing += !is_solid && (mask_[q] & kInAll);
  }
  return wrong;
}

std::vector<std::uint8_t> SupportView::shows_plane(const std::vector<FillSurface>& planes, double above_px) const {
  std::vector<std::uint8_t> shows(mask_.size());
  for (int y = y_; y < y_ + height_; ++y)
    for (int x = x_; x < x_ + width_; ++x) {
      const double z = depth_[index(x, y)];
      if (!std::isfinite(z)) continue;
      const Vec3<double> point = surface_point(x, y);
      const double above = above_px * z / std::max(camera_.fx, camera_.fy);
      shows[index(x, y)] = std::ranges::any_of(
          planes, [&](const FillSurface& plane) { return plane.height(point) < plane.tolerance + above; });
    }
  return shows;
}

std::int64_t SupportView::beyond_at_planes(const std::vector<std::uint8_t>& seen,
                                           const std::vector<std::uint8_t>& shows_plane) const {
  std::int64_t beyond = 0;
  for (std::size_t q = 0; q < mask_.size(); ++q)
    beyond += (seen[q] & kSolidBit) && !(mask_[q] & kExact) && shows_plane[q];
  return beyond;
}

Vec2<double> SupportView::uphill(const std::vector<std::uint8_t>& seen, const std::vector<std::uint8_t>& shows_plane,
                                 const FillSurface& plane, double reach) const {
  Vec2<double> sum{0, 0};
  for (int y = y_; y < y_ + height_; ++y)
    for (int x = x_; x < x_ + width_; ++x) {
      const std::size_t q = index(x, y);
      if (!shows_plane[q]) continue;
      const bool is_solid = seen[q] & kSolidBit;
      const int rise = is_solid ? !(mask_[q] & kExact) : (mask_[q] & kInAll) ? -WrongPixels::kMissingCost : 0;
      if (rise == 0) continue;
      const Vec2<double> at = plane.coordinates(surface_point(x, y));
      if (at.x * at.x + at.y * at.y <= reach * reach) sum = {sum.x + rise * at.x, sum.y + rise * at.y};
    }
  return sum;
}

double SupportView::pixel_size(Vec3<double> point) const {
  Pixel at;
  return project(point, at) ? at.z / std::max(camera_.fx, camera_.fy) : 0;
}

}  // namespace ngs::finish
