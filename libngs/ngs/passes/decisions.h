#pragma once
// Which effects a run has: decided by its command line, by another run's report, by the time that is left, and by the
// detectors, in this order.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ngs/options/option_set.h"
#include "ngs/passes/effect.h"
#include "ngs/passes/scene_probe.h"

namespace ngs {

struct Decision {
  const Effect* effect;
  std::string mode;  // auto, on, off, or where the decision was taken over from
  bool on;
  std::string reason;
  std::optional<double> measured = {};
  bool aborted = false;  // it was on
};

/// A decision that something else than the scene takes: an option, or the time that is left.
struct FixedDecision {
  std::string_view name;
  bool on;
  std::string reason;
  std::string mode = "auto";
};

class Decisions {
 public:
  Decisions(std::vector<Effect> effects, EffectSwitches modes, std::vector<FixedDecision> verdicts = {});
  Decisions(const Decisions&) = delete;
  Decisions& operator=(const Decisions&) = delete;

  const std::vector<Effect>& effects() const { return effects_; }
  Switch mode(std::string_view name) const { return modes_.of(name); }

  /// Another decision that the scene has no say in; entries of --effect and earlier verdicts still win.
  void fix(FixedDecision verdict) { fixed_.push_back(std::move(verdict)); }

  /// Whether --effect or a verdict decides it.
  bool is_fixed(std::string_view name) const;

  /// Of an effect that is on: it turned out not to be done.
  void abort(std::string_view name, std::string reason);

  /// Decides these effects, in their order. True: a detector was asked.
  bool decide(const std::vector<Effect>& some, SceneProbe& probe);

  bool decided(std::string_view name) const { return find(name) != nullptr; }
  /// Of a decided effect.
  bool on(std::string_view name) const;
  /// What is known of an effect before any detector, also by an effect that it needs; null: nothing yet.
  std::optional<bool> on_if_known(std::string_view name) const;
  /// Whether it may be on, as far as that is known without a look at pictures.
  bool may_be_on(std::string_view name, const Problem& problem) const;

  const std::vector<Decision>& all() const { return all_; }
  Json json() const;
  /// A line per decision, for people.
  std::string table() const;

 private:
  const Decision* find(std::string_view name) const;
  std::optional<Decision> decision_without_heuristic(const Effect& effect) const;

  std::vector<Effect> effects_;
  EffectSwitches modes_;
  std::vector<FixedDecision> fixed_;
  std::vector<Decision> all_;
};

/// "auto: sh=off (view-dependent colour 0.12 <= 0.5 levels), leaves out ...".
std::string decision_line(const Decision& decision);

}  // namespace ngs
