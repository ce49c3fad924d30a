#include "ngs/edit/finish/finish_stage.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/edit/fill/fill_surface.h"
#include "ngs/edit/finish/alone.h"
#include "ngs/edit/finish/clip_ellipsoid.h"
#include "ngs/edit/finish/seen_hull.h"
#include "ngs/math/quat.h"
#include "ngs/math/row_numbers.h"
#include "ngs/math/stable.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/scene/geometry/surface_points.h"

namespace ngs::finish {
namespace {

// A point is unsupported if at least this share of the views sees it outside the mask. Rendered masks agree with one
// another, so their share is lower than that of given masks, which have errors in single views.
constexpr double kRenderedShare = 0.25, kGivenShare = 0.35;
constexpr double kSeenShare = 0.25;  // share of views that see a point behind a plane, if it belongs to the object
constexpr int kMinViews = 2;         // least number of views that see a point outside, or all views of the scene
constexpr double kBehind = 0.05;     // of the object's radius: tolerance of the depth of visible surfaces
// Outlines of seen Gaussians that are tried at planes, standard deviations: many faint tails add up to an opaque end.
constexpr double kPlaneOutlines_sigma[] = {1.8, 2.5};
// Moves of planes, and of a tilted plane at the object's radius: the first step, the last, and the farthest move; the
// least relative gain of a step. A tilt must also save a pixel in each view: of a few pixels, 5 % are chance.
constexpr double kMove_px = 4, kLeastMove_px = 1, kMaxMove_px = 16, kMoveGain = 0.03, kTiltGain = 0.05;
constexpr double kMin_px = 2;       // shorter axes are not tested
constexpr double kMinAlpha = 0.01;  // minimum opacity of a clipped Gaussian: fainter outlines may not be rendered

/// In how many views a point has each status.
struct Counts {
  int visible_in_mask = 0, occluded_in_mask = 0, visible_outside = 0, occluded_outside = 0;
  void add(PointStatus status) {
    visible_in_mask += status == PointStatus::kVisibleInMask;
    occluded_in_mask += status == PointStatus::kOccludedInMask;
    visible_outside += status == PointStatus::kVisibleOutside;
    occluded_outside += status == PointStatus::kOccludedOutside;
  }
  bool contradict(double share, int least) const {
    return visible_outside >= least &&
           double(visible_outside) >= share * double(visible_in_mask + occluded_in_mask + visible_outside);
  }
  /// Never seen, and hidden by other things in most views: inside the floor, for example.
  bool is_buried() const {
    return visible_in_mask == 0 && occluded_outside > visible_in_mask + occluded_in_mask + visible_outside;
  }
};

}  // namespace

bool HullSupport::supported(Vec3<double> point) const {
  Counts rendered, given;
  for (const SupportView& view : views_) {
    const SupportView::Statuses statuses = view.statuses(point, behind_);
    rendered.add(statuses.rendered);
    given.add(statuses.given);
  }
  const int least = std::min(kMinViews, int(views_.size()));
  return !rendered.contradict(kRenderedShare, least) && !given.contradict(kGivenShare, least) && !rendered.is_buried();
}

double HullSupport::seen_share(Vec3<double> point) const {
  int seen = 0, all = 0;
  for (const SupportView& view : views_) {
    const SupportView::Statuses statuses = view.statuses(point, behind_);
    all += statuses.rendered != PointStatus::kUnknown;
    seen += statuses.rendered == PointStatus::kVisibleInMask &&
            (statuses.given == PointStatus::kVisibleInMask || statuses.given == PointStatus::kUnknown);
  }
  return all > 0 ? double(seen) / double(all) : 0;
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

struct Evidence {
  HullSupport support;
  std::vector<FillSurface> planes;
  SeenHull hull;
  double outline = kOutline;  // at the planes, of Gaussians whose centre a view sees
};

/// Clips a Gaussian to the front of the planes, where no views see the part behind.
Clip clip_to_fronts(const Evidence& known, std::size_t of_object, Ellipsoid& shape) {
  const double outline = known.hull.is_hidden(of_object) ? kHiddenOutline : known.outline;
  Clip found = Clip::kWithin;
  for (const FillSurface& plane : known.planes) {
    const HalfSpace front{plane.normal, dot(plane.normal, plane.origin), outline};
    Ellipsoid clipped = shape;
    const Clip now = clip_half_space(front, clipped);
    if (now == Clip::kWithin || known.support.seen_share(lowest_point(front, shape)) >= kSeenShare) continue;
    if (now == Clip::kUnsupported) return now;
    shape = clipped;
    found = now;
  }
  return found;
}

/// `at_front`: of clip_to_fronts().
Clip clip_shape(const Evidence& known, Clip at_front, double pixel, std::size_t of_object, Ellipsoid& shape) {
  if (at_front == Clip::kUnsupported) return at_front;
  const auto by_views = [&](Vec3<double> at) { return known.support.supported(at); };
  const Clip in_views = clip_ellipsoid(kMin_px * pixel, by_views, shape);
  if (in_views == Clip::kUnsupported) return in_views;
  const auto by_hull = [&](Vec3<double> at) { return known.hull.contains(at); };
  const Clip in_hull =
      known.hull.is_surplus(of_object) ? clip_ellipsoid(pixel, by_hull, shape, kHiddenOutline) : Clip::kWithin;
  if (in_hull == Clip::kUnsupported) return in_hull;
  const bool same = at_front == Clip::kWithin && in_views == Clip::kWithin && in_hull == Clip::kWithin;
  return same ? Clip::kWithin : Clip::kClipped;
}

struct Clipped {
  explicit Clipped(const GaussianCloud& given)
      : object(given), found(std::size_t(given.size()), Clip::kWithin), untouched_by_planes(found.size()) {}
  GaussianCloud object;
  std::vector<Clip> found;                        // [object] kUnsupported: the row is unchanged and leaves the object
  std::vector<std::uint8_t> untouched_by_planes;  // [object] 1: no plane clips it
};

std::vector<std::uint8_t> kept(const Clipped& clipped) {
  std::vector<std::uint8_t> keep(clipped.found.size());
  std::ranges::transform(clipped.found, keep.begin(), [](Clip found) { return found != Clip::kUnsupported; });
  return keep;
}

/// Sets row i to the row of `object`, with this shape.
void set_row(const GaussianCloud& object, const Ellipsoid& before, const Ellipsoid& shape, std::size_t i,
             GaussianCloud& cloud) {
  const double centre[3] = {shape.centre.x, shape.centre.y, shape.centre.z};
  for (std::size_t a = 0; a < 3; ++a) {
    const bool same = shape.sigma[a] == before.sigma[a];
    cloud.position[3 * i + a] = float(centre[a]);
    cloud.log_scale[3 * i + a] = same ? object.log_scale[3 * i + a] : float(std::log(shape.sigma[a]));
  }
  std::copy_n(&object.rotation[4 * i], 4, &cloud.rotation[4 * i]);
  if (!std::ranges::equal(shape.axes.m, before.axes.m))
    std::ranges::copy(stored_quaternion(shape.axes), &cloud.rotation[4 * i]);
}

/// Clips row i. A row that no plane clipped earlier and no plane clips now keeps its earlier result.
void clip_row(const Evidence& known, const GaussianCloud& object, std::size_t i, Clipped& out) {
  const double opacity = sigmoid(double(object.logit_opacity[i]));
  if (!object.usable[i] || !(opacity > kMinAlpha)) return;
  const Ellipsoid before = shape_of(object, i);
  const double pixel = known.support.pixel_size(before.centre);
  if (!(pixel > 0)) return;
  Ellipsoid shape = before;
  const Clip at_front = clip_to_fronts(known, i, shape);
  const bool is_untouched = at_front == Clip::kWithin;
  if (is_untouched && out.untouched_by_planes[i]) return;
  out.untouched_by_planes[i] = is_untouched;
  out.found[i] = clip_shape(known, at_front, pixel, i, shape);
  set_row(object, before, out.found[i] == Clip::kClipped ? shape : before, i, out.object);
}

/// [object] 1: a view sees the Gaussian's centre.
std::vector<std::uint8_t> seen_rows(const Exec& exec, const HullSupport& support, const GaussianCloud& object) {
  std::vector<std::uint8_t> seen(std::size_t(object.size()));
  for_each_index(exec, object.size(), [&](std::int64_t row) {
    const auto i = std::size_t(row);
    const float* p = &object.position[3 * i];
    seen[i] = object.usable[i] && support.seen_share({double(p[0]), double(p[1]), double(p[2])}) > 0;
  });
  return seen;
}

/// `earlier`: result with other planes, or Clipped(object).
Clipped clipped_rows(const Exec& exec, const Evidence& known, const GaussianCloud& object, Clipped earlier) {
  constexpr std::int64_t kRowsAtOnce = 256;
  const std::int64_t n = object.size();
  for_each_task(exec, (n + kRowsAtOnce - 1) / kRowsAtOnce, [&](std::int64_t task) {
    const auto end = std::size_t(std::min(n, (task + 1) * kRowsAtOnce));
    for (auto r = std::size_t(task * kRowsAtOnce); r < end; ++r) clip_row(known, object, r, earlier);
  });
  return earlier;
}

/// Clips an object at the planes that it stands on or against. Which planes count, and where they are, is decided by
/// the object alone: it has few wrong pixels.
class PlaneFit {
 public:
  PlaneFit(const Exec& exec, const AloneViews& in, Evidence& known, const GaussianCloud& object)
      : exec_(exec),
        in_(in),
        known_(known),
        object_(object),
        first_(clipped_rows(exec, known, object, Clipped(object))),
        best_(first_),
        alone_(alone_of(first_)) {}

  void fit(const orbit::Ball& ball) {
    choose_outline();
    drop_planes();
    shows_plane_.clear();
    for (const SupportView& view : in_.views) shows_plane_.push_back(view.shows_plane(known_.planes, kMove_px));
    const double pixel = known_.support.pixel_size(ball.centre);
    for (FillSurface& plane : known_.planes) {
      move_plane(plane, pixel);
      tilt_plane(plane, ball, pixel);
    }
  }
  Clipped& best() { return best_; }
  Alone& alone() { return alone_; }

 private:
  Clipped clipped() const { return clipped_rows(exec_, known_, object_, first_); }
  Alone alone_of(const Clipped& clipped) const { return rendered_alone(exec_, in_, clipped.object, kept(clipped)); }
  void accept(Clipped other, Alone now) {
    best_ = std::move(other);
    alone_ = std::move(now);
  }

  void choose_outline() {
    for (const double sigma : kPlaneOutlines_sigma) {
      if (known_.planes.empty()) return;
      const double before = std::exchange(known_.outline, sigma);
      Clipped other = clipped();
      Alone now = alone_of(other);
      if (now.wrong.count() < alone_.wrong.count())
        accept(std::move(other), std::move(now));
      else
        known_.outline = before;
    }
  }

  /// Drops planes that cut off a part of the object.
  void drop_planes() {
    for (std::size_t p = 0; p < known_.planes.size();) {
      const FillSurface plane = known_.planes[p];
      known_.planes.erase(known_.planes.begin() + std::ptrdiff_t(p));
      Clipped other = clipped();
      Alone now = alone_of(other);
      if (plane_cuts_off(alone_.wrong, now.wrong)) {
        accept(std::move(other), std::move(now));
        continue;
      }
      known_.planes.insert(known_.planes.begin() + std::ptrdiff_t(p), plane);
      ++p;
    }
  }

  /// Takes the planes as they are now, if the object alone then costs at least that much less.
  bool accept_planes(double gain, double least_px) {
    Clipped other = clipped();
    if (other.object.log_scale == best_.object.log_scale && other.found == best_.found) return false;
    Alone now = alone_of(other);
    const double before = cost_at_planes(alone_), saved = before - cost_at_planes(now);
    if (saved <= gain * before || saved < least_px) return false;
    accept(std::move(other), std::move(now));
    return true;
  }

  /// Moves a plane towards the object. It was found from centres of Gaussians, which are deeper than the surface that
  /// the views show.
  void move_plane(FillSurface& plane, double pixel) {
    const Vec3<double> start = plane.origin, towards = pixel * plane.normal;
    double at_px = 0;
    const auto is_better = [&](double to_px) {
      if (to_px < kLeastMove_px || to_px > kMaxMove_px) return false;
      plane.origin = start + to_px * towards;
      if (!accept_planes(kMoveGain, 1)) return false;
      at_px = to_px;
      return true;
    };
    while (is_better(at_px + kMove_px)) {
    }
    for (double step = kMove_px / 2; step >= kLeastMove_px; step /= 2)
      if (!is_better(at_px + step)) is_better(at_px - step);
    plane.origin = start + at_px * towards;
  }

  /// Tilts a plane about its point below the object's middle, to where wrong pixels pull it.
  void tilt_plane(FillSurface& plane, const orbit::Ball& ball, double pixel) {
    plane.origin = ball.centre - plane.height(ball.centre) * plane.normal;
    double left_px = kMaxMove_px;
    for (double step_px = kMove_px; step_px >= kLeastMove_px && left_px > 0;) {
      Vec2<double> uphill{0, 0};
      for (std::size_t v = 0; v < in_.views.size(); ++v) {
        if (alone_.seen[v].empty()) continue;
        const Vec2<double> more = in_.views[v].uphill(alone_.seen[v], shows_plane_[v], plane, ball.radius);
        uphill = {uphill.x + more.x, uphill.y + more.y};
      }
      const double size = std::hypot(uphill.x, uphill.y);
      if (!(size > 0)) return;
      const double slope = step_px * pixel / (ball.radius * size);
      const FillSurface before = plane;
      plane.set_axes(unit(plane.normal - slope * uphill.x * plane.u - slope * uphill.y * plane.v));
      if (accept_planes(kTiltGain, double(in_.views.size()))) {
        left_px -= step_px;
        continue;
      }
      plane = before;
      step_px /= 2;
    }
  }

  /// As WrongPixels::cost(), with those pixels beyond the masks only where the scene shows a plane.
  double cost_at_planes(const Alone& alone) const {
    WrongPixels wrong{0, alone.wrong.missing};
    for (std::size_t v = 0; v < in_.views.size(); ++v)
      if (!alone.seen[v].empty()) wrong.beyond += in_.views[v].beyond_at_planes(alone.seen[v], shows_plane_[v]);
    return double(wrong.cost());
  }

  const Exec& exec_;
  const AloneViews& in_;
  Evidence& known_;
  const GaussianCloud& object_;
  Clipped first_, best_;
  Alone alone_;
  std::vector<std::vector<std::uint8_t>> shows_plane_;  // [views] SupportView::shows_plane()
};

}  // namespace

Finished finish_object(const Exec& exec, const FinishInput& input) {
  const FinishModel& model = input.model;
  const std::vector<SupportView>& views = input.views;
  NGS_CHECK(std::int64_t(model.object.size()) == model.cloud.size(), "one entry per Gaussian");
  const std::vector<std::int64_t> rows = RowNumbers(model.object).row;
  const GaussianCloud object = gather_rows(exec, model.cloud, rows);
  Finished out{object, model.object};
  const orbit::SurfacePoints points = orbit::surface_points(object);
  if (points.count() == 0 || views.empty()) return out;
  const orbit::Ball ball = orbit::bulk_of(points);
  const AloneViews in{views, input.splat, kBehind * ball.radius};
  const HullSupport support(views, kBehind * ball.radius);
  const std::vector<std::uint8_t> seen = seen_rows(exec, support, object);
  Evidence known{support, supporting_planes(exec, model.cloud, model.object, input.seed),
                 SeenHull(exec, object, seen, ball)};
  PlaneFit fitted(exec, in, known, object);
  fitted.fit(ball);
  Clipped& best = fitted.best();
  Alone& alone = fitted.alone();
  drop_contradicted(exec, in, {best.object, seen}, alone);
  out.object = std::move(best.object);
  out.clipped = std::ranges::count(best.found, Clip::kClipped);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (alone.keep[r]) continue;
    out.keep[std::size_t(rows[r])] = 0;
    ++out.dropped;
  }
  return out;
}

}  // namespace ngs::finish
