#pragma once
// ngs-joint --method cob: COB-GS with given masks.                                          PAPER.md §6.3
//
// Phases of 2V iterations, V training views, alternate: a mask phase trains one label logit per Gaussian
// against the linear loss, then splits the large Gaussians whose pixels contradict each other; a texture
// phase trains everything else against the photos. The last phase is a mask phase and ends with pruning
// instead. Labels: sigmoid > 0.9.
//
// The statistic is r = |n+ - n-| / (n+ + n-) per view, of the pixels a Gaussian touches inside and outside of
// the mask, averaged over the views of the phase. The code divides by all of them and counts r = 1 where a
// Gaussian is not visible, so that its threshold depends on visibility (`literal`); the default divides by
// the visible ones.
#include "ngs/core/monitor.h"
#include "ngs/methods/cob_options.h"
#include "ngs/problem/problem.h"

namespace ngs {

Solution run_cob(const Exec& exec, Monitor& monitor, const CobOptions& options, const Problem& input);

}  // namespace ngs
