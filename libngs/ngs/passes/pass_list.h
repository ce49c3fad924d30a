#pragma once
// The passes of --method ngs, in the order in which they run.
#include <memory>
#include <vector>

namespace ngs {

class Pass;
std::vector<std::unique_ptr<Pass>> all_passes();

}  // namespace ngs
