#pragma once
// Selects the Gaussians of the object: a threshold on label or prob, a rule for Gaussians visible in no view,
// hand-made constraints, and removal of small components.                           paper.md §5.4
//
// The k-NN vote on an unseen Gaussian is local: its nearest seen Gaussians count as background if they are farther
// than kVoteReach, so that labels do not spread across the scene.
#include <span>
#include <string>

#include "ngs/backend/exec.h"
#include "ngs/options/field.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/labels/label_column.h"

namespace ngs {

/// In units of the median distance of the object's seen Gaussians to their k-th nearest neighbour among themselves,
/// with k = unseen_neighbours.
inline constexpr double kVoteReach = 5;
/// In units of the unseen Gaussian's largest scale: a large Gaussian overlaps neighbours that are farther away.
inline constexpr double kOwnVoteReach = 3;

enum class UnseenRule : std::uint8_t { kKnn, kObject, kBackground };
inline constexpr NamedValue<UnseenRule> kUnseenRuleNames[] = {
    {UnseenRule::kKnn, "knn"}, {UnseenRule::kObject, "object"}, {UnseenRule::kBackground, "background"}};

enum class ScoreColumn : std::uint8_t { kAuto, kLabel, kProb };
inline constexpr NamedValue<ScoreColumn> kScoreColumnNames[] = {
    {ScoreColumn::kAuto, "auto"}, {ScoreColumn::kLabel, "label"}, {ScoreColumn::kProb, "prob"}};

struct ExtractOptions {
  std::string rule = "threshold:0.5";
  ScoreColumn score = ScoreColumn::kAuto;
  UnseenRule unseen = UnseenRule::kKnn;
  int unseen_neighbours = 8;  // seen neighbours that vote on an unseen Gaussian; no option sets it
  int min_component = 0;
  int component_neighbours = 8;  // nearest neighbours that may connect two Gaussians; no option sets it

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.rule, Text{"rule", "RULE",
                          "Object test: threshold:T (score >= T), flash:GAMMA (f > (1+GAMMA)/2), flash-l2:GAMMA "
                          "(normalised as in its code), sa3d (f > 0.3/1.3), cob:T (score > T)"});
    visit(self.score,
          Choice<ScoreColumn>{"score", "Column that the rule tests; auto: ngs_prob for flash and sa3d, else ngs_label",
                              kScoreColumnNames});
    visit(self.unseen,
          Choice<UnseenRule>{
              "unseen",
              "Label of Gaussians that no view sees; knn: majority of near seen Gaussians, background if none is near",
              kUnseenRuleNames});
    visit(self.min_component,
          Field<int>{"min_component", "Gaussians",
                     "Move smaller connected components of the object to the background; 0: keep all", 0, 1 << 30});
  }
};

/// A Gaussian is object if score > cut, or score >= cut if `inclusive`.
struct ExtractRule {
  double cut = 0.5;
  bool inclusive = true;
  bool on_prob = false;
};
/// Throws kUsage for an unknown rule or a value out of range.
ExtractRule parse_extract_rule(const std::string& rule);

struct ExtractInput {
  const GaussianCloud& cloud;
  const LabelColumns& labels;         // has label or prob; without `views` every Gaussian counts as seen
  std::span<const float> fixed = {};  // [N] 1: label is final; empty: none
};

struct Extraction {
  std::vector<std::uint8_t> object;  // [N] 1: object; unusable Gaussians are background
  std::int64_t objects = 0, unusable = 0, unseen = 0, unseen_to_object = 0, fixed = 0;
  std::int64_t components = 0, removed_components = 0, removed = 0;  // counted if min_component > 0
};

/// Throws kBadInput without both ngs_label and ngs_prob.
Extraction extract_object(const Exec& exec, const ExtractOptions& options, const ExtractInput& input);

/// Connected components of the Gaussians with member[i] != 0: component numbers in order of their first row, -1
/// elsewhere. Two nearest neighbours are connected if their distance is at most 3 (σ_i + σ_j), σ the largest scale,
/// or at most three times the median distance to the nearest neighbour.
std::vector<std::int32_t> connected_components(const Exec& exec, const GaussianCloud& cloud,
                                               const std::vector<std::uint8_t>& member, int neighbours);

}  // namespace ngs
