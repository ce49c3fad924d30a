#pragma once
// Empty masks: is the object not in these views, or did the tool that made the masks lose it?
//
// The masks that are not empty label the Gaussians which they see (closed form, stages/boundary/variance_stage.h), all
// others are what the nearest of these is. The labels are rendered in the views with an empty mask, so that what stands
// before the object hides it; but what the other masks see through the object alone, such as the wall behind it, is
// taken for a part of it. Where the object covers a quarter of what it usually covers, the mask is contradicted.
#include "ngs/core/monitor.h"
#include "ngs/scene/scene.h"
#include "ngs/stages/boundary/variance_stage.h"
#include "ngs/stages/scene/scene_findings.h"

namespace ngs {

inline constexpr double kLeastMaskAgreement = 0.5;  // IoU

struct EmptyMaskInputs {
  const GaussianCloud& cloud;
  const Scene& scene;
  std::vector<std::size_t> empty, others;  // views of the scene, with a mask each
  MaskLoader load_masks;
};

/// `contradicted` stays empty where the agreement is below a half: then the masks do not say where the object is.
EmptyMasks check_empty_masks(const Exec& exec, Monitor& monitor, const EmptyMaskInputs& in);

}  // namespace ngs
