// The language of the tree (style.md, "Names and comments"): no banned word, and no thing that acts like a person.
#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/source_tree.h"

namespace ngs {
namespace {

using test::SourceFile;

constexpr std::size_t kMaxPhraseWords = 4;  // words

const char* const kThings[] = {"mask",  "masks",  "photo", "photos",   "picture",   "pictures",  "view",      "views",
                               "pixel", "pixels", "label", "labels",   "contour",   "contours",  "file",      "files",
                               "scene", "scenes", "model", "models",   "splat",     "splats",    "camera",    "cameras",
                               "point", "points", "row",   "rows",     "column",    "columns",   "stroke",    "strokes",
                               "pass",  "passes", "vote",  "gaussian", "gaussians", "heuristic", "heuristics"};
const char* const kActsOfPersons[] = {"says",  "say",  "said",   "asks",   "ask",    "asked",
                                      "knows", "know", "knew",   "claims", "claim",  "refuse",
                                      "tells", "told", "doubts", "wants",  "thinks", "believes"};

std::string lower(std::string word) {
  std::ranges::transform(word, word.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return word;
}

bool is_identifier(const std::string& word) {
  return word.find('_') != std::string::npos ||
         std::ranges::any_of(word, [](unsigned char c) { return std::isupper(c); });
}

struct Banned {
  std::set<std::string> identifiers, phrases;  // phrases: lower case, words separated by one blank

  explicit Banned(const std::string& list) {
    std::istringstream lines(list);
    for (std::string line; std::getline(lines, line);)
      if (!line.empty() && line[0] != '#') (is_identifier(line) ? identifiers : phrases).insert(line);
    for (const char* thing : kThings)
      for (const char* act : kActsOfPersons) phrases.insert(std::string(thing) + " " + act);
  }
};

/// Runs of letters, digits, underscores and apostrophes; `ends_clause`: punctuation follows.
struct Word {
  std::string text;
  bool ends_clause;
};
std::vector<Word> words_of(const std::string& line) {
  std::vector<Word> words;
  const auto in_word = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '\''; };
  for (std::size_t i = 0; i < line.size();) {
    if (!in_word((unsigned char)line[i])) {
      if (!words.empty() && line[i] != ' ') words.back().ends_clause = true;
      ++i;
      continue;
    }
    const std::size_t begin = i;
    while (i < line.size() && in_word((unsigned char)line[i])) ++i;
    words.push_back({line.substr(begin, i - begin), false});
  }
  return words;
}

std::vector<std::string> offences(const Banned& banned, const std::string& line) {
  std::vector<std::string> found;
  const std::vector<Word> words = words_of(line);
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (banned.identifiers.count(words[i].text) > 0) found.push_back(words[i].text);
    std::string phrase;
    for (std::size_t n = 0; n < kMaxPhraseWords && i + n < words.size(); ++n) {
      phrase += (n > 0 ? " " : "") + lower(words[i + n].text);
      if (banned.phrases.count(phrase) > 0) found.push_back(phrase);
      if (words[i + n].ends_clause) break;
    }
  }
  return found;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Files in which people read words. Decisions keep the words of their time.
std::vector<SourceFile> readable_files() {
  std::vector<SourceFile> files =
      test::source_files({"libngs", "tools", "tests", "pipelines", "docs", "data-schema"},
                         {".h", ".cpp", ".cu", ".cuh", ".md", ".sh", ".mk", ".js", ".html"});
  for (const char* page : {"README.md", "CHANGELOG.md", "BENCHMARKS.md"}) files.push_back(test::source_file(page));
  std::erase_if(files, [](const SourceFile& f) {
    return f.path.ends_with("tests/meta/words_test.cpp") || f.in("docs/decisions");
  });
  return files;
}

/// The words of a comment line; empty for a line of code. Slashes are skipped.
std::vector<std::string> comment_words(const std::string& line) {
  std::istringstream words(line);
  std::vector<std::string> all;
  for (std::string word; words >> word;) all.push_back(word);
  if (all.empty() || (all[0] != "//" && all[0] != "///")) return {};
  return {all.begin() + 1, all.end()};
}

/// Line numbers where the formatter has reflowed a table: a single word in the middle of a sentence, below a full line
/// and above another comment line.
std::vector<std::size_t> reflowed(const std::vector<std::string>& lines) {
  constexpr std::size_t kFullLine = 100;
  std::vector<std::size_t> found;
  for (std::size_t i = 1; i + 1 < lines.size(); ++i) {
    const std::vector<std::string> words = comment_words(lines[i]);
    if (words.size() == 1 && std::string(".:;!?)").find(words[0].back()) == std::string::npos &&
        !comment_words(lines[i - 1]).empty() && lines[i - 1].size() > kFullLine && !comment_words(lines[i + 1]).empty())
      found.push_back(i + 1);
  }
  return found;
}

}  // namespace

TEST_CASE("names, comments, help, pages and test names contain no banned word") {
  const Banned banned(test::source_file("tests/meta/banned_words.txt").text);
  CHECK(banned.identifiers.size() > 20);
  CHECK(banned.phrases.size() > 300);
  std::vector<std::string> all;
  for (const SourceFile& file : readable_files()) {
    const std::vector<std::string> lines = lines_of(file.text);
    for (std::size_t i = 0; i < lines.size(); ++i)
      for (const std::string& word : offences(banned, lines[i]))
        all.push_back(file.path + ":" + std::to_string(i + 1) + ": '" + word + "'");
  }
  CHECK(test::listed(all) == "");
}

TEST_CASE("the search for banned words finds them across case, and not across the end of a clause") {
  const Banned banned("nobody\nas they come\ntwo_cut\n");
  CHECK(offences(banned, "// The labels As they come.").size() == 1);
  CHECK(offences(banned, "float two_cut = 0;").size() == 1);
  CHECK(offences(banned, "float two_cuts = 0;").empty());
  CHECK(offences(banned, "A mask says where").size() == 1);
  CHECK(offences(banned, "of a mask; say where").empty());
  CHECK(offences(banned, "masks say what Nobody knows").size() == 2);
}

TEST_CASE("no table in a comment was reflowed by the formatter") {
  std::vector<std::string> all;
  for (const SourceFile& file : test::source_files({"libngs", "tools", "tests"}, {".h", ".cpp", ".cu", ".cuh"}))
    for (const std::size_t line : reflowed(lines_of(file.text)))
      all.push_back(file.path + ":" + std::to_string(line) + ": put the table between // clang-format off and on");
  CHECK(test::listed(all) == "");

  const std::string full = "//   strict      " + std::string(90, 'x');
  CHECK(reflowed({full, "//   all", "//               float"}) == std::vector<std::size_t>{2});
  CHECK(reflowed({full, "//   all.", "//               float"}).empty());
  CHECK(reflowed({full, "//   all", "int x;"}).empty());
}

}  // namespace ngs
