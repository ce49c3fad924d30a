// The build compiles only what is requested, and installed files work without the source tree: for other projects, man,
// shells, packages.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>

#include "support/process.h"
#include "support/skip.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// What `cmake --install` writes, once for all tests.
const std::string& installed_prefix() {
  static const test::TempDir dir;
  static const std::string prefix = [] {
    test::succeeded(test::run_command({"cmake", "--install", NGS_TOOL_DIR "/..", "--prefix", dir.path()}));
    return dir.path();
  }();
  return prefix;
}

struct Installed {
  test::TempDir dir;
  std::string prefix = dir.path() + "/prefix";
  std::string absent;  // what is missing on this machine

  /// For a test that runs `program` beside cmake.
  explicit Installed(const std::string& program = "cmake") {
    if (test::emulated()) absent = "no compiler here is for the processor of this build";
    for (const std::string& needed : {std::string("cmake"), program})
      if (absent.empty() && run({needed, "--version"}).exit_code == 127) absent = "no " + needed;
    if (absent.empty()) fs::create_directory_symlink(installed_prefix(), prefix);
  }
  bool has(const std::string& name) const { return fs::exists(prefix + "/" + name); }
  test::ProcessResult run(Words argv, std::vector<std::pair<std::string, std::string>> environment = {}) const {
    return test::run_process({.argv = std::move(argv), .environment = std::move(environment), .folder = dir.path()});
  }
  /// Runs a command that must succeed; returns its output.
  std::string output(const Words& argv) const { return test::succeeded(run(argv)).out; }
  /// Searches a file under the prefix; the folder depends on the system.
  std::string found(const std::string& name) const {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(prefix))
      if (entry.path().filename() == name) return entry.path().string();
    FAIL("nothing of this name was installed: " << name);
    return {};
  }
  /// Writes the program of docs/library.md and a scene for it.
  void write_user() const {
    fs::create_directories(dir.path() + "/scene");
    test::write_tiny_scene(dir.path() + "/scene");
    const std::string page = test::read_bytes(NGS_SOURCE_DIR "/docs/library.md"), fence = "```cpp\n";
    const std::size_t begin = page.find(fence) + fence.size(), end = page.find("```", begin);
    REQUIRE(end != page.npos);
    dir.write("user.cpp", page.substr(begin, end - begin));
  }
  /// The program writes the Gaussians of the red ball and counts the pixels of its mask.
  void run_user(const std::string& program) const {
    const std::string pixels = output({program, "scene/scene.json", "object.ply"});
    CHECK(pixels.ends_with(" of 1728 pixels\n"));  // 48 x 36
    CHECK(std::stoi(pixels) > 0);
    CHECK(fs::file_size(dir.path() + "/object.ply") > 248);  // a Gaussian
    CHECK(fs::file_size(dir.path() + "/object.ply") < fs::file_size(dir.path() + "/scene/model.ply"));
    CHECK(run({program}).exit_code == 2);
  }
};

}  // namespace

TEST_CASE("the build compiles no CUDA by default even if nvcc exists") {
  if (test::run_command({"cmake", "--version"}).exit_code == 127) return test::skip("no cmake");
  const test::TempDir dir;
  fs::create_directory(dir.path() + "/bin");
  // The real cmake configures into this folder and builds nothing; a fake nvcc records that it was called.
  dir.write("bin/cmake",
            "#!/bin/bash\ncase $1 in\n  --build) echo \"cmake $*\" ;;\n  *) PATH=${PATH#*:}; exec cmake -B " +
                dir.path() + "/$NGS_PRESET \"$@\" ;;\nesac\n");
  dir.write("bin/nvcc", "#!/bin/bash\ntouch " + dir.path() + "/nvcc-called\nexit 1\n");
  for (const char* program : {"/bin/cmake", "/bin/nvcc"}) fs::permissions(dir.path() + program, fs::perms::owner_all);
  const auto build = [&](const Words& argv, const std::string& preset) {
    const test::ProcessResult result =
        test::succeeded(test::run_process({.argv = argv,
                                           .environment = {{"PATH", dir.path() + "/bin:" + std::getenv("PATH")},
                                                           {"CUDA_HOME", dir.path()},
                                                           {"NGS_PRESET", preset}},
                                           .folder = dir.path()}));
    CHECK(result.out.find("ngs: CUDA backend OFF\n") != result.out.npos);  // the fake nvcc compiles nothing
    return result.out;
  };
  const std::string script = NGS_SOURCE_DIR "/pipelines/build.sh";
  CHECK(build({script, "--target", "tools"}, "").ends_with("cmake --build --preset cpu --target tools\n"));
  build({dir.path() + "/bin/cmake", "-S", NGS_SOURCE_DIR}, "plain");
  CHECK(!fs::exists(dir.path() + "/nvcc-called"));
  build({script}, "ci");
  CHECK(fs::exists(dir.path() + "/nvcc-called"));
}

