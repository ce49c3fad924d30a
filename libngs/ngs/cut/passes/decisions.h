#pragma once
// Decides which effects are on in a run, by the command line, another run's report, the time left, the heuristics.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ngs/cut/training/effect.h"
#include "ngs/cut/training/scene_probe.h"
#include "ngs/options/option_set.h"

namespace ngs {

struct Decision {
  const Effect* effect;
  std::string mode;  // auto, on, off, or the source of a fixed decision
  bool on;
  std::string reason;
  std::optional<double> measured = {};
  bool aborted = false;  // the effect was on, and was aborted
};

/// A decision made by an option, by --effects-from or by the time budget instead of a heuristic.
struct FixedDecision {
  std::string_view name;
  bool on;
  std::string reason;
  std::string mode = "auto";
};

class Decisions {
 public:
  Decisions(std::vector<Effect> effects, EffectSwitches switches, std::vector<FixedDecision> fixed = {});
  Decisions(const Decisions&) = delete;
  Decisions& operator=(const Decisions&) = delete;

  const std::vector<Effect>& effects() const { return effects_; }
  Switch switch_of(std::string_view name) const { return switches_.of(name); }

  /// Adds a fixed decision. Switches of --effect and earlier fixed decisions take precedence.
  void fix(FixedDecision decision) { fixed_.push_back(std::move(decision)); }

  /// True: --effect or a fixed decision sets it.
  bool is_fixed(std::string_view name) const;

  /// Marks an effect that is on as aborted.
  void abort(std::string_view name, std::string reason);

  /// Decides these effects, in their order. True: a heuristic was measured.
  bool decide(const std::vector<Effect>& some, SceneProbe& probe);

  bool decided(std::string_view name) const { return find(name) != nullptr; }
  /// The effect must be decided.
  bool on(std::string_view name) const;
  /// The decision if it does not depend on a heuristic, or is already made; null: unknown so far.
  std::optional<bool> on_if_known(std::string_view name) const;
  /// False: it is known, without loading images, that the effect is off.
  bool may_be_on(std::string_view name, const Problem& problem) const;

  const std::vector<Decision>& all() const { return all_; }
  Json json() const;
  /// Text table with one line per decision.
  std::string table() const;

 private:
  const Decision* find(std::string_view name) const;
  std::optional<Decision> decision_without_heuristic(const Effect& effect) const;

  std::vector<Effect> effects_;
  EffectSwitches switches_;
  std::vector<FixedDecision> fixed_;
  std::vector<Decision> all_;
};

/// "auto: sh=off (view-dependent colour 0.12 <= 0.5 levels), leaves out ...".
std::string decision_line(const Decision& decision);

}  // namespace ngs
