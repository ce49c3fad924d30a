#pragma once
// How well a solution's rendered masks agree with the training views' own masks.
#include <optional>
#include <string>
#include <vector>

#include "ngs/problem/problem.h"

namespace ngs {

/// Of one view, mean over the objects; boundary IoU with the narrow band (0.005 of the diagonal).
struct Agreement {
  double iou = 0, biou = 0;
};

/// Of every training view with masks.
std::vector<Agreement> training_agreement(const Exec& exec, const Problem& problem, const Solution& solution);
Agreement mean_agreement(const std::vector<Agreement>& views);

struct AgreementTarget {
  bool boundary;  // biou, else iou
  double value;   // in [0, 1]
};
/// "biou=0.9" or "iou=0.95"; empty: none. kUsage otherwise.
std::optional<AgreementTarget> parse_target(const std::string& text);

}  // namespace ngs
