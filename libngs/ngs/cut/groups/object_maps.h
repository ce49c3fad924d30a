#pragma once
// Label maps of the views of a model whose Gaussians have objects.
#include "ngs/cut/groups/grouped_objects.h"

namespace ngs {

/// Renders the objects' numbers.
class ObjectMaps {
 public:
  /// All arguments but `exec` must outlive this object.
  ObjectMaps(const Exec& exec, const GaussianCloud& cloud, const SplatOptions& splat, const GroupedObjects& objects);

  /// [H, W, 1] number of the object with most of the pixel's weight; 0: none.
  ImageU16 rendered(const Exec& exec, const Camera& camera) const;
  /// The same with NumberedMasks::kUnknown for doubtful objects.
  ImageU16 known(const Exec& exec, const Camera& camera) const;
  /// The numbers for the pixels of `masks`, of its size: a mask that shows one object (kOneObject of its weight) gets
  /// its number. A mask of several is divided as rendered. NumberedMasks::kUnknown: pixels without a mask where an
  /// object is rendered, masks that show no Gaussian, and doubtful objects. `view`: the Gaussians of these masks.
  ImageU16 corrected(const Exec& exec, const Camera& camera, const ViewGaussians& view,
                     const NumberedMasks& masks) const;
  static constexpr double kOneObject = 0.7;

 private:
  const GaussianCloud& cloud_;
  const SplatOptions& splat_;
  const GroupedObjects& objects_;
  int bits_ = 1;
  std::vector<float> code_;  // [N, bits] binary digits of the object's number
};

}  // namespace ngs
