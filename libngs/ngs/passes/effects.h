#pragma once
// The parts of the method, each of which can be on, off, or decided by what the scene calls for. PAPER.md
// §5.7
//
// One row of effect_registry() is all there is to say about an effect; --help, --explain, the report,
// --effects-from and the decision itself read it. A detector gives one number, cheap to measure on what is
// loaded already; the effect is on where that number lies beyond the threshold. Off means that the work is
// not done. What `auto` leaves out changes rendered masks by at most kEffectBound
// (tests/unit/passes/effects_test.cpp has, for each effect, a scene that needs it and one that does not).
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ngs {

/// Which parts are on: --effect NAME=auto|on|off. Switching one off alone is the ablation.
struct JointEffects {
  bool exposure = true, mask_outliers = true, floaters = true, components = true;  // before the steps
  bool joint = true;                        // the steps themselves
  bool nerf = true, boundary = true, box = true, rbf = true, hash = true, fine_hash = true, film = true;
  bool align = true, variance = true, density = true, mask = true, cont = true, smooth = true;
  bool photometric = true, region = true, sh = true, antialias = true;
  bool geometry = true, mask_geometry = true;
  bool edges = true, split = true, contour_iterations_on = true, full_resolution = true;  // after the steps
};

class EffectProbe;

/// When it is decided: on what was read, or on what mask-outliers and floaters left of it.
enum class EffectPhase : std::uint8_t { kBefore, kSteps };
enum class OnWhere : std::uint8_t { kAlways, kAbove, kBelow };

struct EffectInfo {
  std::string_view name, help;
  bool JointEffects::*member;
  std::string_view saves;       // what is not done when it is off
  std::string_view needs = {};  // an effect without which this one has nothing to do
  OnWhere on = OnWhere::kAlways;
  std::string_view measured = {};  // what the detector measures, with its unit
  double threshold = 0;
  std::string_view why = {};  // that threshold, or why it is always on
  double (EffectProbe::*measure)() = nullptr;
  EffectPhase phase = EffectPhase::kSteps;
};

std::span<const EffectInfo> effect_registry();
/// Null: there is none of that name.
const EffectInfo* find_effect(std::string_view name);

/// Whether an effect is `whole`, or has nothing to do without it.
bool belongs_to(std::string_view name, std::string_view whole);

/// Mean change of the rendered mask values, in [0, 1], that an effect may cause where `auto` leaves it out.
inline constexpr double kEffectBound = 0.005;

/// Views that a decision looks at where it need not see all.
inline constexpr std::size_t kDecisionViews = 8;

/// Finest useful cell of the encoding, in spacings of the boundary: two cells to a spacing.
inline constexpr double kFinestCell = 0.5;

enum class EffectMode : std::uint8_t { kAuto, kOn, kOff };

/// The last of the "NAME=auto|on|off" entries that names each effect; NAME may be "all". Effects that no
/// entry names are not in the map. kUsage for anything else.
std::map<std::string_view, EffectMode> effect_modes(const std::vector<std::string>& entries);

EffectMode mode_of(std::string_view name, const std::vector<std::string>& entries);

/// Those entries over all on, where auto means on: for who has no scene to decide on.
JointEffects parse_effects(const std::vector<std::string>& entries);

struct EffectDecision {
  const EffectInfo* effect;
  std::string mode;  // auto, on, off, or where the decision was taken over from
  bool on;
  std::string reason;
  std::optional<double> measured;
};

/// "MEASURED: 0.12 <= 0.5".
std::string decision_reason(const EffectInfo& effect, double measured, bool on);
/// "auto: sh=off (view-dependent colour 0.12 <= 0.5 levels), saves ...".
std::string decision_line(const EffectDecision& decision);

}  // namespace ngs
