// Allowed includes per layer, and words confined to some files. Each rule is a function of one file and is also tested
// on a violating file.
#include <doctest/doctest.h>

#include <map>
#include <regex>
#include <set>

#include "support/source_tree.h"

namespace ngs {
namespace {

using test::SourceFile;
using Offenders = std::vector<std::string>;

// What a layer links, as in libngs/CMakeLists.txt, and with it all that those see. Operating system: only os, core and
// io.
const std::map<std::string, std::set<std::string>> kLinks = {
    {"os", {}},
    {"core", {"os"}},
    {"math", {"core"}},
    {"scene", {"math"}},
    {"backend", {"scene"}},
    {"ops", {"backend"}},
    {"options", {"core"}},
    {"problem", {"ops", "options"}},
    {"render", {"problem"}},
    {"orbit", {"problem"}},
    {"evidence", {"problem"}},
    {"field", {"problem"}},
    {"capture", {"render", "evidence"}},
    {"make", {"capture"}},
    {"cut", {"make", "field"}},
    {"passes", {"cut"}},
    {"methods", {"cut"}},
    {"edit", {"make", "orbit"}},
    {"eval", {"edit"}},
    {"mesh", {"edit"}},
    {"interactive", {"edit"}},
    {"io", {"os", "scene", "options"}},
};

bool may_include(const std::string& layer, const std::string& target) {
  if (target == layer) return true;
  if (target == "os") return kLinks.at(layer).count("os") == 1;
  for (const std::string& below : kLinks.at(layer))
    if (may_include(below, target)) return true;
  return false;
}

struct Confinement {
  std::regex header;
  std::regex allowed;  // paths
  const char* rule;
};
const std::vector<Confinement>& confinements() {
  static const std::vector<Confinement> rules = [] {
    std::vector<Confinement> list;
    const auto only = [&](const char* header, const char* allowed, const char* rule) {
      list.push_back({std::regex(header), std::regex(allowed), rule});
    };
    only("opencv2?/.*", "libngs/ngs/(io/image/(image_resize|codecs/.*)|ops/image/colour_cut)\\.cpp",
         "OpenCV belongs to io/image: codecs/ and image_resize.cpp, and to ops/image/colour_cut.cpp");
    only("(Imf|Imath|OpenEXR|Iex).*", "libngs/ngs/io/image/exr\\.cpp", "OpenEXR belongs to io/image/exr.cpp");
    only("flann/.*", "libngs/ngs/ops/neighbours/knn\\.cpp", "FLANN belongs to ops/neighbours/knn.cpp");
    only("CLI/.*", "tools/shared/cli/command_line\\.cpp", "CLI11 belongs to tools/shared/cli/command_line.cpp");
    only("nlohmann/.*", "(libngs/ngs/(options|io|passes)|tools)/.*",
         "nlohmann belongs to options/, io/, passes/ (reports) and tools/");
    only("Eigen/.*", ".*\\.cpp", "Eigen belongs to .cpp files");
    only("xxhash\\.h", "libngs/ngs/io/files/content_hash\\.cpp", "xxHash belongs to io/files/content_hash.cpp");
    only("zlib\\.h", "libngs/ngs/io/formats/compression/gzip\\.cpp", "zlib belongs to io/formats/compression/gzip.cpp");
    only("zstd\\.h", "libngs/ngs/io/formats/compression/zstd_frame\\.cpp",
         "zstd belongs to io/formats/compression/zstd_frame.cpp");
    only("webp/.*", "libngs/ngs/io/formats/compression/webp_image\\.cpp",
         "libwebp belongs to io/formats/compression/webp_image.cpp");
    only("minizip/.*", "libngs/ngs/io/formats/compression/zip_archive\\.cpp",
         "minizip belongs to io/formats/compression/zip_archive.cpp");
    only("httplib\\.h", "tools/ngs-studio/.*", "cpp-httplib belongs to tools/ngs-studio/");
    only("omp\\.h", "libngs/(ngs/backend|web)/.*|tools/shared/os/machine_web\\.cpp",
         "OpenMP belongs to backend/, what replaces it in a browser to web/");
    only("(immintrin|arm_neon)\\.h", "libngs/ngs/math/.*", "vector intrinsics belong to math/");
    only("(sys/.*|unistd|fcntl|dlfcn|spawn|sched|signal|poll|termios|pthread|malloc|windows|winsock2|io)(\\.h)?",
         "libngs/ngs/(os/.*|io/image/image_codecs\\.cpp)|tools/shared/os/.*|tests/.*",
         "the operating system belongs to os/ of libngs and of tools/shared, and to image_codecs.cpp");
    only("(cuda|cub/|thrust/|cooperative_groups).*", "libngs/ngs/(backend/.*|.*\\.cuh?)",
         "CUDA belongs to backend/ and *.cu");
    return list;
  }();
  return rules;
}

std::string layer_of(const std::string& path) {
  static const std::regex layer("(?:libngs/)?ngs/(?:cut/)?([a-z]+)/.*");
  static const std::map<std::string, std::string> folders = {
      {"masks", "evidence"}, {"groups", "evidence"}, {"training", "cut"}, {"contours", "cut"}};
  std::smatch match;
  if (!std::regex_match(path, match, layer)) return "";
  const auto folder = folders.find(match[1]);
  return folder == folders.end() ? match[1].str() : folder->second;
}

std::vector<std::string> included(const std::string& text) {
  static const std::regex include("#\\s*include\\s*[<\"]([^>\"]+)[>\"]");
  std::vector<std::string> headers;
  for (std::sregex_iterator at(text.begin(), text.end(), include), end; at != end; ++at) headers.push_back((*at)[1]);
  return headers;
}

Offenders layer_offences(const SourceFile& file) {
  Offenders offences;
  const std::string layer = layer_of(file.path);
  static const std::regex kernel_may("ngs/(core/hd\\.h|math/.*|scene/views\\.h|ops/.*_(kernels|layout)\\.h)");
  for (const std::string& header : included(file.text)) {
    if (header.rfind("ngs/", 0) != 0) continue;
    const std::string target = layer_of(header);
    if (!layer.empty() && !may_include(layer, target))
      offences.push_back(file.path + ": includes " + header + ", but " + layer + " may not see " + target);
    if ((file.ends_with("_kernels.h") || file.ends_with("_layout.h")) && !std::regex_match(header, kernel_may))
      offences.push_back(file.path + ": includes " + header +
                         ", a kernel header sees core/hd.h, math/ and scene/views.h");
  }
  return offences;
}

/// A pass is a folder of cut/passes/. It sees no other pass, and the files that all passes share see none. time/ is
/// shared.
Offenders pass_offences(const SourceFile& file) {
  static const std::regex pass("(?:libngs/)?ngs/cut/passes/([a-z_]+)/.*");
  const auto pass_of = [](const std::string& path) {
    std::smatch match;
    return std::regex_match(path, match, pass) && match[1] != "time" ? match[1].str() : std::string();
  };
  Offenders offences;
  if (layer_of(file.path) != "passes") return offences;
  for (const std::string& header : included(file.text))
    if (const std::string other = pass_of(header); !other.empty() && other != pass_of(file.path))
      offences.push_back(file.path + ": includes " + header + ", but a pass sees no other pass");
  return offences;
}

Offenders third_party_offences(const SourceFile& file) {
  Offenders offences;
  for (const std::string& header : included(file.text))
    for (const Confinement& rule : confinements())
      if (std::regex_match(header, rule.header) && !std::regex_match(file.path, rule.allowed))
        offences.push_back(file.path + ": includes " + header + ", but " + rule.rule);
  return offences;
}

Offenders word_offences(const SourceFile& file) {
  Offenders offences;
  const auto search = [&](const char* words, bool allowed, const char* rule) {
    std::smatch match;
    if (!allowed && std::regex_search(file.text, match, std::regex(words)))
      offences.push_back(file.path + ": has '" + match[0].str() + "', but " + rule);
  };
  const bool backend = file.in("libngs/ngs/backend"), cuda = backend || file.ends_with(".cu") || file.ends_with(".cuh");
  search("__(global|device|host|shared|constant|launch_bounds)__|\\bcuda[A-Z]\\w+|<<<",
         cuda || file.path == "libngs/ngs/core/hd.h", "CUDA words belong to backend/ and *.cu");
  search("#\\s*pragma\\s+omp", backend, "OpenMP pragmas belong to backend/");
  search("\\batomic(Add|CAS|Max|Min|Exch)\\b|omp\\s+(atomic|critical)|std::atomic_ref",
         file.path == "libngs/ngs/backend/cuda_launcher.cuh", "kernels gather and do not scatter");
  search("\\b(Grid|Launcher)::atomic_add\\b",
         file.text.find("DeviceSums::kAtomic") != std::string::npos || !file.in("libngs/ngs/ops"),
         "kernels scatter only with DeviceSums::kAtomic");
  return offences;
}

Offenders flag_offences(const SourceFile& file) {
  static const std::regex fast(
      "-ffast-math|-Ofast|use_fast_math|-funsafe-math|-ffp-contract=(fast|on)|-fassociative-math");
  Offenders offences;
  std::smatch match;
  if (std::regex_search(file.text, match, fast))
    offences.push_back(file.path + ": has " + match[0].str() + ", but results may not depend on the optimiser");
  // Vectorised sums of Eigen depend on the processor; ngs_eigen disables vectorisation and threads.
  const bool wraps =
      file.text.find("ngs_eigen INTERFACE EIGEN_DONT_PARALLELIZE EIGEN_DONT_VECTORIZE") != file.text.npos;
  if (!wraps && file.text.find("Eigen3::Eigen") != file.text.npos)
    offences.push_back(file.path + ": links Eigen3::Eigen, expected ngs_eigen");
  return offences;
}

template <class Rule>
std::string over(const std::vector<SourceFile>& files, const Rule& rule) {
  Offenders all;
  for (const SourceFile& file : files)
    for (const std::string& offence : rule(file)) all.push_back(offence);
  return test::listed(all);
}

}  // namespace

TEST_CASE("layers include only lower layers") {
  REQUIRE_FALSE(test::code_files().empty());
  CHECK(over(test::code_files(), layer_offences) == "");
  CHECK(layer_offences({"libngs/ngs/ops/x.h", "#include \"ngs/io/ply/ply.h\"\n"}).size() == 1);
  CHECK(layer_offences({"libngs/ngs/io/x.cpp", "#include \"ngs/ops/splat/splat.h\"\n"}).size() == 1);
  CHECK(layer_offences({"libngs/ngs/cut/masks/x.h", "#include \"ngs/cut/training/y.h\"\n"}).size() == 1);
  CHECK(layer_offences({"libngs/ngs/ops/x_kernels.h", "#include \"ngs/backend/exec.h\"\n"}).size() == 1);
  CHECK(layer_offences({"tools/ngs-x/main.cpp", "#include \"ngs/io/ply/ply.h\"\n"}).empty());

  CHECK(over(test::code_files(), pass_offences) == "");
  CHECK(pass_offences({"libngs/ngs/cut/passes/a/x.h", "#include \"ngs/cut/passes/b/y.h\"\n"}).size() == 1);
  CHECK(pass_offences({"libngs/ngs/cut/passes/pass.h", "#include \"ngs/cut/passes/b/y.h\"\n"}).size() == 1);
  CHECK(pass_offences({"libngs/ngs/cut/passes/a/x.h", "#include \"ngs/cut/passes/time/step_tracker.h\"\n"}).empty());
}

TEST_CASE("every folder of the library is a known layer") {
  for (const SourceFile& file : test::source_files({"libngs/ngs"}, {".h", ".cpp", ".cu", ".cuh"})) {
    INFO(file.path);
    CHECK(kLinks.count(layer_of(file.path)) == 1);
  }
}

TEST_CASE("every third-party library is confined to its file or layer") {
  CHECK(over(test::code_files(), third_party_offences) == "");
  CHECK(third_party_offences({"libngs/ngs/io/ply/ply.cpp", "#include <opencv2/core.hpp>\n"}).size() == 1);
  CHECK(third_party_offences({"libngs/ngs/io/ply/ply.h", "# include <Eigen/Core>\n"}).size() == 1);
  CHECK(third_party_offences({"tools/ngs-rbf/main.cpp", "#include <CLI/CLI.hpp>\n"}).size() == 1);
  CHECK(third_party_offences({"libngs/ngs/edit/x.h", "#include <nlohmann/json.hpp>\n"}).size() == 1);
}

TEST_CASE("CUDA and OpenMP words occur only in the backend, and kernels do not scatter") {
  CHECK(over(test::code_files(), word_offences) == "");
  CHECK(word_offences({"libngs/ngs/ops/x.cpp", "#pragma omp parallel for\n"}).size() == 1);
  CHECK(word_offences({"libngs/ngs/ops/x.h", "__device__ float f();\n"}).size() == 1);
  CHECK(word_offences({"libngs/ngs/ops/x.cu", "__global__ void f() { atomicAdd(p, 1); }\n"}).size() == 1);
  CHECK(word_offences({"libngs/ngs/ops/x.h", "NGS_HD void f() { Grid::atomic_add(p, 1); }\n"}).size() == 1);
}

TEST_CASE("build files enable neither fast-math nor contraction, and link Eigen only through ngs_eigen") {
  const std::vector<SourceFile> files = test::source_files({"libngs", "tools", "tests"}, {"CMakeLists.txt", ".cmake"});
  REQUIRE_FALSE(files.empty());
  CHECK(over(files, flag_offences) == "");
  CHECK(flag_offences({"x.cmake", "add_compile_options(-O3 -ffast-math)"}).size() == 1);
  CHECK(flag_offences({"x/CMakeLists.txt", "target_link_libraries(x PRIVATE Eigen3::Eigen)"}).size() == 1);
  CHECK(flag_offences({"x/NgsLibraries.cmake", "target_link_libraries(ngs_eigen INTERFACE Eigen3::Eigen)"}).size() ==
        1);
}

}  // namespace ngs
