#include "markers.h"

#include <sstream>
#include <string_view>

#include "ngs/core/error.h"

namespace ngs::results {
namespace {

constexpr std::string_view kBegin = "<!-- result: ", kBeginEnd = " -->", kEnd = "<!-- /result -->";

/// The question of a line that begins a block; otherwise empty.
std::string question_of(std::string_view line) {
  if (line.substr(0, kBegin.size()) != kBegin || line.size() < kBegin.size() + kBeginEnd.size()) return "";
  const std::size_t name_size = line.size() - kBegin.size() - kBeginEnd.size();
  if (line.substr(kBegin.size() + name_size) != kBeginEnd) return "";
  return std::string(line.substr(kBegin.size(), name_size));
}

/// Calls `outside(LINE)` for lines outside blocks, including markers, and `block(QUESTION)` after each begin marker.
template <class Outside, class Block>
void for_each_line(const std::string& page, Outside&& outside, Block&& block) {
  std::istringstream lines(page);
  std::string open;
  for (std::string line; std::getline(lines, line);) {
    const std::string question = question_of(line);
    if (!open.empty() && !question.empty())
      throw Error(ErrorCode::kBadInput, "block " + open + ": not closed before block " + question);
    if (open.empty() && line == kEnd) throw Error(ErrorCode::kBadInput, std::string(kEnd) + " closes no block");
    if (line == kEnd) open.clear();
    if (open.empty()) outside(line);
    if (!question.empty()) open = question, block(question);
  }
  if (!open.empty()) throw Error(ErrorCode::kBadInput, "block " + open + ": not closed");
}

}  // namespace

std::vector<std::string> blocks_of(const std::string& page) {
  std::vector<std::string> questions;
  for_each_line(
      page, [](const std::string&) {}, [&](const std::string& q) { questions.push_back(q); });
  return questions;
}

std::string with_blocks(const std::string& page, const std::function<std::string(const std::string&)>& text) {
  std::string filled;
  for_each_line(
      page, [&](const std::string& line) { filled += line + "\n"; }, [&](const std::string& q) { filled += text(q); });
  return filled;
}

std::string without_blocks(const std::string& page) {
  return with_blocks(page, [](const std::string&) { return std::string(); });
}

}  // namespace ngs::results