TEST_CASE("another project finds an installed ngs with find_package, links ngs::ngs and runs in any folder") {
  const Installed installed;
  if (!installed.absent.empty()) return test::skip(installed.absent);
  installed.write_user();
  installed.dir.write("CMakeLists.txt",
                      "cmake_minimum_required(VERSION 3.25)\nproject(user CXX)\nfind_package(ngs 0.1 REQUIRED)\n"
                      "add_executable(user user.cpp)\ntarget_link_libraries(user PRIVATE ngs::ngs)\n");
  installed.output({"cmake", "-S", ".", "-B", "build", "-DCMAKE_PREFIX_PATH=" + installed.prefix});
  const std::string log = installed.output({"cmake", "--build", "build", "--verbose"});
  CHECK(log.find("-ffp-contract=off") != log.npos);
  CHECK(log.find(NGS_SOURCE_DIR) == log.npos);  // no path of the source tree
  installed.run_user("build/user");
}

TEST_CASE("the headers of docs/library.md are installed with what they include, and no others") {
  const Installed installed;
  if (!installed.absent.empty()) return test::skip(installed.absent);
  CHECK(installed.has("include/ngs/cut/evidence/variance_stage.h"));
  CHECK(installed.has("include/ngs/core/error.h"));
  CHECK(!installed.has("include/ngs/cut/passes/pass.h"));
  CHECK(!installed.has("include/ngs/ops/splat/tile_lists.h"));
}

TEST_CASE("pkg-config gives working flags to compile and link against an installed ngs") {
  const Installed installed("pkg-config");
  if (!installed.absent.empty()) return test::skip(installed.absent);
  installed.write_user();
  const std::string folder = fs::path(installed.found("ngs.pc")).parent_path().string();
  installed.output({"bash", "-c",
                    "export PKG_CONFIG_PATH=" + folder +
                        "; c++ $(pkg-config --cflags ngs) user.cpp $(pkg-config --libs ngs) -o user"});
  installed.run_user("./user");
}

TEST_CASE("every tool has a man page that renders without a warning and lists its options") {
  const Installed installed("man");
  if (!installed.absent.empty()) return test::skip(installed.absent);
  int pages = 0;
  for (const fs::directory_entry& tool : fs::directory_iterator(installed.prefix + "/bin")) {
    const std::string name = tool.path().filename().string();
    if (name == "ngs-gs") continue;  // a script: only its --help
    CAPTURE(name);
    const std::string page = installed.prefix + "/share/man/man1/" + name + ".1";
    REQUIRE(fs::exists(page));
    const test::ProcessResult rendered =
        test::succeeded(installed.run({"man", "--warnings", "-l", page}, {{"MANWIDTH", "100"}, {"LC_ALL", "C.UTF-8"}}));
    CHECK(rendered.err == "");
    CHECK(rendered.out.find("--log-format") != std::string::npos);
    ++pages;
  }
  CHECK(pages >= 12);
}

