// ngs: lists the tools and runs them ("ngs mask" is ngs-mask), cuts an object out in one command ("ngs cut"), and
// describes a file ("ngs info").
#include <algorithm>
#include <cstdio>
#include <cstring>

#include "commands.h"
#include "cut_inputs.h"
#include "ngs/core/error.h"
#include "shared/cli/dispatch.h"
#include "shared/cli/exit_code.h"
#include "shared/os/process.h"
#include "shared/run/child_process.h"

namespace {

using namespace ngs;

/// A tool in the folder of this one: "ngs mask" is ngs-mask. In the order in which a run calls them.
struct Subcommand {
  const char* name;
  const char* summary;
};
constexpr Subcommand kSubcommands[] = {
    {"scene", "cameras, photos, masks, a splat -> checked scene.json; makes pictures of a bare splat"},
    {"mask", "strokes on some photos -> masks of all views"},
    {"group", "masks of everything, whose ids differ between the views -> one id per object"},
    {"variance", "masks -> the Gaussians on the edge of the object"},
    {"sample", "query points on rays over the boundary"},
    {"rbf", "boundary features interpolated at the query points"},
    {"joint", "labels and Gaussians optimised together"},
    {"extract", "labels, or the place of the object -> object.ply and background.ply"},
    {"mesh", "object.ply -> a closed triangle mesh"},
    {"clean", "a splat -> the same without floaters and other debris"},
    {"render", "colour, masks, depth and labels at the scene's cameras"},
    {"eval", "scores of masks against the truth"},
    {"report", "HTML page of one run, or a comparison of several"},
    {"studio", "web page to mark an object on a splat, correct the selection and cut it"},
    {"fit", "photos -> a splat"},
    {"synth", "analytic scenes with exact masks"}};

/// Replaces this process by the program with these arguments (exec), so that signals, streams and exit code are those
/// of the program. Returns only if it cannot be started.
int run_program(const std::string& program, const std::vector<std::string>& words) {
  try {
    std::vector<std::string> argv{program};
    argv.insert(argv.end(), words.begin(), words.end());
    argv = cli::sibling_command(std::move(argv));
    const int reason = os::become(argv);
    throw Error(ErrorCode::kEnvironment, argv[0] + ": cannot be started: " + std::strerror(reason));
  } catch (const Error& e) {
    std::fprintf(stderr, "ngs: error: %s\nngs: hint: %s\n", e.what(), e.remedy().c_str());
    return int(e.code());
  }
}

std::vector<cli::Command> commands() {
  std::vector<cli::Command> all = {
      {"cut", ngs_tool::cut_command,
       "cut an object out of a splat, a capture or a scene: the whole chain in one command"},
      {"info", ngs_tool::info_command, "what a splat, a scene or a capture is, and the command that comes next"}};
  for (const Subcommand& tool : kSubcommands)
    all.push_back({tool.name,
                   [program = std::string("ngs-") + tool.name](int argc, char** argv) {
                     return run_program(program, {argv + 1, argv + argc});
                   },
                   tool.summary});
  return all;
}

/// A file or folder instead of a command.
bool is_file(const std::string& word) {
  const auto known = commands();
  return std::ranges::find(known, word, &cli::Command::name) == known.end() && !word.starts_with("-") &&
         (ngs_tool::exists(word) || word.find_first_of("./") != word.npos);
}

/// "ngs help mask" is "ngs mask --help", "ngs ngs-mask" is "ngs mask", "ngs statue.ply" is "ngs info statue.ply".
std::vector<std::string> usual_spelling(std::vector<std::string> words) {
  if (words.empty()) return {"--help"};
  if (words[0] == "help" && words.size() < 3) {
    words.erase(words.begin());
    words.push_back("--help");
  }
  if (words[0].starts_with("ngs-")) words[0].erase(0, 4);
  if (is_file(words[0])) words.insert(words.begin(), "info");
  return words;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> words = usual_spelling({argv + std::min(argc, 1), argv + argc});
  if (words[0] == "--print-commands") {  // for scripts that list all tools: only the commands of this program
    std::fputs("cut\ninfo\n", stdout);
    return cli::kDone;
  }
  if (words[0] == "--help" && words.size() == 2) words.pop_back();  // --help all
  words.insert(words.begin(), "ngs");
  std::vector<char*> spelt;
  for (std::string& word : words) spelt.push_back(word.data());
  return cli::dispatch(int(spelt.size()), spelt.data(), commands());
}
