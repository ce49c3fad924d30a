#pragma once
// The sections of one run. A section without content is empty.
#include <string>
#include <string_view>
#include <vector>

#include "pictures.h"
#include "run_folder.h"

namespace ngs::cli {

std::string tiles(const RunFolder& run);
std::string warnings_section(const RunFolder& run);
std::string accuracy_section(const RunFolder& run);
std::string views_section(RunFolder& run, Pictures& pictures);
std::string view_scores(const RunFolder& run);
std::string objects_section(const RunFolder& run);
std::string decisions_section(const RunFolder& run);
std::string times_section(const RunFolder& run);
std::string trace_section(const RunFolder& run);
/// Contact sheet of the input masks over their photos. Empty if no view has a mask.
std::string given_section(RunFolder& run, Pictures& pictures);
std::string inputs_section(const RunFolder& run);
std::string tools_section(const RunFolder& run);

}  // namespace ngs::cli
