#pragma once
// The checks of inputs and outputs before a tool starts to work.
#include "shared/report.h"

namespace ngs::cli {

/// Every given input is there and readable (kBadInput).
void check_inputs(const Spec& spec);
/// No output (nor the report) exists already unless `overwrite`, none is an input (kUsage), every folder is
/// there (kEnvironment).
void check_outputs(const Spec& spec, const std::string& report_path, bool overwrite);
/// Sizes and, with `hash`, content hashes of all given inputs.
std::vector<ReadInput> describe_inputs(const Spec& spec, bool hash);
ReadInput describe_input(const std::string& name, const std::string& path, bool hash);

}  // namespace ngs::cli
