#pragma once
// The rule by which evidence becomes labels and a boundary set (Eq. 3; C1, C2). boundary.ply records it in its header,
// so that later stages apply the same rule to new evidence.
#include <array>
#include <cstdint>
#include <string_view>

namespace ngs {

enum class Criterion : std::uint8_t { kPooled, kBetweenViews, kRelativeDiff };
/// Names in the order of the enum.
inline constexpr std::array<std::string_view, 3> kCriterionNames{"pooled", "between-views", "relative-diff"};

struct BoundaryRule {
  double tau = 0.6;                          // [0, 1): boundary where the normalised variance exceeds it
  Criterion criterion = Criterion::kPooled;  // what the variance is taken over
  double label_threshold = 0.5;              // one object: label 1 where prob exceeds it
  bool exclusive = true;                     // several objects: a Gaussian belongs to at most one, the heaviest

  bool operator==(const BoundaryRule&) const = default;
};

}  // namespace ngs
