// Results and their tables, for tests/bench/results.sh; writes to stdout.
//
//   ngs_results collect                          lines of a question on stdin -> JSON (collect.h)
//   ngs_results table FILE DEFAULTS              markdown; DEFAULTS is the hash of the tools' current default options
//   ngs_results page PAGE RESULTS_DIR DEFAULTS   the page with all its blocks filled (markers.h)
//   ngs_results help FILE                        the C++ header with the table of --quality
//   ngs_results value FILE KEY SHOW [KEY=VALUE...]      one number, SHOW as in a column
//   ngs_results score METRICS KEY                one number of a metrics.json of ngs-eval (readers.h)
//   ngs_results about FILE                       wall seconds, a tab, the title
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>

#include "collect.h"
#include "markers.h"
#include "ngs/core/error.h"
#include "readers.h"
#include "table.h"

namespace ngs::results {
namespace {

using Words = std::vector<std::string>;

void write_page(const std::string& page, const std::filesystem::path& results, const std::string& defaults) {
  std::cout << with_blocks(read_text(page), [&](const std::string& question) {
    const std::filesystem::path file = results / (question + ".json");
    if (!std::filesystem::exists(file)) return "Not measured yet: `tests/bench/results.sh " + question + "`.\n";
    return markdown_of(read_result(file), defaults);
  });
}

void write_value(const Words& words) {
  std::vector<std::pair<std::string, std::string>> where;
  for (std::size_t i = 3; i < words.size(); ++i) {
    const std::size_t at = words[i].find('=');
    if (at == std::string::npos) throw Error(ErrorCode::kUsage, "'" + words[i] + "', expected KEY=VALUE");
    where.emplace_back(words[i].substr(0, at), words[i].substr(at + 1));
  }
  std::cout.precision(10);
  std::cout << value_of(read_result(words[0]), words[1], show_of(words[2]), where) << "\n";
}

void write_about(const std::string& file) {
  const Result result = read_result(file);
  std::cout << result.seconds << "\t" << result.title << "\n";
}

struct Command {
  std::size_t least_words;
  std::function<void(const Words&)> run;
};

const std::map<std::string, Command>& commands() {
  static const std::map<std::string, Command> all{
      {"collect", {0, [](const Words&) { std::cout << text_of(collect(std::cin)); }}},
      {"table", {2, [](const Words& w) { std::cout << markdown_of(read_result(w[0]), w[1]); }}},
      {"page", {3, [](const Words& w) { write_page(w[0], w[1], w[2]); }}},
      {"help", {1, [](const Words& w) { std::cout << help_header_of(read_result(w[0])); }}},
      {"value", {3, write_value}},
      {"score", {2, [](const Words& w) { std::cout << read_scores(w[0]).at(w[1]) << "\n"; }}},
      {"about", {1, [](const Words& w) { write_about(w[0]); }}}};
  return all;
}

void run(const Words& words) {
  const auto command = words.empty() ? commands().end() : commands().find(words[0]);
  if (command == commands().end() || words.size() - 1 < command->second.least_words)
    throw Error(ErrorCode::kUsage, "expected collect, table, page, help, value or about with their arguments",
                "use tests/bench/results.sh");
  command->second.run(Words(words.begin() + 1, words.end()));
}

}  // namespace
}  // namespace ngs::results

int main(int argc, char** argv) {
  try {
    ngs::results::run({argv + 1, argv + argc});
    return 0;
  } catch (const ngs::Error& e) {
    std::cerr << "error: " << e.what() << "\n";
    if (!e.remedy().empty()) std::cerr << "hint: " << e.remedy() << "\n";
    return int(e.code());
  }
}
