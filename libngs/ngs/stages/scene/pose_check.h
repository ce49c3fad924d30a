#pragma once
// Do cameras and model belong together? The model is rendered at a few cameras and compared with the photos;
// if it does not fit, the usual mistakes in pose files are tried and the one that makes it fit is named.
#include <span>
#include <string>
#include <vector>

#include "ngs/ops/splat/splat.h"

namespace ngs {

/// How well the model explains one photo. The colour behind the model is not in a PLY, so the one that fits
/// the photo best is used; thereby a model that is not in view at all scores exactly `constant_db`.
struct PhotoMatch {
  double psnr_db = 0;      // rendered model, over the fitted background, against the photo
  double constant_db = 0;  // PSNR of the photo's own mean colour: what a picture that knows nothing reaches
  double covered = 0;      // mean alpha
  Vec3<double> background{0, 0, 0};
  double gain_db() const { return psnr_db - constant_db; }
};

/// `view`: the model, rendered over black at the camera of `photo` and at its size.
PhotoMatch match_rendered(const RenderedView& view, const ImageF& photo);

/// A camera and its photo, of its size.
struct PhotoView {
  const Camera& camera;
  const ImageF& photo;
};

/// The same of the model rendered here.
PhotoMatch match_photo(const Exec& exec, const GaussianCloud& cloud, const PhotoView& view, const SplatOptions& splat);

/// What a gain (not negative) and an offset per channel would make of the model's picture over the background of
/// `match`: the PSNR of min over g, o of Σ (p - g q - o)², above its `constant_db`.
double recoloured_gain_db(const Exec& exec, const GaussianCloud& cloud, const PhotoView& view,
                          const SplatOptions& splat, const PhotoMatch& match);

/// Median over the cameras of the share of what is in front of one that is nearer than the near plane, and so never
/// drawn: near 1 in a world that is too small. 0: nothing is in front of any.
double share_too_near(const GaussianCloud& cloud, std::span<const Camera> cameras, Compat compat);
/// From here on it is not a matter of single cameras.
inline constexpr double kTooNear = 0.5;
/// The way out of it.
inline constexpr const char* kTooNearRemedy =
    "most of it lies nearer to the cameras than the near plane, before which nothing is drawn: scale the world of "
    "cameras, points "
    "and model up";

/// A mistake that pose files have, as the change that undoes it.
struct PoseRepair {
  std::string mistake;  // "quaternions stored as x y z w"
  std::string remedy;   // what to do about it
  Camera (*apply)(Camera);
};
const std::vector<PoseRepair>& pose_repairs();

}  // namespace ngs
