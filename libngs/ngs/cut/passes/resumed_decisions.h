#pragma once
// A resumed run repeats the decisions of the stopped run, because time-dependent decisions could differ.
#include "ngs/cut/passes/pipeline.h"

namespace ngs {

/// The decisions that determine the state of the joint steps, as "NAME=on" and "NAME=off". Decisions that a resumed run
/// makes again are not included.
Json stored_decisions(const Pipeline& pipeline, const Decisions& decisions);

/// Adds the stored decisions of the stopped run as fixed decisions. Switches of --effect and earlier fixed decisions
/// take precedence. Entries that are no decision on a known effect are ignored.
///   effects    stored_decisions() of the stopped run
///   skipped   its PassRun::skipped
void repeat_decisions(const Pipeline& pipeline, PassRun& run, const Json& effects, const Json& skipped);

}  // namespace ngs
