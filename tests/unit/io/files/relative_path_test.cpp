#include "ngs/io/files/relative_path.h"

#include <doctest/doctest.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "support/temp_dir.h"

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
