#pragma once
// The texts of --help and --version.
#include <string>

#include "shared/spec.h"

namespace ngs::cli {

std::string help_text(const Spec& spec);
std::string version_text(const Spec& spec, bool json);

}  // namespace ngs::cli
