#pragma once
// The state of the joint steps in a file (--checkpoint, --resume).
#include <optional>
#include <string>

#include "ngs/passes/pass.h"
#include "shared/run/checkpoints.h"
#include "shared/run/signals.h"

namespace ngs::joint {

/// One folder. `identity` names all that the state follows from; a checkpoint with another one is kInconsistent. Its
/// contents are believed as little as those of any file: kBadInput for arrays of another length, numbers that are not
/// finite where the trainer's are, and a step that is not planned.
class StepFile : public StepStore {
 public:
  struct Setup {
    std::string folder;
    bool resume = false;
    std::int64_t every = 0;
  };
  StepFile(Monitor& monitor, Setup setup) : setup_(std::move(setup)), checkpoints_(monitor) {}

  static std::string path_in(const std::string& folder);
  /// The identity of the run that is resumed; none: there is no such run. kInconsistent where it is of other things
  /// than what is `known` of this run, before the work for it is done; asked again, it does not read the file again.
  const std::optional<Json>& resumed(const Json& known);
  /// Once it is known what the run follows from.
  void identify(const Json& identity) { identity_ = identity.dump(); }

  bool load(JointTrainer& trainer) override;
  void save(JointTrainer& trainer) override;
  void save_on_the_way(JointTrainer& trainer) override;
  void taking_steps(bool begins) override;
  std::int64_t every() const override { return setup_.every; }

 private:
  std::string path() const { return path_in(setup_.folder); }

  Setup setup_;
  cli::Checkpoints checkpoints_;
  std::optional<cli::SignalGrace> grace_;
  std::string identity_;
  std::optional<Json> before_;
};

}  // namespace ngs::joint
