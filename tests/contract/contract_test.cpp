// Runs the cases of cases/*.json (see cases/README.md) and of rules.json (support/rule_cases.h) against the built
// tools. Every case also checks the rules that all tools share: an error leaves stdout empty, prints "error" on stderr,
// and leaves no output and no temporary file; a success writes one report that satisfies its own schema; flags named in
// a hint or a warning exist, and complete commands in them are accepted.
#include <doctest/doctest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "support/hinted_flags.h"
#include "support/mutations.h"
#include "support/process.h"
#include "support/rule_cases.h"
#include "support/schema_check.h"
#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using test::ProcessResult;
using test::ProcessSpec;
using Words = std::vector<std::string>;
using test::command, test::fixture_folder, test::resolved, test::words;

/// The error line, else the first line.
std::string error_line(const std::string& err) {
  static const std::regex error("(^|\n)(ngs(-[a-z]+)?( [a-z]+)?: error: [^\n]+)");
  std::smatch match;
  return std::regex_search(err, match, error) ? match[2].str() : err.substr(0, err.find('\n'));
}

Words outputs_of(const Words& argv) {
  static const std::set<std::string> flags = {"-o",         "--output", "--object-ply", "--background-ply",
                                              "--labelled", "--report", "--exr"};
  Words paths;
  for (std::size_t i = 1; i + 1 < argv.size(); ++i)
    if (flags.count(argv[i]) != 0 && argv[i + 1][0] == '/' && argv[i + 1].rfind("/dev/", 0) != 0)
      paths.push_back(argv[i + 1]);
  return paths;
}

Words temporaries_under(const std::string& folder) {
  Words found;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().filename().string().find(".tmp") != std::string::npos) found.push_back(entry.path().string());
  return found;
}

/// The name as the tool, or the command of a tool ("ngs-scene import"), prints it.
const Json& schema_of(const std::string& tool, const char* kind) {
  static std::map<std::string, Json> schemas;
  Json& schema = schemas[tool + " " + kind];
  if (schema.is_null()) {
    Json run = Json::array();
    for (std::size_t begin = 0; begin <= tool.size(); begin = std::min(tool.find(' ', begin), tool.size()) + 1)
      run.push_back(tool.substr(begin, tool.find(' ', begin) - begin));
    run.push_back("--print-schema");
    run.push_back(kind);
    schema = Json::parse(test::run_process(command(run)).out);
  }
  return schema;
}

void check_report(const std::string& text) {
  const Json report = Json::parse(text, nullptr, false);
  REQUIRE_MESSAGE(!report.is_discarded(), "the report is not JSON: ", text);
  const std::string tool = report.value("tool", "ngs-probe");
  const auto options = [&](const std::string& reference) {
    std::string file = "../options/" + tool + ".schema.json";
    std::replace(file.begin(), file.end(), ' ', '-');
    CHECK(reference == file);
    return schema_of(tool, "options");
  };
  CHECK(test::schema_violations(schema_of(tool, "report"), report, options) == "");
}

struct Prepared {
  Json spec;
  std::string tmp;
  std::set<std::string> before;  // outputs that exist before the run
};

void check_failure(const Prepared& prepared, const Words& argv, const ProcessResult& result) {
  if (result.exit_code < 128)
    CHECK(result.out == "");
  else if (!result.out.empty())
    check_report(result.out);  // the body returned by itself
  const Words present = words(prepared.spec.value("present", Json::array()));
  for (const std::string& path : outputs_of(argv))
    if (prepared.before.count(path) == 0 && std::count(present.begin(), present.end(), path) == 0) {
      INFO("a failed run left " << path);
      CHECK((!fs::exists(path) || (fs::is_directory(path) && fs::is_empty(path))));
    }
  if (result.exit_code < 128) CHECK(error_line(result.err).find(": error: ") != std::string::npos);
}

void check_texts(const Json& expected, const std::string& text) {
  for (const Json& part : expected) {
    INFO("expected part: " << part.get<std::string>() << "\nfound: " << text.substr(0, 2000));
    CHECK(text.find(part.get<std::string>()) != text.npos);
  }
}

/// Flags named in a hint must exist.
void check_hints(const std::string& err) {
  for (const test::HintedFlag& hinted : test::hinted_flags(err)) {
    INFO("hint: " << hinted.flag);
    CHECK(test::has_flag(hinted));
  }
}

