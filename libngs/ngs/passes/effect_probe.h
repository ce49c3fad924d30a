#pragma once
// Measures what the effects' detectors ask for, each once and only where it is asked for, and decides.
// PAPER.md §5.7
//
// Masks and photos of training views and photos of others are read, masks of held-out views never. Everything
// is measured at the size it is given, on at most kDecisionViews views where that is enough.
#include <optional>

#include "ngs/passes/contours/contour_stage.h"
#include "ngs/passes/joint/joint_options.h"

namespace ngs {

struct EffectSetup {
  const JointOptions& joint;
  const ContourOptions& edge;
  const SampleOptions& sample;
  const RbfOptions& rbf;
  const Problem& input;
};

class EffectProbe {
 public:
  EffectProbe(const Exec& exec, const EffectSetup& setup);
  ~EffectProbe();
  EffectProbe(const EffectProbe&) = delete;
  EffectProbe& operator=(const EffectProbe&) = delete;

  // One number per detector; what it is stands in effect_registry().
  double exposure();
  double trust();
  double front();
  double components();
  double gap_without_photos();
  double most_neighbour();
  double rms_neighbour();
  double colour_range();
  double cells();
  double patches();
  double photos();
  double outside();
  double view_dependence();
  double compensation();
  double straddling();
  double narrow();

 private:
  struct Views;
  const Views& views();
  const BoundarySet& boundary();
  const KnnGraph& neighbours();
  std::vector<Camera> cameras() const;

  const Exec exec_;
  const EffectSetup& setup_;
  std::unique_ptr<Views> views_;
  std::optional<BoundarySet> boundary_;
  std::optional<KnnGraph> neighbours_;
};

/// A decision that something else than the scene takes: an option, or the time that is left.
struct EffectVerdict {
  std::string_view name;
  bool on;
  std::string reason;
  std::string mode = "auto";
};

/// What is decided of an effect without looking at the scene: an effect it needs that is off, whatever else is said, for it
/// could not run; then an entry of --effect, then the first verdict, then being always on. Null: its detector is asked.
/// `earlier`: decided already.
std::optional<EffectDecision> settled_decision(const EffectInfo& effect, const std::vector<std::string>& entries,
                                               const std::vector<EffectVerdict>& verdicts,
                                               const std::vector<EffectDecision>& earlier);

/// The effects of one phase: as settled_decision() says, else as their detectors do. `before` are the decisions of
/// earlier phases.
std::vector<EffectDecision> decide_effects(const Exec& exec, Monitor& monitor, const EffectSetup& setup,
                                           EffectPhase phase, const std::vector<EffectVerdict>& verdicts,
                                           const std::vector<EffectDecision>& before);

/// "NAME=on|off" for every decision: what the stages are given.
std::vector<std::string> decided_entries(const std::vector<EffectDecision>& decisions);

}  // namespace ngs
