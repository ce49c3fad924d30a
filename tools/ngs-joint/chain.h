#pragma once
// ngs-joint from its inputs to its outputs: read, mend, decide, optimise, write.
#include "methods.h"
#include "ngs/stages/render/render_options.h"
#include "optimise.h"

namespace ngs::joint {

struct Paths {  // empty: not given
  std::string scene, boundary, field, effects_from, labelled, nerf, trace;
};

struct Declared {
  Settings settings;
  RasterOptions raster;
  MethodOptions methods;
  double start_s = 0;  // wall_seconds() when the process began
};

/// Returns the exit code.
int run_chain(cli::Run& run, const Declared& declared, const Paths& paths);

}  // namespace ngs::joint
