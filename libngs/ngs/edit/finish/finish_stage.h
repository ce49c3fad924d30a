#pragma once
// Finishes an object that was cut out: clips its Gaussians to the places that the views support.
//
// A Gaussian that reaches out of the object is faint in the views of the scene, or hidden behind the object, but not if
// the object is rendered alone from other directions.
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
  /// `behind`: as in SupportView::sides(). The views must outlive this object.
  HullSupport(const std::vector<SupportView>& views, double behind) : views_(views), behind_(behind) {}

  /// False if enough views show the point outside of the mask, in front of the visible surface or at it. Also false if
  /// other things hide it in most views and no view sees it within the mask, as inside the floor. True for a point that
  /// no view contains.
  bool supported(Vec3<double> point) const;
  /// The fraction of the views that contain the point which show it within both masks, at the visible surface or in
  /// front of it. 0: none contains it.
  double seen_share(Vec3<double> point) const;
  /// The smallest size of a pixel at a point in any view, world; 0: no view contains it.
  double pixel_size(Vec3<double> point) const;

 private:
  const std::vector<SupportView>& views_;
  double behind_;
};

struct Finished {
  GaussianCloud object;            // the Gaussians of the object, some of them smaller
  std::vector<std::uint8_t> keep;  // [N] the object without the Gaussians that no view supports
  std::int64_t clipped = 0, dropped = 0;
};

struct FinishInput {
  FinishModel model;
  const std::vector<SupportView>& views;  // of the scene, of this object
  SplatOptions splat;                     // of the scene, not prepared for a model
  std::uint64_t seed = 0;                 // of the search for planes
};

/// Clips the object to the views' evidence, to the front of the planes that it stands on or against
/// (fill/fill_surface.h) unless views see the part behind, and hidden Gaussians among seen ones to the visual hull of
/// these (support_view.h). `seed`: of the search for planes. Rows that are not clipped keep their bits. Left unchanged
/// are Gaussians that are not usable, that no view contains, or that are too faint to be rendered; and all of them
/// without views.
Finished finish_object(const Exec& exec, const FinishInput& input);

}  // namespace ngs::finish
