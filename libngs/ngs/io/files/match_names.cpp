#include "ngs/io/files/match_names.h"

#include <algorithm>
#include <array>
#include <map>

#include "ngs/core/error.h"
#include "ngs/core/folded_name.h"
#include "ngs/scene/view_names.h"

namespace ngs::io {
namespace {

using namespace std::string_view_literals;

bool digit(char c) { return c >= '0' && c <= '9'; }

std::string folder_of(std::string_view name) {
  const std::size_t slash = name.rfind('/');
  return slash == std::string_view::npos ? std::string() : std::string(name.substr(0, slash + 1));
}

std::string affix_key(std::string_view name) {
  const std::string folder = lower_case(folder_of(name));
  std::string base = lower_case(name.substr(folder.size()));
  while (image_stem(base) != base) base = image_stem(base);
  constexpr std::array kPrefixes = {"mask"sv, "gt"sv, "pred"sv, "frame"sv};
  constexpr std::array kSuffixes = {"mask"sv, "gt"sv, "pred"sv, "label"sv, "seg"sv, "object"sv, "rgb"sv};
  const auto joins = [](char c) { return c == '_' || c == '-' || c == '.'; };
  for (bool changed = true; changed;) {
    changed = false;
    for (std::string_view prefix : kPrefixes)
      if (base.size() > prefix.size() + 1 && base.starts_with(prefix) && joins(base[prefix.size()])) {
        base.erase(0, prefix.size() + 1);
        changed = true;
      }
    for (std::string_view suffix : kSuffixes)
      if (base.size() > suffix.size() + 1 && base.ends_with(suffix) && joins(base[base.size() - suffix.size() - 1])) {
        base.resize(base.size() - suffix.size() - 1);
        changed = true;
      }
  }
  return folder + base;
}

std::string number_key(std::string_view name) {
  const std::string key = affix_key(name), folder = folder_of(key);
  std::size_t end = key.size();
  while (end > folder.size() && !digit(key[end - 1])) --end;
  std::size_t begin = end;
  while (begin > folder.size() && digit(key[begin - 1])) --begin;
  if (begin == end) return {};
  while (begin + 1 < end && key[begin] == '0') ++begin;
  return folder + "#" + key.substr(begin, end - begin);
}

struct Rule {
  std::string_view name;
  std::string (*key)(std::string_view);
};
constexpr std::array<Rule, 3> kRules = {{{"stem", image_stem}, {"affix", affix_key}, {"number", number_key}}};

constexpr std::size_t kAmbiguous = std::size_t(-1);

/// key -> index; kAmbiguous if several unpaired names share the key. Names with an empty key are skipped.
std::map<std::string, std::size_t> keys_of(std::span<const std::string> names, const std::vector<std::size_t>& open,
                                           const Rule& rule) {
  std::map<std::string, std::size_t> keys;
  for (std::size_t i : open) {
    std::string key = rule.key(names[i]);
    if (key.empty()) continue;
    const auto [entry, added] = keys.emplace(std::move(key), i);
    if (!added) entry->second = kAmbiguous;
  }
  return keys;
}

void require_unique_stems(std::span<const std::string> names) {
  std::map<std::string, std::string_view> seen;
  for (const std::string& name : names) {
    const auto [entry, added] = seen.emplace(image_stem(name), name);
    if (!added)
      throw Error(ErrorCode::kInconsistent,
                  "masks: '" + std::string(entry->second) + "' and '" + name +
                      "' have the same stem, expected one file per view",
                  "move one of them out of the folder");
  }
}

}  // namespace

NameMatch match_names(std::span<const std::string> predicted, std::span<const std::string> truth) {
  require_unique_stems(predicted);
  require_unique_stems(truth);
  NameMatch match;
  for (std::size_t i = 0; i < predicted.size(); ++i) match.unmatched_predicted.push_back(i);
  for (std::size_t i = 0; i < truth.size(); ++i) match.unmatched_truth.push_back(i);
  for (const Rule& rule : kRules) {
    const auto p = keys_of(predicted, match.unmatched_predicted, rule);
    for (const auto& [key, t] : keys_of(truth, match.unmatched_truth, rule)) {
      const auto found = p.find(key);
      if (t == kAmbiguous || found == p.end() || found->second == kAmbiguous) continue;
      match.pairs.push_back({found->second, t, rule.name});
      std::erase(match.unmatched_predicted, found->second);
      std::erase(match.unmatched_truth, t);
    }
  }
  std::sort(match.pairs.begin(), match.pairs.end(),
            [&](const NamePair& a, const NamePair& b) { return truth[a.truth] < truth[b.truth]; });
  return match;
}

}  // namespace ngs::io
