#pragma once
// The checks of inputs and outputs before a tool starts to work.
#include "shared/run/report.h"

namespace ngs::cli {

/// Every given input is there and readable (kBadInput).
void check_inputs(const Spec& spec);
/// No output (nor the report) exists already unless `overwrite`, none is an input, no two are one file (kUsage),
/// every folder is there (kEnvironment).
void check_outputs(const Spec& spec, const std::string& report_path, bool overwrite);
/// No output (nor the report) is this input, which the tool has found by itself (kUsage).
void refuse_outputs_over(const Spec& spec, const std::string& report_path, const std::string& name,
                         const std::string& input);
/// Sizes and, with `hash`, content hashes of all given inputs.
std::vector<ReadInput> describe_inputs(const Spec& spec, bool hash);
ReadInput describe_input(const std::string& name, const std::string& path, bool hash);

}  // namespace ngs::cli
