#pragma once
// Clips the Gaussians of an extracted object to the region that the views support.
//
// A Gaussian that sticks out of the object is faint or occluded in the views of the scene. It becomes visible when the
// object is rendered alone from other directions.
#include <vector>

#include "ngs/edit/finish/clip_ellipsoid.h"
#include "ngs/edit/finish/support_view.h"
#include "ngs/options/field.h"

namespace ngs::finish {

struct FinishOptions {
  bool finish = true;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.finish, Flag{"finish", "With --scene: clip the object to its masks in all views"});
  }
};

/// Whether views support a point as part of the object.
class HullSupport {
 public:
  /// `behind`: as in SupportView::statuses(). The views must outlive this object.
  HullSupport(const std::vector<SupportView>& views, double behind) : views_(views), behind_(behind) {}

  /// False if enough views see the point outside the mask, at or in front of the visible surface. Also false if other
  /// things occlude the point in most views and no view sees it within the mask, as inside the floor. True if no view
  /// contains the point.
  bool supported(Vec3<double> point) const;
  /// Of the views that contain the point, the share that see it within both masks, at or in front of the visible
  /// surface. 0 if no view contains it.
  double seen_share(Vec3<double> point) const;
  /// The smallest size of a pixel at a point in any view, world; 0: no view contains it.
  double pixel_size(Vec3<double> point) const;

 private:
  const std::vector<SupportView>& views_;
  double behind_;
};

struct Finished {
  GaussianCloud object;            // the Gaussians of the object, some of them smaller
  std::vector<std::uint8_t> keep;  // [N] 1: in the object, and supported by the views
  std::int64_t clipped = 0, dropped = 0;
};

struct FinishInput {
  FinishModel model;
  const std::vector<SupportView>& views;  // of the scene, of this object
  SplatOptions splat;                     // of the scene, not prepared for a model
  std::uint64_t seed = 0;                 // of the search for planes
};

/// Clips the object's Gaussians in three ways: to the region that the views support; to the front of the planes that
/// the object stands on or against (fill/fill_surface.h), unless views see the part behind; and hidden Gaussians among
/// seen ones to the visual hull of the seen ones (seen_hull.h). Gaussians that are unusable, too faint to be rendered
/// or in no view stay unchanged, as do all Gaussians if there are no views. Rows that are not clipped keep their bits.
Finished finish_object(const Exec& exec, const FinishInput& input);

}  // namespace ngs::finish