TEST_CASE("bash completes options, their values and commands") {
  const Installed installed;
  if (!installed.absent.empty()) return test::skip(installed.absent);
  const auto completed = [&](const std::string& words) {
    return installed.output(
        {"bash", "-c",
         "for f in prefix/share/bash-completion/completions/*; do . $f; done\n"
         "COMP_WORDS=(" +
             words +
             "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n"
             "$(complete -p ${COMP_WORDS[0]} | sed 's/.*-F \\([^ ]*\\).*/\\1/'); echo ${COMPREPLY[*]}"});
  };
  CHECK(completed("ngs-joint s.json b.ply --qual") == "--quality\n");
  CHECK(completed("ngs-joint s.json b.ply --quality d") == "draft\n");
  CHECK(completed("ngs-scene ''") == "import orbit check undistort degrade\n");
  CHECK(completed("ngs-scene check --check-") == "--check-polarity --check-views\n");
  CHECK(completed("ngs-variance merge --ex") == "--exclusive\n");
  CHECK(completed("ngs-eval --allow-m") == "--allow-missing\n");
  CHECK(completed("ngs-joint --field f") == "\n");  // a path, completed by bash
}

TEST_CASE("zsh completes options, their values and commands") {
  const Installed installed("zsh");
  if (!installed.absent.empty()) return test::skip(installed.absent);
  const auto offered = [&](const std::string& words) {
    return installed.output({"zsh", "-fc",
                             "compadd() { shift; print -r -- $@ }; _files() { print paths }\n"
                             "complete_it() { words=(" +
                                 words +
                                 "); CURRENT=$#words; service=$words[1]\n"
                                 "source prefix/share/zsh/vendor-completions/_ngs }; complete_it"});
  };
  CHECK(offered("ngs-joint s.json --quality ''") == "draft standard high reference\n");
  CHECK(offered("ngs-scene ''") == "import orbit check undistort degrade\n");
  CHECK((" " + offered("ngs-scene check --")).find(" --check-views ") != std::string::npos);
  CHECK(offered("ngs-joint --field ''") == "paths\n");
}

TEST_CASE("fish completes options, their values and commands") {
  const Installed installed("fish");
  if (!installed.absent.empty()) return test::skip(installed.absent);
  const auto offered = [&](const std::string& line) {
    return installed
        .run({"fish", "--no-config", "-c",
              "for f in prefix/share/fish/vendor_completions.d/*.fish; source $f; end; complete -C '" + line + "'"},
             {{"HOME", installed.dir.path()}})
        .out;
  };
  CHECK(offered("ngs-joint s.json b.ply --qual") == "--quality\n");
  CHECK(offered("ngs-joint s.json b.ply --quality d") == "draft\n");
  CHECK(offered("ngs-scene ") == "check\ndegrade\nimport\norbit\nundistort\n");
  CHECK(offered("ngs-scene check --check-") == "--check-polarity\n--check-views\n");
  CHECK(offered("ngs-scene import --check-v") == "--check-views\n");
  CHECK(offered("ngs-variance merge --ex") == "--exclusive\n");
  CHECK(offered("ngs-joint --field pre") == "prefix/\n");
}

TEST_CASE("the installed chain runs with the installed tools") {
  const Installed installed;
  if (!installed.absent.empty()) return test::skip(installed.absent);
  for (const char* name : {"share/ngs/pipelines/sharded.mk", "share/ngs/data-schema/scene.schema.json",
                           "share/doc/ngs/LICENSE", "share/doc/ngs/CHANGELOG.md"}) {
    CAPTURE(name);
    CHECK(installed.has(name));
  }
  for (const std::string& tool : test::tool_names()) {
    CAPTURE(tool);
    CHECK(installed.has("bin/" + tool));
  }
  installed.write_user();
  fs::remove(installed.dir.path() + "/scene/scene.json");
  fs::create_directory_symlink(installed.prefix + "/bin/ngs-gs", installed.dir.path() + "/linked");
  test::succeeded(installed.run({"./linked", "scene", "out", "--hold-out", "every:4:2", "--method", "flash", "-q"},
                                {{"NGS_THREADS", "1"}, {"SAMPLE_FLAGS", "--rows 8 --cols 8"}}));
  CHECK(fs::exists(installed.dir.path() + "/out/masks/v2.png"));
}

}  // namespace ngs
