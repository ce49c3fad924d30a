// pipelines/Containerfile copies existing files, and all files that the build reads. ci/container.sh builds the image.
#include <doctest/doctest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <sstream>

#include "support/temp_dir.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
const fs::path kTree = NGS_SOURCE_DIR;

struct Instruction {
  std::string name;
  std::vector<std::string> words;
};

/// Instructions of the Containerfile, in order; joins lines that end with a backslash.
std::vector<Instruction> instructions() {
  std::string text = test::read_bytes((kTree / "pipelines/Containerfile").string());
  text = std::regex_replace(text, std::regex("\\\\\n"), " ");
  std::vector<Instruction> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    Instruction& instruction = found.emplace_back();
    words >> instruction.name;
    for (std::string word; words >> word;) instruction.words.push_back(word);
  }
  return found;
}

/// Paths copied from the checkout.
std::set<std::string> copied() {
  std::set<std::string> sources;
  for (const Instruction& i : instructions())
    if (i.name == "COPY" && !i.words.front().starts_with("--from")) sources.insert(i.words.begin(), i.words.end() - 1);
  return sources;
}

}  // namespace

TEST_CASE("the Containerfile copies existing paths and all folders that the build needs") {
  const std::set<std::string> sources = copied();
  for (const std::string& source : sources) {
    CAPTURE(source);
    CHECK(fs::exists(kTree / source));
  }
  const std::string top = test::read_bytes((kTree / "CMakeLists.txt").string()) +
                          test::read_bytes((kTree / "libngs/cmake/NgsInstall.cmake").string());
  // Subdirectories added by CMake, and installed paths of the checkout.
  const std::regex read(R"(add_subdirectory\((\w+)\)|\$\{PROJECT_SOURCE_DIR\}/([\w.-]+))");
  int checked = 0;
  for (std::sregex_iterator at(top.begin(), top.end(), read), end; at != end; ++at) {
    const std::string name = (*at)[1].matched ? (*at)[1] : (*at)[2];
    CAPTURE(name);
    if (name == "tests" || !fs::exists(kTree / name)) continue;  // the image is built without tests
    CHECK(sources.contains(name));
    ++checked;
  }
  CHECK(checked >= 3);
}

TEST_CASE("the Containerfile installs the packages of setup.sh and bundle.sh and installs the package of bundle.sh") {
  std::string run;
  for (const Instruction& i : instructions())
    if (i.name == "RUN")
      for (const std::string& word : i.words) run += word + " ";
  CHECK(run.find("/src/pipelines/setup.sh &&") != std::string::npos);
  CHECK(run.find("/src/pipelines/setup.sh /src/pipelines/bundle/packages.txt") != std::string::npos);
  CHECK(run.find("/src/pipelines/bundle.sh --no-setup -o /package") != std::string::npos);
  CHECK(run.find("/package/ngs_*.deb") != std::string::npos);
}

}  // namespace ngs
