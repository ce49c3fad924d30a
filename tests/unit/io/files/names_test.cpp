#include <doctest/doctest.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ngs/core/error.h"
#include "ngs/io/files/match_names.h"
#include "ngs/io/files/relative_path.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

using Names = std::vector<std::string>;

std::string described(const Names& predicted, const Names& truth) {
  const io::NameMatch match = io::match_names(predicted, truth);
  std::string text;
  for (const io::NamePair& pair : match.pairs)
    text += predicted[pair.predicted] + "=" + truth[pair.truth] + "(" + std::string(pair.rule) + ") ";
  for (std::size_t i : match.unmatched_predicted) text += "-" + predicted[i] + " ";
  for (std::size_t i : match.unmatched_truth) text += "+" + truth[i] + " ";
  return text;
}

TEST_CASE("names are paired by stem, whatever the extension and order") {
  CHECK(described({"b.png", "a.jpg", "c.png"}, {"a.png", "b.png"}) == "a.jpg=a.png(stem) b.png=b.png(stem) -c.png ");
  CHECK(described({}, {"a.png"}) == "+a.png ");
  CHECK(described({}, {}).empty());
}

TEST_CASE("names are paired without double extensions and common affixes") {
  CHECK(described({"IMG_4027.JPG.png"}, {"IMG_4027_mask.png"}) == "IMG_4027.JPG.png=IMG_4027_mask.png(affix) ");
  CHECK(described({"0003_label.png"}, {"frame_0003.png"}) == "0003_label.png=frame_0003.png(affix) ");
  CHECK(described({"mask_a.png"}, {"A.png"}) == "mask_a.png=A.png(affix) ");
}

TEST_CASE("numbers are paired where they are unique on both sides") {
  CHECK(described({"00012.png", "7.png"}, {"view012.png", "view7.png"}) ==
        "00012.png=view012.png(number) 7.png=view7.png(number) ");
  // 12 occurs twice among the predictions: the name stays unpaired.
  CHECK(described({"a12.png", "b12.png"}, {"view12.png"}) == "-a12.png -b12.png +view12.png ");
  CHECK(described({"left.png"}, {"right.png"}) == "-left.png +right.png ");
}

TEST_CASE("a parent folder is part of the name") {
  CHECK(described({"v1/apple.png", "v2/apple.png"}, {"v2/apple.png", "v1/apple.png"}) ==
        "v1/apple.png=v1/apple.png(stem) v2/apple.png=v2/apple.png(stem) ");
  CHECK(described({"v1/001.png"}, {"v2/1.png"}) == "-v1/001.png +v2/1.png ");
}

TEST_CASE("two files with the same stem are rejected") {
  CHECK_THROWS_AS(io::match_names(Names{"a.png", "a.jpg"}, Names{"a.png"}), Error);
}

}  // namespace
}  // namespace ngs

namespace ngs::io {
namespace {

namespace fs = std::filesystem;
using test::TempDir;

std::string there_and_back(const std::string& file, const std::string& path) {
  return path_from_folder(fs::path(file).parent_path().string(), path_to_folder(FileFolder(file), path));
}

}  // namespace

TEST_CASE("a relative path from a linked folder leads to its file") {
  const TempDir dir;
  const std::string photo = dir.write("capture/deep/images/a.png", "photo");
  fs::create_directories(dir.path() + "/disk");
  for (const char* link : {"/out", "/capture/deep/out", "/capture/out"}) {
    CAPTURE(link);
    fs::create_directory_symlink(dir.path() + "/disk", dir.path() + link);
    const std::string file = dir.path() + link + "/scene.json";
    CHECK(fs::equivalent(there_and_back(file, photo), photo));
    fs::create_directories(dir.path() + link + "/below");
    CHECK(fs::equivalent(there_and_back(dir.path() + link + "/below/scene.json", photo), photo));
  }
}

TEST_CASE("a pipe has no folder, whatever its path") {
  const TempDir dir;
  CHECK(folder_of_file(dir.write("scene.json", "{}")) == dir.path());
  CHECK(folder_of_file(dir.path() + "/absent.json") == dir.path());
  const std::string pipe = dir.path() + "/pipe";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  CHECK(folder_of_file(pipe) == "");
  const int memory = memfd_create("scene", MFD_CLOEXEC);
  REQUIRE(memory >= 0);
  for (const char* folder : {"/proc/self/fd/", "/dev/fd/", "/proc/thread-self/fd/"})
    CHECK(folder_of_file(folder + std::to_string(memory)) == "");
  close(memory);
}

TEST_CASE("a linked folder below the file's folder keeps its name in stored paths") {
  const TempDir dir;
  const std::string photo = dir.write("disk/images/a.png", "photo");
  fs::create_directories(dir.path() + "/scene");
  fs::create_directory_symlink(dir.path() + "/disk/images", dir.path() + "/scene/images");
  const std::string stored =
      path_to_folder(FileFolder(dir.path() + "/scene/s.json"), dir.path() + "/scene/images/a.png");
  CHECK(stored == "images/a.png");
  fs::create_directories(dir.path() + "/far/away");
  fs::rename(dir.path() + "/scene", dir.path() + "/far/away/scene");
  CHECK(fs::equivalent(path_from_folder(dir.path() + "/far/away/scene", stored), photo));
}

TEST_CASE("paths without links are stored short; empty and absolute paths are unchanged") {
  const TempDir dir;
  CHECK(path_from_folder("a/b", "../c.png") == "a/c.png");
  CHECK(path_from_folder("a/b", "./c.png") == "a/b/c.png");
  CHECK(path_from_folder("", "../c.png") == "../c.png");
  CHECK(path_from_folder("a", "") == "");
  CHECK(path_from_folder("a", "/data/c.png") == "/data/c.png");
  CHECK(path_to_folder(FileFolder(dir.path() + "/s.json"), "") == "");
  CHECK(path_to_folder(FileFolder(dir.path() + "/x/s.json"), dir.path() + "/y/c.png") == "../y/c.png");
}

}  // namespace ngs::io
