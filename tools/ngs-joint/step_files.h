#pragma once
// Checkpoint file of the joint steps (--checkpoint, --resume).
#include <optional>
#include <string>

#include "ngs/cut/passes/pass.h"
#include "shared/run/checkpoints.h"
#include "shared/run/signals.h"

namespace ngs::joint {

/// The checkpoint in one folder. `identity` has the inputs and options that determine the state; a checkpoint with a
/// different identity is kInconsistent. Contents are validated: throws kBadInput for arrays of another length, for
/// values that are not finite where the trainer's are, and for a step beyond the plan.
class StepFile : public StepStore {
 public:
  struct Setup {
    std::string folder;
    bool resume = false;
    std::int64_t every = 0;
  };
  StepFile(Monitor& monitor, Setup setup) : setup_(std::move(setup)), checkpoints_(monitor) {}

  static std::string path_in(const std::string& folder);
  /// The identity of the run to resume; nullopt: there is none. Throws kInconsistent if it contradicts the entries in
  /// `known`, so that the error comes before the work. Later calls do not read the file again.
  const std::optional<Json>& resumed(const Json& known);
  void identify(const Json& identity) { identity_ = identity.dump(); }

  bool load(JointTrainer& trainer) override;
  void save(JointTrainer& trainer) override;
  void try_save(JointTrainer& trainer) override;
  void steps_running(bool begins) override;
  std::int64_t save_interval() const override { return setup_.every; }

 private:
  std::string path() const { return path_in(setup_.folder); }

  Setup setup_;
  cli::Checkpoints checkpoints_;
  std::optional<cli::SignalGrace> grace_;
  std::string identity_;
  std::optional<Json> previous_;
};

}  // namespace ngs::joint
