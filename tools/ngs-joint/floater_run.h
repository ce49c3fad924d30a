#pragma once
// --effect floaters: what stands before the object is taken out before any method sees the model.
#include <string>
#include <vector>

#include "optimise.h"
#include "ngs/stages/floaters.h"

namespace ngs::joint {

/// What replaces the model that was read; empty where nothing was removed.
struct FloaterOutcome {
  FloaterRemoval removal;
  std::vector<float> floater;  // [N] 1: removed
  bool removed() const { return !floater.empty(); }
};

/// --effect floaters=auto is on for the paper's method and off for those beside it, which are what their papers say.
bool floaters_wanted(const Settings& settings);

/// Searches, removes, warns, and notes the figures in the report.
FloaterOutcome handle_floaters(cli::Run& run, const MethodInput& input);

/// `input` with the model and labels of the outcome, which must outlive it, where something was removed.
MethodInput without_floaters(const MethodInput& input, const FloaterOutcome& outcome);

}  // namespace ngs::joint
