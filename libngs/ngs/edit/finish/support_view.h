#pragma once
// The evidence of one view about an object: its masks and the depth of the visible surface.
#include <vector>

#include "ngs/edit/fill/fill_surface.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/scene/scene.h"

namespace ngs::finish {

/// An object in its model, rendered in views.
struct FinishModel {
  const GaussianCloud& cloud;
  const std::vector<std::uint8_t>& object;  // [N] 1: of the object
};

/// A pixel of an input mask.
enum class GivenMask : std::uint8_t { kBackground, kObject, kUnknown };

/// Where a point lies in a view.
enum class PointStatus : std::uint8_t {
  kUnknown,         // not in the image, or the view has no mask there
  kVisibleInMask,   // within the mask, in front of the visible surface or at it
  kOccludedInMask,  // within the mask, behind the visible surface
  kVisibleOutside,  // outside the mask, in front of the visible surface or at it
  kOccludedOutside  // outside the mask, hidden by other things
};

/// The labels of several objects of one model, to render all of them at once.
class ObjectLabels {
 public:
  /// `objects` [K][N] 1: of the object. `cloud` must outlive this object.
  ObjectLabels(const GaussianCloud& cloud, const std::vector<std::vector<std::uint8_t>>& objects);

  /// Labels [H, W, K], alpha and depth in the tiles that the objects touch.
  RenderedView render(const Exec& exec, const SplatOptions& splat, const Camera& camera) const;

 private:
  const GaussianCloud& cloud_;
  int count_;
  std::vector<float> labels_;      // [N, K]
  std::vector<std::uint8_t> any_;  // [N]
};

/// One object in a rendering of ObjectLabels.
struct RenderedObject {
  const RenderedView& view;
  int channel = 0;
};

/// Pixels where the object alone and its masks disagree.
struct WrongPixels {
  std::int64_t beyond = 0;   // at least half opaque, outside of the rendered and the given mask
  std::int64_t missing = 0;  // less than half opaque, within both masks
  std::int64_t count() const { return beyond + missing; }
  /// Missing pixels count twice. Pixels missing with a plane, divided by those beyond the mask without it, were 0.84
  /// for a wrong plane and 0 to 0.24 for right ones.
  static constexpr int kMissingCost = 2;
  std::int64_t cost() const { return beyond + kMissingCost * missing; }
};

/// One view, cropped to the object's Gaussians.
class SupportView {
 public:
  /// `given_mask`: the input mask, [H·W]; empty: the view has none.
  SupportView(const FinishModel& model, const Camera& camera, const RenderedObject& in_view,
              const std::vector<GivenMask>& given_mask);

  struct Statuses {  // by the rendered mask and by the given one
    PointStatus rendered = PointStatus::kUnknown, given = PointStatus::kUnknown;
  };
  /// `behind`: depth behind the visible surface, world, up to which a point counts as at the surface.
  Statuses statuses(Vec3<double> point, double behind) const;
  /// The camera of the part of the image that can show the object; without pixels if none can.
  Camera window() const;
  /// [window] bit flags of `alone`, the object rendered alone in window(), for the calls below: alpha >= 0.1; alpha >=
  /// 1/2; its surface is more than `behind` behind the visible surface of the scene.
  std::vector<std::uint8_t> seen_alone(const RenderedView& alone, double behind) const;
  /// Target 0: pixels in the rendered or the given mask. Target 1: pixels outside where the scene occludes the object.
  /// Pixels outside are unknown if the object's alpha is below 0.1, or below 1/2 within 3 px of the mask, its soft
  /// edge.
  ViewMasks masks_alone(const std::vector<std::uint8_t>& seen) const;
  WrongPixels wrong_pixels(const std::vector<std::uint8_t>& seen) const;
  /// [window] 1: the visible surface is behind one of the planes, or at most its tolerance and `above_px` pixels above.
  std::vector<std::uint8_t> shows_plane(const std::vector<FillSurface>& planes, double above_px) const;
  /// Of WrongPixels::beyond, those where the scene shows a plane.
  std::int64_t beyond_at_planes(const std::vector<std::uint8_t>& seen,
                                const std::vector<std::uint8_t>& shows_plane) const;
  /// Where a plane should rise, from its origin: the sum of u and v, world, over the wrong pixels that show a plane, at
  /// most `reach` from the origin. Missing ones count negative, as often as in WrongPixels::cost().
  Vec2<double> uphill(const std::vector<std::uint8_t>& seen, const std::vector<std::uint8_t>& shows_plane,
                      const FillSurface& plane, double reach) const;
  /// Size of a pixel at a point, world; 0 if the point is not in the image.
  double pixel_size(Vec3<double> point) const;

 private:
  struct Pixel {
    int x, y;
    double z;
  };
  bool project(Vec3<double> point, Pixel& at) const;
  /// The point of the visible surface at a pixel; not finite if it shows none.
  Vec3<double> surface_point(int x, int y) const;
  void crop(const FinishModel& model);
  std::size_t index(int x, int y) const { return std::size_t(y - y_) * std::size_t(width_) + std::size_t(x - x_); }

  Camera scene_camera_;
  Camera camera_;                               // relative to the model's origin
  int x_ = 0, y_ = 0, width_ = 0, height_ = 0;  // the stored part of the image
  std::vector<float> depth_;                    // [height, width] camera z of the visible surface; infinite: none
  std::vector<std::uint8_t> mask_;              // [height, width] bits
};

}  // namespace ngs::finish
