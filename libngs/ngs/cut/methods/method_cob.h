#pragma once
// ngs-joint --method cob: COB-GS with given masks.                                          paper.md §6.3
//
// Two kinds of phases alternate, each of 2V iterations for V training views. A mask phase trains one label logit per
// Gaussian against the linear loss, then splits the large Gaussians that touch pixels inside and outside the mask.
// A texture phase trains all other parameters against the photos. The last phase is a mask phase that ends with
// pruning instead of splitting. Labels: sigmoid > 0.9.
//
// The statistic is r = |n+ - n-| / (n+ + n-) per view, where a Gaussian touches n+ pixels inside and n- outside the
// mask, averaged over the views of the phase. The published code divides by all views and counts r = 1 for a view
// in which the Gaussian is not visible, so its threshold depends on visibility (CobDivisor::kAll). The default
// divides by the number of views in which the Gaussian is visible.
#include "ngs/core/monitor.h"
#include "ngs/cut/methods/cob_trainer.h"
#include "ngs/problem/problem.h"

namespace ngs {

Solution run_cob(const Exec& exec, Monitor& monitor, const CobOptions& options, const Problem& input);

}  // namespace ngs
