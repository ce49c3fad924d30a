#pragma once
// A run of ngs-joint: read inputs, prepare, decide effects, optimise, write outputs.
#include "options.h"

namespace ngs::joint {

struct Paths {  // empty: not given
  std::string scene, boundary, field, effects_from, labelled, trace;
};

/// `start_s`: wall_seconds() when the process began. Returns the exit code.
int run_method(cli::Run& run, Options& options, const Paths& paths, double start_s);

}  // namespace ngs::joint
