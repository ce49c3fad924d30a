#include "ngs/io/files/atomic_file.h"

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <vector>

#include "ngs/core/error.h"
#include "ngs/io/files/content_hash.h"
#include "ngs/io/files/mapped_file.h"
#include "support/error_code.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;

std::size_t entries(const std::string& folder) {
  return std::size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST_CASE("an output appears complete on commit, and not at all without commit") {
  const test::TempDir dir;
  {
    io::AtomicFile file(dir.file("out.ply"));
    file.write("half");
    CHECK_FALSE(fs::exists(dir.file("out.ply")));
    CHECK(fs::path(file.temporary_path()).extension() == ".ply");
  }
  CHECK(entries(dir.path()) == 0);
  io::write_file(dir.file("out.ply"), "old");
  {
    io::AtomicFile file(dir.file("out.ply"));
    file.write("new");
  }
  CHECK(test::read_bytes(dir.file("out.ply")) == "old");
  io::write_file(dir.file("out.ply"), "new");
  CHECK(test::read_bytes(dir.file("out.ply")) == "new");
  CHECK(entries(dir.path()) == 1);
}

TEST_CASE("a mapped input keeps its bytes when an output is renamed over it") {
  const test::TempDir dir;
  io::write_file(dir.file("model.ply"), "before");
  const io::MappedFile before(dir.file("model.ply"));
  io::write_file(dir.file("model.ply"), "after");
  CHECK(before.text() == "before");
  CHECK(io::MappedFile(dir.file("model.ply")).text() == "after");
}

TEST_CASE("an output through a symbolic link replaces the file, not the link") {
  const test::TempDir dir;
  io::write_file(dir.file("real"), "old");
  fs::create_symlink(dir.file("real"), dir.path() + "/link");
  io::write_file(dir.path() + "/link", "new");
  CHECK(fs::is_symlink(dir.path() + "/link"));
  CHECK(test::read_bytes(dir.file("real")) == "new");
}

TEST_CASE("outputs have the permissions of ordinary files") {
  const test::TempDir dir;
  const mode_t old = ::umask(022);
  io::write_file(dir.file("f"), "x");
  ::umask(old);
  struct stat status {};
  REQUIRE(::stat(dir.file("f").c_str(), &status) == 0);
  CHECK((status.st_mode & 0777) == 0644);
}

TEST_CASE("a device is written directly and not replaced") {
  io::write_file("/dev/null", "x");
  CHECK(fs::is_character_file("/dev/null"));
}

TEST_CASE("paths that cannot be written or read are reported with the reason") {
  const test::TempDir dir;
  const auto code_of = [](auto&& body) {
    const Error e = test::thrown_by(body);
    CHECK(std::string(e.what()).find(": ") != std::string::npos);
    return e.code();
  };
  CHECK(code_of([&] { io::write_file(dir.path() + "/none/f", "x"); }) == ErrorCode::kEnvironment);
  CHECK(code_of([&] { io::write_file(dir.path(), "x"); }) == ErrorCode::kEnvironment);
  CHECK(code_of([&] { io::write_file("/dev/full", "x"); }) == ErrorCode::kEnvironment);
  CHECK(code_of([&] { io::MappedFile(dir.path() + "/none"); }) == ErrorCode::kBadInput);
  CHECK(code_of([&] { io::MappedFile{dir.path()}; }) == ErrorCode::kBadInput);
  CHECK(code_of([&] { io::MappedFile{"/dev/zero"}; }) == ErrorCode::kBadInput);
  CHECK(io::MappedFile("/dev/null").bytes().empty());
}

TEST_CASE("an empty file and a pipe are read to their end") {
  const test::TempDir dir;
  io::write_file(dir.file("empty"), "");
  CHECK(io::MappedFile(dir.file("empty")).bytes().empty());
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  REQUIRE(::write(ends[1], "through a pipe", 14) == 14);
  ::close(ends[1]);
  CHECK(io::MappedFile("/dev/fd/" + std::to_string(ends[0])).text() == "through a pipe");
  ::close(ends[0]);
}

}  // namespace
}  // namespace ngs

namespace ngs::io {

TEST_CASE("a content hash is XXH3-128 of the bytes, whatever the name") {
  const test::TempDir dir;
  CHECK(content_hash(dir.write("empty", "")).xxh3 == "99aa06d3014798d86001c324468d497f");  // xxhsum -H2 /dev/null
  CHECK(content_hash(dir.write("empty", "")).bytes == 0);
  const std::string large(3 << 20, 'x');  // more than one chunk
  const ContentHash a = content_hash(dir.write("a", large)), b = content_hash(dir.write("b", large));
  CHECK(a.bytes == large.size());
  CHECK(a.xxh3 == b.xxh3);
  CHECK(content_hash(dir.write("c", large + "y")).xxh3 != a.xxh3);
}

TEST_CASE("the hash of a folder changes with contents, names and structure, not with the order of creation") {
  const test::TempDir first, second;
  first.write("a.txt", "1");
  first.write("sub/b.txt", "2");
  second.write("sub/b.txt", "2");
  second.write("a.txt", "1");
  const ContentHash hash = content_hash(first.path());
  CHECK(hash.bytes == 2);
  CHECK(hash.xxh3 == content_hash(second.path()).xxh3);
  CHECK(hash.xxh3 == content_hash(first.path() + "/").xxh3);
  second.write("a.txt", "3");
  CHECK(hash.xxh3 != content_hash(second.path()).xxh3);
  second.write("a.txt", "1");
  second.write("c.txt", "");
  CHECK(hash.xxh3 != content_hash(second.path()).xxh3);
}

TEST_CASE("the hash of a missing path is an error") {
  CHECK_THROWS_WITH_AS(content_hash("/nowhere/x"), "/nowhere/x: cannot be read: No such file or directory", Error);
}

TEST_CASE("registered temporary files are removed; released ones and those beyond 64 are not") {
  const test::TempDir dir;
  const std::string kept = dir.write("kept", ""), lost = dir.write("lost", "");
  UnfinishedFile a, b;
  a.track(kept.c_str());
  b.track(lost.c_str());
  a.release();
  remove_unfinished_files();
  CHECK(std::filesystem::exists(kept));
  CHECK_FALSE(std::filesystem::exists(lost));
  std::vector<UnfinishedFile> many(100);
  for (UnfinishedFile& file : many) file.track(kept.c_str());  // beyond the 64 slots: must have no effect
  const std::string too_long = dir.path() + "/" + std::string(5000, 'x');
  UnfinishedFile c;
  c.track(too_long.c_str());
}

}  // namespace ngs::io
