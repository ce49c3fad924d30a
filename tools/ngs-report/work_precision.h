#pragma once
// ngs-report work-precision: time and accuracy of each setting of each knob, as a page, JSON and CSV.
#include <string>

#include "sweep.h"

namespace ngs::cli {

struct SweepView {
  std::string score;  // name in metrics.json "mean"
  bool cpu;           // CPU seconds instead of wall time
};

std::string sweep_page(const Sweep& sweep, const SweepView& view);
Json sweep_json(const Sweep& sweep, const SweepView& view);
std::string sweep_csv(const Sweep& sweep);

int work_precision_command(int argc, char** argv);

}  // namespace ngs::cli
