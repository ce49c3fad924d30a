#pragma once
// Which effects a run has: the decisions of its command line, of another run's report, of the time that is
// left, and of the detectors, in this order.
#include <optional>
#include <string>
#include <vector>

#include "budget.h"
#include "optimise.h"

namespace ngs::joint {

class Decisions {
 public:
  /// `ruled`: what options decide without naming an effect. `effects_from`: a report of ngs-joint whose decisions are
  /// taken over where nothing is ruled, or empty. kBadInput if it holds none.
  Decisions(const Settings& settings, std::vector<EffectVerdict> ruled, const std::string& effects_from);

  /// Another decision that the scene has no say in; entries of --effect still win.
  void rule(EffectVerdict verdict) { verdicts_.push_back(std::move(verdict)); }

  /// Decides a phase on `input`, says a line for each decision of a detector (-v), and notes all in the
  /// report.
  void decide(cli::Run& run, EffectPhase phase, const Problem& input);
  /// Warns of effects that --effect asks for by name and that are off for want of another.
  void warn_of_needs(cli::Run& run) const;
  bool on(std::string_view name) const;
  /// What is said of an effect before any detector, also by an effect that it needs; null: nothing yet.
  std::optional<bool> said(std::string_view name) const;
  /// The settings with every decision taken, for the stages.
  Settings settled() const;

  Json json() const;

 private:
  Settings settings_;
  std::vector<EffectVerdict> verdicts_;
  std::vector<EffectDecision> all_;
};

/// For --explain: a line per decision.
std::string decision_table(const Decisions& decisions);

/// For --help: every effect and what it does.
std::string effects_help();

}  // namespace ngs::joint
