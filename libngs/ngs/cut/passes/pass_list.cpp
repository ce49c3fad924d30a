#include "ngs/cut/passes/pass_list.h"

#include "ngs/cut/passes/pass.h"

namespace ngs {

std::vector<std::unique_ptr<Pass>> all_passes() {
  std::vector<std::unique_ptr<Pass>> passes;
  passes.push_back(make_windows_pass());
  passes.push_back(make_exposure_pass());
  passes.push_back(make_mask_outliers_pass());
  passes.push_back(make_floaters_pass());
  passes.push_back(make_components_pass());
  passes.push_back(make_bleed_through_pass());
  passes.push_back(make_joint_pass());
  passes.push_back(make_contours_pass());
  return passes;
}

}  // namespace ngs
