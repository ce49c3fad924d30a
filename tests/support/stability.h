#pragma once
// Hard cases: a doctest case sweeps one hardness parameter, draws many random inputs at each value, and records the
// worst LAPACK-style ratio (support/ratio.h) of ngs and of the textbook form in float. The ratio of ngs must stay
// within the pinned budget at every value. The textbook form must exceed the budget at some value and reach the pinned
// size of its error; at some other value it must be within the budget, or ten times closer: a form that fails
// everywhere does not compute the same quantity.
//
//   HARD_CASE("elementary: 1 - e^-x keeps its relative accuracy for small x", "x", {1, 1e-3, 1e-12}, 1.0,
//             {"1 - exp(-x)", 4e6}) {
//     ...  // the hardness is h
//     worst.ours(got, want);
//     worst.naive(naive, want);
//   }
//
// The kernel of a case is its name up to the colon. Environment: NGS_STABILITY_SEEDS (default 1000) random inputs per
// hardness value; NGS_STABILITY_DIR: folder for stability.json.
#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/random.h"
#include "support/ratio.h"

namespace ngs::test {

/// The ratio recorded for NaN, Inf or a wrong answer in a degenerate case.
inline constexpr double kWrong = std::numeric_limits<double>::infinity();

/// The worst ratios at one hardness value.
class Worst {
 public:
  /// |got - want| / (eps(T) · condition · |want|).
  template <class T>
  void ours(T got, long double want, long double condition = 1) {
    ours_ratio(ratio(got, double(want), double(condition)));
  }
  template <class T>
  void naive(T got, long double want, long double condition = 1) {
    naive_ratio(ratio(got, double(want), double(condition)));
  }
  /// A ratio computed by the case itself; NaN counts as wrong.
  void ours_ratio(double r) {
    ours_ = r >= 0 ? std::max(ours_, r) : kWrong;
    ++values_;
  }
  void naive_ratio(double r) {
    naive_ = r >= 0 ? std::max(naive_, r) : kWrong;
    ++naive_values_;
  }
  /// A degenerate case with a defined answer: right or wrong.
  void ours_is(bool right) { ours_ratio(right ? 0 : kWrong); }
  void naive_is(bool right) { naive_ratio(right ? 0 : kWrong); }

  double ours() const { return ours_; }
  double naive() const { return naive_; }
  std::int64_t values() const { return values_; }
  std::int64_t naive_values() const { return naive_values_; }

 private:
  double ours_ = 0, naive_ = 0;
  std::int64_t values_ = 0, naive_values_ = 0;  // number of values compared
};

/// The form printed in a textbook or in the paper, in float unless stated otherwise.
struct Textbook {
  std::string form;     // or "not applicable: why"
  double at_least = 0;  // lower bound of its worst ratio: half the measured one; kWrong: wrong answer or NaN
  Textbook(std::string form, double at_least = 0) : form(std::move(form)), at_least(at_least) {}
  Textbook(const char* form, double at_least = 0) : form(form), at_least(at_least) {}
};

struct HardCase {
  std::string axis;            // the hardness parameter
  std::vector<double> values;  // from easy to hard
  double budget;               // upper bound of the ratio: 1.5 to 2 times the measured worst; 0: exact
  Textbook naive = "";
  int cost = 1;  // divides the number of draws
};

/// Runs a case and checks it; call it once per TEST_CASE.
using HardBody = std::function<void(double hardness, Random& random, Worst& worst)>;
void hard_case(const HardCase& hard, const HardBody& body);

// A test case named `name` of the HardCase {...}; its body follows and sees h, the hardness, `random` and `worst`.
#define NGS_HARD_CASE(body, name, ...)                                                \
  static void body(double h, ::ngs::test::Random& random, ::ngs::test::Worst& worst); \
  TEST_CASE(name) { ::ngs::test::hard_case({__VA_ARGS__}, body); }                    \
  static void body([[maybe_unused]] double h, [[maybe_unused]] ::ngs::test::Random& random, ::ngs::test::Worst& worst)
#define HARD_CASE(name, ...) NGS_HARD_CASE(DOCTEST_ANONYMOUS(hard_body_), name, __VA_ARGS__)

/// Measurements of one case.
struct HardResult {
  std::string kernel, name;
  HardCase hard;
  std::int64_t draws = 0;    // random inputs per hardness value
  std::vector<Worst> sweep;  // per hardness value
  bool has_naive() const { return hard.naive.form.rfind("not applicable", 0) != 0; }
  double worst() const;
  double naive_worst() const;
  double naive_best() const;    // minimum over the hardness values; kWrong if never computed
  std::int64_t values() const;  // number of values compared
  bool naive_fails() const;     // exceeds the budget and the pinned lower bound
  bool naive_passes_easy_values() const;
  bool passed() const;
};
/// All cases that have run.
const std::vector<HardResult>& hard_results();

/// data-schema/stability.schema.json
nlohmann::json stability_document(const std::vector<HardResult>& results);

}  // namespace ngs::test
