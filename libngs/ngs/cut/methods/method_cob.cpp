#include "ngs/cut/methods/method_cob.h"

#include "ngs/cut/methods/cob_trainer.h"

namespace ngs {
namespace {

constexpr int kLabelOnlyPhases = 5;  // 10 V iterations, the published code's default without texture phases

}  // namespace

Solution run_cob_schedule(const Exec& exec, Monitor& monitor, const CobOptions& options, const Problem& input,
                          const ColourTerm& colour_term) {
  CobTrainer trainer(options, input);
  for (int phase = 0; phase < (options.rounds > 0 ? 1 : kLabelOnlyPhases); ++phase) trainer.mask_phase(exec, monitor);
  for (int round = 0; round < options.rounds && !monitor.stop_requested(); ++round) {
    trainer.split(exec);
    trainer.texture_phase(exec, monitor, colour_term);
    trainer.mask_phase(exec, monitor);
    monitor.progress(round + 1, options.rounds);
  }
  if (options.rounds > 0 && !monitor.stop_requested()) trainer.prune(exec);
  return trainer.result(monitor);
}

Solution run_cob(const Exec& exec, Monitor& monitor, const CobOptions& options, const Problem& input) {
  return run_cob_schedule(exec, monitor, options, input, nullptr);
}

}  // namespace ngs
