#pragma once
// The passes of --method ngs, in the order in which they run.
#include <memory>
#include <vector>

namespace ngs {

class Pass;

// Each is defined in the pass's folder.
std::unique_ptr<Pass> make_windows_pass();
std::unique_ptr<Pass> make_exposure_pass();
std::unique_ptr<Pass> make_mask_outliers_pass();
std::unique_ptr<Pass> make_floaters_pass();
std::unique_ptr<Pass> make_components_pass();
std::unique_ptr<Pass> make_bleed_through_pass();
std::unique_ptr<Pass> make_joint_pass();
std::unique_ptr<Pass> make_contours_pass();

std::vector<std::unique_ptr<Pass>> all_passes();

}  // namespace ngs
