#pragma once
// What one view contains about the place of the object: its masks and the visible surface.
#include <vector>

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
enum class Side : std::uint8_t {
  kUnknown,  // not in the image, or the view has no mask there
  kSeen,     // within the mask, in front of the visible surface or at it
  kInside,   // within the mask, behind the visible surface
  kOutside,  // outside the mask, in front of the visible surface or at it
  kHidden    // outside the mask, hidden by other things
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
};

/// One view, cropped to the object's Gaussians.
class SupportView {
 public:
  /// `given_mask`: the input mask, [H·W]; empty: the view has none.
  SupportView(const FinishModel& model, const Camera& camera, const RenderedObject& in_view,
              const std::vector<GivenMask>& given_mask);

  struct Sides {
    Side rendered = Side::kUnknown, given = Side::kUnknown;  // by the rendered mask and by the given one
  };
  /// `behind`: depth behind the visible surface, world, up to which a point counts as at the surface.
  Sides sides(Vec3<double> point, double behind) const;
  /// The camera of the part of the image that can show the object; without pixels if none can.
  Camera window() const;
  /// [window] what the object shows, rendered alone in this window, for the calls below: bits of alpha from 0.1 and
  /// from 1/2 on, and of a surface behind the visible one of the scene.
  std::vector<std::uint8_t> seen_alone(const RenderedView& alone, double behind) const;
  /// Pixels of its rendered or given mask (target 0), and pixels outside whose visible surface in the scene is in front
  /// of the object (target 1). Unknown: pixels outside with an alpha below 0.1, and within 3 px of the mask, its soft
  /// edge, below 1/2.
  ViewMasks masks_alone(const std::vector<std::uint8_t>& seen) const;
  WrongPixels wrong_pixels(const std::vector<std::uint8_t>& seen) const;
  /// Size of a pixel at a point, world; 0 if the point is not in the image.
  double pixel_size(Vec3<double> point) const;

 private:
  struct Pixel {
    int x, y;
    double z;
  };
  bool project(Vec3<double> point, Pixel& at) const;
  void crop(const FinishModel& model);
  std::size_t index(int x, int y) const { return std::size_t(y - y_) * std::size_t(width_) + std::size_t(x - x_); }

  Camera scene_camera_;
  Camera camera_;                               // relative to the model's origin
  int x_ = 0, y_ = 0, width_ = 0, height_ = 0;  // the stored part of the image
  std::vector<float> depth_;                    // [height, width] camera z of the visible surface; infinite: none
  std::vector<std::uint8_t> mask_;              // [height, width] bits
};

}  // namespace ngs::finish