/// Complete commands in a hint are run in the case's folder, each once per process: their flags must be accepted, and
/// they must succeed if all their inputs exist.
void check_hinted_commands(const std::string& err, const std::string& folder) {
  static std::set<std::string> tried;
  for (const Words& words : test::hinted_commands(err)) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
    static const std::regex of_run("/[^ ]*/ngs-test-[A-Za-z0-9]+");
    if (!tried.insert(std::regex_replace(text, of_run, "...")).second) continue;
    ProcessSpec spec = command(words);
    spec.folder = folder;
    if (words[0] == "ngs-fit") spec.argv.insert(spec.argv.end(), {"--steps", "20"});  // not minutes
    if (words[0] == "ngs" && words[1] == "cut") spec.argv.insert(spec.argv.end(), {"--quality", "draft"});
    const ProcessResult result = test::run_process(spec);
    INFO("hinted command: " << text << "\nstderr: " << result.err.substr(0, 2000));
    CHECK_FALSE(result.timed_out);
    CHECK(result.exit_code != 2);
    if (test::has_its_inputs(words, folder)) CHECK(result.exit_code == 0);
  }
}

void check_lacks(const Json& parts, const std::string& text) {
  for (const std::string& part : words(parts)) {
    INFO("unexpected part: " << part << "\nin: " << text.substr(0, 2000));
    CHECK(text.find(part) == text.npos);
  }
}

void check_result(const Prepared& prepared, const Words& argv, const ProcessResult& result) {
  const Json& spec = prepared.spec;
  INFO("stderr: " << result.err.substr(0, 2000));
  CHECK(result.exit_code == spec["exit"].get<int>());
  check_hints(result.err);
  check_texts(spec.value("stdout_contains", Json::array()), result.out);
  check_texts(spec.value("stderr_contains", Json::array()), result.err);
  check_lacks(spec.value("stdout_lacks", Json::array()), result.out);
  check_lacks(spec.value("stderr_lacks", Json::array()), result.err);
  if (spec.contains("stdout")) CHECK(result.out == spec["stdout"].get<std::string>());
  if (spec.contains("stderr")) CHECK(result.err == spec["stderr"].get<std::string>());
  for (const std::string& path : words(spec.value("absent", Json::array()))) CHECK_FALSE(fs::exists(path));
  for (const std::string& path : words(spec.value("present", Json::array()))) {
    INFO("expected " << path);
    CHECK(fs::exists(path));
  }
  const bool killed = spec.value("signal", "") == "KILL";  // a killed process cannot remove its files
  if (!killed) CHECK(temporaries_under(prepared.tmp) == Words{});
  const bool done = result.exit_code == 0 || result.exit_code == 1 || result.exit_code == 7;
  if (!done)
    check_failure(prepared, argv, result);
  else if (!spec.value("text", false) && !result.out.empty())
    check_report(result.out);
  if (done && spec.contains("report")) check_report(test::read_bytes(spec["report"]));
}

/// The bytes of files, or of all files in folders.
std::map<std::string, std::string> contents(const Words& paths) {
  std::map<std::string, std::string> bytes;
  for (const std::string& path : paths) {
    REQUIRE_MESSAGE(fs::exists(path), path);
    if (!fs::is_directory(path)) {
      bytes[path] = test::read_bytes(path);
      continue;
    }
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path))
      if (entry.is_regular_file()) bytes[entry.path().string()] = test::read_bytes(entry.path().string());
  }
  return bytes;
}

/// The bytes with three threads, with one thread, and on a repeat are equal.
void check_same_bytes(const Prepared& prepared, const ProcessSpec& base) {
  const Words paths = words(prepared.spec["same_bytes"]);
  const auto first = contents(paths);
  CHECK_FALSE(first.empty());
  for (const char* threads : {"3", "1"}) {
    ProcessSpec again = base;
    for (const char* word : {"-w", "-j", threads}) again.argv.emplace_back(word);
    const ProcessResult result = test::run_process(again);
    INFO("with -j " << threads << ": " << result.err);
    CHECK(result.exit_code == prepared.spec["exit"].get<int>());
    const auto bytes = contents(paths);
    CHECK(bytes.size() == first.size());
    for (const auto& entry : first) {
      INFO(entry.first << " differs with -j " << threads);
      const auto& [path, content] = entry;
      CHECK((bytes.count(path) != 0 && bytes.at(path) == content));
    }
  }
}

/// After a kill at many different moments the output is either absent or complete.
void check_killed(const Prepared& prepared, const ProcessSpec& base) {
  const Words paths = words(prepared.spec["killed"]);
  const auto complete = contents(paths);
  for (const int signal : {SIGKILL, SIGTERM})
    for (const int after_ms : {1, 3, 6, 10, 20, 40, 80}) {
      for (const std::string& path : paths) fs::remove_all(path);
      ProcessSpec run = base;
      run.signal = signal;
      run.signal_after_ms = after_ms;
      const ProcessResult result = test::run_process(run);
      INFO("signal " << signal << " after " << after_ms << " ms: exit " << result.exit_code);
      CHECK((result.exit_code == 128 + signal || result.exit_code == prepared.spec["exit"].get<int>()));
      for (const auto& [path, content] : complete) CHECK((!fs::exists(path) || test::read_bytes(path) == content));
    }
}

