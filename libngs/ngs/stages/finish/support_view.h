#pragma once
// What one view contains about the place of the object: its masks and the visible surface.
#include <vector>

#include "ngs/ops/splat/splat.h"
#include "ngs/scene/view_prompt.h"

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

/// One view, cropped to the object's Gaussians.
class SupportView {
 public:
  /// Renders the labels and the depth of `model`. `given`: the input mask, [H·W]; empty: the view has
  /// none.
  struct Input {
    const Camera& camera;
    const std::vector<GivenMask>& given;
  };
  SupportView(const Exec& exec, const FinishModel& model, const SplatOptions& splat, const Input& input);

  struct Sides {
    Side rendered = Side::kUnknown, given = Side::kUnknown;  // by the rendered mask and by the given one
  };
  /// `behind`: depth behind the visible surface, world, up to which a point counts as at the surface.
  Sides sides(Vec3<double> point, double behind) const;
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

  Camera camera_;                               // relative to the model's origin
  int x_ = 0, y_ = 0, width_ = 0, height_ = 0;  // the stored part of the image
  std::vector<float> depth_;                    // [height, width] camera z of the visible surface; infinite: none
  std::vector<std::uint8_t> mask_;              // [height, width] bits: kRendered, kGiven, kNoEvidence
};

}  // namespace ngs::finish
