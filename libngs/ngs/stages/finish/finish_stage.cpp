#include "ngs/stages/finish/finish_stage.h"

#include <algorithm>
#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/math/quat.h"
#include "ngs/math/stable.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/stages/orbit/surface_points.h"

namespace ngs::finish {
namespace {

// Shares of the views that show a point outside of the mask, from which on the point is no part of the object. Rendered
// masks agree with one another, given ones have errors of single views.
constexpr double kRenderedShare = 0.25, kGivenShare = 0.35;
constexpr int kMinViews = 2;        // and at least so many, or all views of the scene
constexpr double kBehind = 0.05;    // of the object's radius: tolerance of the depth of visible surfaces
constexpr double kMin_px = 2;       // shorter axes are not tested
constexpr double kMinAlpha = 0.01;  // of a Gaussian; the outline of what is fainter may not be rendered

/// In how many views a point lies on each side.
struct Counts {
  int seen = 0, inside = 0, outside = 0, hidden = 0;
  void add(Side side) {
    seen += side == Side::kSeen, inside += side == Side::kInside;
    outside += side == Side::kOutside, hidden += side == Side::kHidden;
  }
  bool contradict(double share, int least) const {
    return outside >= least && double(outside) >= share * double(seen + inside + outside);
  }
  /// Never seen, and hidden by other things in most views: inside the floor, for example.
  bool is_buried() const { return seen == 0 && hidden > seen + inside + outside; }
};

}  // namespace

bool HullSupport::supported(Vec3<double> point) const {
  Counts rendered, given;
  for (const SupportView& view : views_) {
    const SupportView::Sides sides = view.sides(point, behind_);
    rendered.add(sides.rendered), given.add(sides.given);
  }
  const int least = std::min(kMinViews, int(views_.size()));
  return !rendered.contradict(kRenderedShare, least) && !given.contradict(kGivenShare, least) && !rendered.is_buried();
}

double HullSupport::pixel_size(Vec3<double> point) const {
  double least = 0;
  for (const SupportView& view : views_) {
    const double size = view.pixel_size(point);
    if (size > 0 && (least == 0 || size < least)) least = size;
  }
  return least;
}

namespace {

/// The Gaussian of row i, in double.
Ellipsoid shape_of(const GaussianCloud& cloud, std::size_t i) {
  const float *p = &cloud.position[3 * i], *s = &cloud.log_scale[3 * i];
  return {{double(p[0]), double(p[1]), double(p[2])},
          axes_of_quaternion(&cloud.rotation[4 * i]),
          {std::exp(double(s[0])), std::exp(double(s[1])), std::exp(double(s[2]))}};
}

/// Clips row i of `cloud`. kUnsupported: the row is unchanged and leaves the object.
Clip clip_row(const HullSupport& support, std::size_t i, GaussianCloud& cloud) {
  const double opacity = sigmoid(double(cloud.logit_opacity[i]));
  if (!cloud.usable[i] || !(opacity > kMinAlpha)) return Clip::kWithin;
  const Ellipsoid before = shape_of(cloud, i);
  const double pixel = support.pixel_size(before.centre);
  if (!(pixel > 0)) return Clip::kWithin;
  Ellipsoid shape = before;
  const Clip found = clip_ellipsoid(
      kMin_px * pixel, [&](Vec3<double> at) { return support.supported(at); }, shape);
  if (found != Clip::kClipped) return found;
  const double centre[3] = {shape.centre.x, shape.centre.y, shape.centre.z};
  for (std::size_t a = 0; a < 3; ++a) {
    cloud.position[3 * i + a] = float(centre[a]);
    if (shape.sigma[a] != before.sigma[a]) cloud.log_scale[3 * i + a] = float(std::log(shape.sigma[a]));
  }
  return found;
}

}  // namespace

Finished finish_object(const Exec& exec, const FinishModel& model, const std::vector<SupportView>& views) {
  NGS_CHECK(std::int64_t(model.object.size()) == model.cloud.size(), "one entry per Gaussian");
  Finished out{model.cloud, model.object};
  std::vector<std::int64_t> rows;
  for (std::size_t i = 0; i < model.object.size(); ++i)
    if (model.object[i]) rows.push_back(std::int64_t(i));
  const orbit::SurfacePoints points = orbit::surface_points(gather_rows(exec, model.cloud, rows));
  if (points.count() == 0 || views.empty()) return out;
  const HullSupport support(views, kBehind * orbit::bulk_of(points).radius);
  constexpr std::int64_t kRowsAtOnce = 256;
  const auto n = std::int64_t(rows.size());
  std::vector<Clip> found(rows.size());
  for_each_task(exec, (n + kRowsAtOnce - 1) / kRowsAtOnce, [&](std::int64_t task) {
    const auto end = std::size_t(std::min(n, (task + 1) * kRowsAtOnce));
    for (auto r = std::size_t(task * kRowsAtOnce); r < end; ++r)
      found[r] = clip_row(support, std::size_t(rows[r]), out.cloud);
  });
  for (std::size_t r = 0; r < rows.size(); ++r) {
    out.clipped += found[r] == Clip::kClipped;
    if (found[r] != Clip::kUnsupported) continue;
    out.keep[std::size_t(rows[r])] = 0, ++out.dropped;
  }
  return out;
}

}  // namespace ngs::finish
