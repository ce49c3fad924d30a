#pragma once
// Effects: passes, and parts of passes, that can be on, off, or decided by the scene.                     paper.md §5.7
//
// An Effect describes one of them for --help, --explain, the report, --effects-from and the decision. Its heuristic
// measures one number, cheaply, on data that is already loaded. An effect that is off costs no work.
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ngs {

class SceneProbe;
struct Problem;

/// One number measured on the scene. The effect is on if the number exceeds the threshold.
struct Heuristic {
  std::string_view measured;  // the measured quantity, with its unit
  double threshold = 0;
  std::string_view why;  // why the threshold has this value
  std::function<double(SceneProbe&)> measure;
  /// False: the number cannot exceed the threshold, and is not measured. Must not load images. Null: always true.
  bool (*possible)(const Problem&) = nullptr;
  std::string_view impossible = {};  // why the effect is off if possible() is false
};

/// Effects of one pass that other passes or ngs-joint depend on.
inline constexpr std::string_view kJointEffect = "joint", kContoursEffect = "contours", kNerfEffect = "nerf";

struct Effect {
  std::string_view name, help;
  std::string_view saves = {};   // work that is skipped if the effect is off
  std::string_view needs = {};   // effect that must be on for this one to be on
  std::string_view always = {};  // why the effect is on for every scene; empty: the heuristic decides
  Heuristic heuristic = {};
  bool skipped_with_budget = false;  // off under any time budget: it gains the least per second
};

/// Number of views on which a heuristic is measured if it does not need all views.
inline constexpr std::size_t kDecisionViews = 8;

enum class Switch : std::uint8_t { kAuto, kOn, kOff };

/// Null: no effect has that name.
const Effect* find_effect(std::span<const Effect> effects, std::string_view name);

class EffectSwitches {
 public:
  EffectSwitches() = default;
  /// Entries have the form "NAME=auto|on|off"; NAME may be "all". The last entry for an effect wins. An effect that is
  /// switched on by name switches on the effects that it needs. kUsage for a malformed entry or if that is off by name.
  EffectSwitches(std::span<const Effect> effects, const std::vector<std::string>& entries);

  Switch of(std::string_view name) const;

 private:
  struct Entry {
    std::string_view name;
    Switch mode;
    bool by_name;  // not by "all"
  };
  Entry* find(std::string_view name);
  void set(std::string_view name, Switch mode, bool by_name);
  void read(std::span<const Effect> effects, const std::string& entry);
  void require(std::span<const Effect> effects, const Effect& effect);

  std::vector<Entry> entries_;
};

/// "MEASURED: 0.12 <= 0.5".
std::string decision_reason(const Heuristic& heuristic, double measured);

}  // namespace ngs
