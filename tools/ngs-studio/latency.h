#pragma once
// How long answers took.
#include <nlohmann/json.hpp>
#include <vector>

namespace ngs::studio {

/// Times of one kind of answer.
struct Latencies {
  std::vector<double> ms;

  /// {"n", "median_ms", "p95_ms"}; null times where there are none.
  nlohmann::ordered_json json() const;
};

}  // namespace ngs::studio
