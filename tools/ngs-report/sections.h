#pragma once
// The sections of one run. Each is empty where the run has nothing for it, except the oddities.
#include <string>
#include <string_view>
#include <vector>

#include "pictures.h"
#include "run_folder.h"

namespace ngs::cli {

std::string tiles(const RunFolder& run);
std::string oddities_section(const RunFolder& run);
std::string accuracy_section(const RunFolder& run);
std::string views_section(RunFolder& run, Pictures& pictures);
std::string objects_section(const RunFolder& run);
std::string decisions_section(const RunFolder& run);
std::string times_section(const RunFolder& run);
std::string trace_section(const RunFolder& run);
/// Contact sheet of the given masks over their photos. Empty where no view has any.
std::string given_section(RunFolder& run, Pictures& pictures);
std::string inputs_section(const RunFolder& run);
std::string tools_section(const RunFolder& run);

}  // namespace ngs::cli
