#pragma once
// What the field shows where it was trained, at the contours, and the splat everywhere else.     Eqs. (1), (2), (16)
//
// "This process enhances details in the boundary area and blends with the 3DGS rendering results" (Sec. 3.2). A pixel
// within `band_px` of a contour of the rendered masks is a ray of the field, in the depth window about what the splat
// shows there. What the field leaves open is the splat's:
//
//   C = C_nerf + (1 - α_nerf) C_gs,   α and the masks alike
//
// A ray whose surface lies outside of its window (C15) keeps the splat's pixel.
#include "ngs/ops/splat/splat.h"
#include "ngs/passes/joint/joint_field.h"

namespace ngs {

/// A field that is no longer trained.
struct FieldModel {
  JointField field;
  BoundarySet boundary;  // positions and origin alone
  SampleOptions sample;  // samples and window of a ray
};

/// Where the field is drawn.
struct FieldBand {
  const Camera& camera;                 // world
  const std::array<double, 3>& origin;  // the model's
  double band_px;
};

/// Blends the field into `view`, which has colour, alpha, depth and masks; masks of a field without a head stay as they
/// are, so do those of more objects than it knows. Returns how many pixels the field has drawn. kInconsistent where the
/// field is relative to another origin than the model.
std::int64_t blend_field(const Exec& exec, FieldModel& model, const FieldBand& where, RenderedView& view);

/// [H·W] 1 within `band_px` (chessboard) of where a mask crosses 1/2.
std::vector<std::uint8_t> contour_band(const ImageF& masks, double band_px);

}  // namespace ngs
