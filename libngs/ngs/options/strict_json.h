#pragma once
// The one parser setting for all JSON that ngs reads.
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/core/error.h"

namespace ngs {

/// Deepest nesting of arrays and objects. Values are printed by recursive functions, so a file without this limit could
/// overflow the stack. Files of ngs have fewer than ten levels.
inline constexpr int kMaxJsonDepth = 64;

/// Parses `text` as JsonType (nlohmann's json or ordered_json). Error(code) for text that is not one JSON value, a key
/// that occurs twice in one object, or more than kMaxJsonDepth levels. `source` names the text in messages.
template <class JsonType>
JsonType parse_strict_json(std::string_view text, std::string_view source, ErrorCode code) {
  using Event = typename JsonType::parse_event_t;
  std::vector<std::set<std::string>> open_objects;  // the keys seen so far, outermost object first
  const auto check_event = [&](int depth, Event event, JsonType& parsed) {
    if ((event == Event::object_start || event == Event::array_start) && depth >= kMaxJsonDepth)
      throw Error(code,
                  std::string(source) + ": more than " + std::to_string(kMaxJsonDepth) +
                      " levels of arrays and objects, expected at most that many",
                  "no file of ngs is nested like that: write it again with the tool that made it");
    if (event == Event::object_start) open_objects.emplace_back();
    if (event == Event::object_end) open_objects.pop_back();
    if (event == Event::key && !open_objects.back().insert(parsed.template get<std::string>()).second)
      throw Error(
          code, std::string(source) + ": key '" + parsed.template get<std::string>() + "' occurs twice, expected once");
    return true;
  };
  try {
    return JsonType::parse(text.begin(), text.end(), check_event);
  } catch (const typename JsonType::exception& e) {
    const std::string_view what = e.what();
    const std::size_t begin = what.find("] ");  // behind "[json.exception.parse_error.101"
    throw Error(code, std::string(source) + ": not JSON: " +
                          std::string(what.substr(begin == what.npos ? 0 : begin + 2)) + ", expected one JSON value");
  }
}

}  // namespace ngs
