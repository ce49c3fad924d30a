#pragma once
// L_mask (Eq. 19) of what the field shows of the objects: its nodes are an image, the given masks are read there.
#include "ngs/ops/losses/loss_mask.h"
#include "ngs/passes/joint/joint_field.h"

namespace ngs {

struct FieldMasks {
  const JointField& field;  // after its forward pass
  const FieldRays& rays;    // a ray that does not meet the surface that the view shows counts as unknown (C15)
  const ViewMasks& masks;   // of the view's size, available
};
struct FieldMaskWeight {
  MaskLossForm form;
  double weight;  // of the gradient
};

/// `grad` [R, objects], overwritten. The mean over the nodes that are known.
double field_mask_loss(const Exec& exec, const FieldMasks& in, const FieldMaskWeight& weight, std::vector<float>& grad);

}  // namespace ngs
