#include "ngs/options/near_matches.h"

#include <algorithm>

namespace ngs {

int edit_distance(std::string_view a, std::string_view b) {
  const std::size_t columns = b.size() + 1;
  std::vector<int> cost((a.size() + 1) * columns);
  for (std::size_t j = 0; j < columns; ++j) cost[j] = int(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int* row = cost.data() + i * columns;
    row[0] = int(i);
    for (std::size_t j = 1; j < columns; ++j) {
      const int* above = row - columns;
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], (above - columns)[j - 2] + 1);
    }
  }
  return cost.back();
}

std::vector<std::string> near_matches(std::string_view name, const std::vector<std::string>& candidates) {
  struct Match {
    int distance;
    std::size_t index;
  };
  std::vector<Match> matches;
  const int allowed = std::max(name.size() > 2 ? 1 : 0, int(name.size()) / 3);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const std::string_view candidate = candidates[i];
    const bool begins = name.size() >= 4 && candidate.substr(0, name.size()) == name;
    const int distance = edit_distance(name, candidate);
    if (distance <= allowed || begins) matches.push_back({begins ? 0 : distance, i});
  }
  std::stable_sort(matches.begin(), matches.end(),
                   [](const Match& a, const Match& b) { return a.distance < b.distance; });
  if (matches.size() > 3) matches.resize(3);
  std::vector<std::string> names;
  for (const Match& match : matches) names.push_back(candidates[match.index]);
  return names;
}

std::string suggestion(std::string_view name, const std::vector<std::string>& candidates) {
  const std::vector<std::string> near = near_matches(name, candidates);
  std::string text = near.empty() ? "known: " : "did you mean ";
  const std::vector<std::string>& listed = near.empty() ? candidates : near;
  for (std::size_t i = 0; i < listed.size(); ++i) {
    if (i > 0) text += near.empty() ? ", " : (i + 1 == listed.size() ? " or " : ", ");
    text += near.empty() ? listed[i] : "'" + listed[i] + "'";
  }
  return near.empty() ? text : text + "?";
}

}  // namespace ngs
