#pragma once
// A run that goes on where another was stopped repeats its decisions: the clock may answer otherwise now.
#include "ngs/passes/pipeline.h"

namespace ngs {

/// What is kept of decisions, of those that the state of the joint steps follows from: "NAME=on" and "NAME=off".
/// Not those of passes that are decided anew.
Json kept_decisions(const Pipeline& pipeline, const Decisions& decisions);

/// Rules what is kept of the run before; an entry of --effect and earlier verdicts still win. What is no decision on a
/// known effect is passed over.
///   effects    kept_decisions() of the run before
///   left_out   its PassRun::left_out
void repeat_decisions(const Pipeline& pipeline, PassRun& run, const Json& effects, const Json& left_out);

}  // namespace ngs
