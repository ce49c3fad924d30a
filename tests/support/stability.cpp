#include "support/stability.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "support/end_listener.h"

namespace ngs::test {
namespace {

std::vector<HardResult>& results() {
  static std::vector<HardResult> all;
  return all;
}

constexpr std::int64_t kDraws = 1000;

std::int64_t draws_wanted() {
  const char* text = std::getenv("NGS_STABILITY_SEEDS");
  const std::int64_t wanted = text ? std::atoll(text) : kDraws;
  return wanted > 0 ? wanted : 1;
}

std::string shown(double ratio) {
  char text[32];
  std::snprintf(text, sizeof text, std::isfinite(ratio) ? "%.3g" : "wrong", ratio);
  return text;
}

/// JSON has no infinities.
nlohmann::json json_number(double x) {
  if (std::isfinite(x)) return x;
  if (std::isnan(x)) return "nan";
  return x < 0 ? "-inf" : "inf";
}

void print_table() {
  std::printf("%-14s %-86s %9s %9s %9s %9s %7s %9s\n", "kernel", "case", "hardest", "worst", "budget", "textbook",
              "draws", "values");
  int failed = 0;
  std::int64_t values = 0;
  for (const HardResult& r : results()) {
    std::printf("%-14s %-86s %9.3g %9s %9.3g %9s %7lld %9lld%s\n", r.kernel.c_str(), r.name.c_str(),
                r.hard.values.back(), shown(r.worst()).c_str(), r.hard.budget,
                r.has_naive() ? shown(r.naive_worst()).c_str() : "-", static_cast<long long>(r.draws),
                static_cast<long long>(r.values()), r.passed() ? "" : "  FAILED");
    failed += !r.passed();
    values += r.values();
  }
  std::printf("stability cases: %zu, %d failed, %lld values compared\n", results().size(), failed,
              static_cast<long long>(values));
}

void write_file(const std::string& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  if (!out.flush()) std::fprintf(stderr, "cannot write %s\n", path.c_str());
}

/// Prints the table and writes the files after all cases.
struct TableWriter : EndListener {
  explicit TableWriter(const doctest::ContextOptions&) {}
  void test_run_end(const doctest::TestRunStats&) override {
    if (results().empty()) return;
    print_table();
    const char* folder = std::getenv("NGS_STABILITY_DIR");
    if (folder == nullptr) return;
    write_file(std::string(folder) + "/stability.json", stability_document(results()).dump(1) + "\n");
  }
};
REGISTER_LISTENER("stability", 1, TableWriter);

}  // namespace

double HardResult::worst() const {
  double worst = 0;
  for (const Worst& at : sweep) worst = std::max(worst, at.ours());
  return worst;
}
double HardResult::naive_worst() const {
  double worst = 0;
  for (const Worst& at : sweep) worst = std::max(worst, at.naive());
  return worst;
}
std::int64_t HardResult::values() const {
  std::int64_t sum = 0;
  for (const Worst& at : sweep) sum += at.values();
  return sum;
}
double HardResult::naive_best() const {
  double best = kWrong;
  for (const Worst& at : sweep)
    if (at.naive_values() > 0) best = std::min(best, at.naive());
  return best;
}
bool HardResult::naive_fails() const { return naive_worst() > hard.budget && naive_worst() >= hard.naive.at_least; }
bool HardResult::naive_passes_easy_values() const {
  return naive_best() < kWrong && naive_best() <= std::max(hard.budget, naive_worst() / 10);
}
bool HardResult::passed() const {
  return worst() <= hard.budget && (!has_naive() || (naive_fails() && naive_passes_easy_values()));
}

const std::vector<HardResult>& hard_results() { return results(); }

void hard_case(const HardCase& hard, const HardBody& body) {
  const std::string full = doctest::getContextOptions()->currentTest->m_name;
  const std::size_t colon = full.find(": ");
  REQUIRE(colon != std::string::npos);
  HardResult result;
  result.kernel = full.substr(0, colon);
  result.name = full.substr(colon + 2);
  result.hard = hard;
  result.draws = std::max<std::int64_t>(1, draws_wanted() / hard.cost);
  if (draws_wanted() < kDraws) result.hard.naive.at_least = 0;  // fewer draws may miss the worst case
  std::uint64_t seed = 1;
  for (const char c : full) seed = seed * 31 + std::uint64_t(static_cast<unsigned char>(c));
  for (std::size_t v = 0; v < hard.values.size(); ++v) {
    Random random(seed + v);
    Worst worst;
    for (std::int64_t draw = 0; draw < result.draws; ++draw) body(hard.values[v], random, worst);
    result.sweep.push_back(worst);
    INFO(hard.axis << " = " << hard.values[v]);
    CHECK(worst.ours() <= hard.budget);
  }
  INFO("the textbook form: " << hard.naive.form << "; its ratios reach from " << result.naive_best() << " to "
                             << result.naive_worst());
  if (result.has_naive()) CHECK(result.naive_fails());
  if (result.has_naive()) CHECK(result.naive_passes_easy_values());
  results().push_back(std::move(result));
}

nlohmann::json stability_document(const std::vector<HardResult>& all) {
  nlohmann::json cases = nlohmann::json::array();
  for (const HardResult& r : all) {
    nlohmann::json sweep = nlohmann::json::array();
    for (std::size_t v = 0; v < r.sweep.size(); ++v)
      sweep.push_back({{"hardness", json_number(r.hard.values[v])},
                       {"ratio", json_number(r.sweep[v].ours())},
                       {"textbook_ratio", r.has_naive() ? json_number(r.sweep[v].naive()) : nullptr}});
    cases.push_back({{"kernel", r.kernel},
                     {"case", r.name},
                     {"axis", r.hard.axis},
                     {"budget", r.hard.budget},
                     {"textbook", r.hard.naive.form},
                     {"draws", r.draws},
                     {"values", r.values()},
                     {"sweep", sweep},
                     {"passed", r.passed()}});
  }
  return {{"format", "ngs-stability"}, {"version", 1}, {"cases", cases}};
}

}  // namespace ngs::test