int signal_number(const std::string& name) {
  static const std::map<std::string, int> numbers = {{"", 0},           {"TERM", SIGTERM}, {"INT", SIGINT},
                                                     {"USR1", SIGUSR1}, {"KILL", SIGKILL}, {"HUP", SIGHUP},
                                                     {"QUIT", SIGQUIT}};
  return numbers.at(name);
}

ProcessResult run_case(const Json& raw) {
  const test::TempDir dir;
  const bool mutates = raw.contains("setup");
  const std::string fixture = mutates ? dir.path() + "/scene" : fixture_folder();
  if (mutates) fs::copy(fixture_folder(), fixture, fs::copy_options::recursive);
  Prepared prepared{resolved(raw, dir.path(), fixture), dir.path(), {}};
  for (const Json& step : prepared.spec.value("setup", Json::array())) test::apply_mutation(step);

  for (const Json& step : prepared.spec.value("before", Json::array())) {
    ProcessSpec spec = command(step["run"]);
    spec.folder = dir.path();
    spec.signal = signal_number(step.value("signal", ""));
    spec.signal_after = step.value("signal_after", "");
    const ProcessResult result = test::run_process(spec);
    INFO("before: " << result.err);
    CHECK(result.exit_code == step["exit"].get<int>());
  }

  ProcessSpec spec = command(prepared.spec["run"]);
  spec.folder = dir.path();
  const Json environment = prepared.spec.value("environment", Json::object());
  for (const auto& [name, value] : environment.items()) spec.environment.emplace_back(name, value);
  spec.input = prepared.spec.value("stdin", "");
  spec.signal = signal_number(prepared.spec.value("signal", ""));
  spec.signal_after = prepared.spec.value("signal_after", "");
  spec.closed_stdout = prepared.spec.value("closed_stdout", false);
  spec.err_is_terminal = prepared.spec.value("err_is_terminal", false);
  for (const std::string& path : outputs_of(spec.argv))
    if (fs::exists(path)) prepared.before.insert(path);
  ProcessResult result = test::run_process(spec);
  CHECK_FALSE(result.timed_out);
  check_result(prepared, spec.argv, result);
  if (prepared.spec.contains("same_bytes")) check_same_bytes(prepared, spec);
  if (prepared.spec.contains("killed")) check_killed(prepared, spec);
  if (prepared.spec.contains("equal"))
    CHECK(test::read_bytes(prepared.spec["equal"][0]) == test::read_bytes(prepared.spec["equal"][1]));
  check_hinted_commands(result.err, dir.path());
  return result;
}

/// Why a case cannot be run here; empty: it can.
std::string left_out(const Json& spec) {
  if (test::emulated() && spec.contains("not_emulated")) return spec["not_emulated"];
  if (!test::under_wine()) return "";
  if (spec.contains("not_on_windows")) return spec["not_on_windows"];
  Json runs = spec.value("before", Json::array());
  runs.push_back(spec);
  for (const Json& run : runs)
    if (const std::string signal = run.value("signal", "INT"); signal != "INT")
      return "Windows has no signal " + signal;
  return "";
}

}  // namespace

TEST_CASE("every tool satisfies the contract in every listed case") {
  REQUIRE_NOTHROW(test::fixture_folder());
  const char* only = std::getenv("NGS_CONTRACT_ONLY");
  std::string table;
  int cases = 0, cases_left_out = 0;
  std::set<std::string> names;
  for (const auto& [file, cases_of_file] : test::contract_cases())
    for (const Json& spec : cases_of_file) {
      const std::string name = file + ": " + spec["name"].get<std::string>();
      if (only != nullptr && !std::regex_search(name, std::regex(only))) continue;
      if (const std::string why = left_out(spec); !why.empty()) {
        table += name + " | left out | " + why + "\n";
        ++cases_left_out;
        continue;
      }
      INFO("case: " << name);
      CHECK_MESSAGE(names.insert(name).second, "two cases of one name");
      ProcessResult result;
      CHECK_NOTHROW(result = run_case(spec));
      static const std::regex folder("/[^ ]*/ngs-test-[A-Za-z0-9]+");  // differs from run to run
      table += name + " | " + std::to_string(result.exit_code) + " | " +
               std::regex_replace(error_line(result.err), folder, "...") + "\n";
      ++cases;
    }
  std::cout << table << "contract cases: " << cases << ", left out: " << cases_left_out << "\n";
  if (const char* path = std::getenv("NGS_CONTRACT_TABLE")) std::ofstream(path) << "case | exit | stderr\n" << table;
}

}  // namespace ngs
