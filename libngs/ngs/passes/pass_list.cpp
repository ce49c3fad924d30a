#include "ngs/passes/pass_list.h"

#include "ngs/passes/bleed_through/bleed_through_pass.h"
#include "ngs/passes/components/components_pass.h"
#include "ngs/passes/contours/contours_pass.h"
#include "ngs/passes/exposure/exposure_pass.h"
#include "ngs/passes/floaters/floaters_pass.h"
#include "ngs/passes/joint/joint_pass.h"
#include "ngs/passes/mask_outliers/mask_outliers_pass.h"
#include "ngs/passes/windows/windows_pass.h"

namespace ngs {

std::vector<std::unique_ptr<Pass>> all_passes() {
  std::vector<std::unique_ptr<Pass>> passes;
  passes.push_back(std::make_unique<WindowsPass>());
  passes.push_back(std::make_unique<ExposurePass>());
  passes.push_back(std::make_unique<MaskOutliersPass>());
  passes.push_back(std::make_unique<FloatersPass>());
  passes.push_back(std::make_unique<ComponentsPass>());
  passes.push_back(std::make_unique<BleedThroughPass>());
  passes.push_back(std::make_unique<JointPass>());
  passes.push_back(std::make_unique<ContoursPass>());
  return passes;
}

}  // namespace ngs
