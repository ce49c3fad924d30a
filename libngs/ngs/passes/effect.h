#pragma once
// What of the method can be on, off, or decided by what the scene calls for: passes, and parts of passes. PAPER.md §5.7
//
// An Effect is all there is to say about one of them; --help, --explain, the report, --effects-from and the decision
// itself read it. Its detector gives one number, cheap to measure on what is loaded already. Off means that the work is
// not done.
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ngs {

class SceneProbe;
struct Problem;

/// One number of the scene; the effect is on where it lies above the threshold.
struct Heuristic {
  std::string_view measured;  // what is measured, with its unit
  double threshold = 0;
  std::string_view why;  // that threshold
  std::function<double(SceneProbe&)> measure;
  /// Whether it can lie above the threshold, known without a look at pictures; empty: it may.
  bool (*possible)(const Problem&) = nullptr;
  std::string_view impossible = {};  // why it is off where it cannot; nothing is measured then
};

struct Effect {
  std::string_view name, help;
  std::string_view saves = {};   // what is not done where it is off
  std::string_view needs = {};   // an effect without which this one has nothing to do
  std::string_view always = {};  // why it is on whatever the scene; empty: the detector decides
  Heuristic detector = {};
};

/// Mean change of the rendered mask values, in [0, 1], that an effect may cause where `auto` leaves it out.
inline constexpr double kEffectBound = 0.005;

/// Views that a decision looks at where it need not see all.
inline constexpr std::size_t kDecisionViews = 8;

enum class Switch : std::uint8_t { kAuto, kOn, kOff };

/// Null: there is none of that name.
const Effect* find_effect(std::span<const Effect> effects, std::string_view name);

/// What --effect asks for.
class EffectSwitches {
 public:
  EffectSwitches() = default;
  /// "NAME=auto|on|off" entries, of which the last that names an effect counts; NAME may be "all". An effect that is on
  /// by its own name switches on what it needs. kUsage for anything else, and where what it needs is off by its own
  /// name.
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
std::string decision_reason(const Heuristic& detector, double measured);

}  // namespace ngs
