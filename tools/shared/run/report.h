#pragma once
// The JSON report of every tool, and its schema.
#include <string>
#include <vector>

#include "ngs/core/monitor.h"
#include "shared/cli/common_flags.h"
#include "shared/cli/spec.h"
#include "shared/run/environment.h"
#include "shared/run/streams.h"

namespace ngs::cli {

struct ReadInput {
  std::string name, path;
  std::uint64_t bytes = 0;
  std::string xxh3;  // empty in a dry run
};

struct ReportData {
  const Spec& spec;
  const CommonFlags& flags;
  const Streams& streams;
  const ChosenDevice& device;
  int threads;
  Isa isa;
  const std::vector<ReadInput>& inputs;
  const Monitor& monitor;
  const Json& result;
  const Json& plan;
  double wall_s, cpu_s;  // of the whole process
  int exit_code;
};

Json make_report(const ReportData& data);
/// JSON Schema (draft-07) of the report of this tool. It refers to the options as ../options/TOOL.schema.json.
Json report_schema(const Spec& spec);

// The summary of a run on a terminal: outputs, time, scores, number of warnings and the next command.

/// At most ten lines. `report`: of a run that succeeded (run/report.h). Within a chain (NGS_STAGE_OF, such as 3/9) it
/// is one line, because the chain prints its own summary.
std::string summary_text(const Spec& spec, const Json& report);

/// "3/9": this run is stage 3 of a chain of 9; empty outside a chain.
std::string stage_of_chain();

/// "12.3 s", "4 min 5 s", "2 h 7 min".
std::string duration_text(double seconds);

}  // namespace ngs::cli
