#include "shared/cli/spec.h"

#include <algorithm>

namespace ngs::cli {

bool Spec::writes_nothing() const {
  return std::ranges::any_of(writes_nothing_if, [](const bool* option) { return *option; });
}

}  // namespace ngs::cli
