#pragma once
// Checks whether cameras and model belong together: the model is rendered at a few cameras and compared with the
// photos. If it does not fit, common mistakes in pose files are undone one by one, to report the one that makes it fit.
#include <span>
#include <string>
#include <vector>

#include "ngs/ops/splat/splat.h"

namespace ngs {

/// How well a render of the model matches one photo. A PLY does not contain the background colour, so the one that fits
/// the photo best is used; a model outside the view therefore scores exactly `constant_db`.
struct PhotoMatch {
  double psnr_db = 0;      // rendered model, over the fitted background, against the photo
  double constant_db = 0;  // PSNR of an image of the photo's mean colour: the baseline
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

/// The same, renders the model first.
PhotoMatch match_photo(const Exec& exec, const GaussianCloud& cloud, const PhotoView& view, const SplatOptions& splat);

/// PSNR minus `match.constant_db` of the render over the background of `match`, after the best gain g >= 0 and offset o
/// per channel: min over g, o of Σ (p - g q - o)².
double recoloured_gain_db(const Exec& exec, const GaussianCloud& cloud, const PhotoView& view,
                          const SplatOptions& splat, const PhotoMatch& match);

/// PSNR minus that of the mean colour, both over the pixels that the model covers (alpha above 0.9); 0: it covers none.
double covered_gain_db(const Exec& exec, const GaussianCloud& cloud, const PhotoView& view, const SplatOptions& splat);

/// Median over the cameras of the fraction of Gaussians in front of the camera that are nearer than the near plane and
/// so not rendered: about 1 in a world that is too small. 0 if no camera has a Gaussian in front.
double share_too_near(const GaussianCloud& cloud, std::span<const Camera> cameras, double near_z);
/// The unit (math/world_unit.h) for the model's distance from the median camera: 1 from 2.5 on, else proportional to
/// it and rounded down to a power of two; 1 if no camera has a Gaussian in front.
double model_world_unit(const GaussianCloud& cloud, std::span<const Camera> cameras);
/// Above this fraction the scale of the world is wrong, not single cameras.
inline constexpr double kTooNear = 0.5;
/// Hint for a fraction above kTooNear in a fit.
inline constexpr const char* kTooNearRemedy =
    "most of the model is nearer to the cameras than the near plane and is not rendered: scale up the world of "
    "cameras and points";

/// A common mistake in pose files and the change that undoes it.
struct PoseRepair {
  std::string mistake;  // "quaternions stored as x y z w"
  std::string remedy;   // how to correct the file
  Camera (*apply)(Camera);
};
const std::vector<PoseRepair>& pose_repairs();

/// The same for programs that write splats.
struct ModelRepair {
  std::string mistake;            // "rot_0 to rot_3 of the splat hold x y z w"
  std::string remedy;             // IN.ply and OUT.ply are for the user to fill in
  bool (*apply)(GaussianCloud&);  // false: it changes no model of this kind
  bool if_unfit = false;          // for a model that does not fit: a photo cannot tell it apart from another cause
};
const std::vector<ModelRepair>& model_repairs();

}  // namespace ngs
