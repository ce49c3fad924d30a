#pragma once
// The splat that ngs-synth fits to its photos.
#include <string>

#include "dataset.h"
#include "shared/run/run.h"

namespace ngs::cli {

/// Options of a small, short fit.
FitOptions small_fit();
/// Other defaults for a messy room, which has more surfaces than 8000 Gaussians can show.
void make_finer(FitOptions& options, const synth::Recipe& recipe);
/// Fits a splat and writes it to `path`, unless a stop is requested before.
void fit_splat(Run& run, const SynthData& data, const FitOptions& options, const std::string& path);

}  // namespace ngs::cli
