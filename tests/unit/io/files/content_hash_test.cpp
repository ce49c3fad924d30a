#include "ngs/io/files/content_hash.h"

#include <doctest/doctest.h>

#include <vector>

#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "support/temp_dir.h"

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
  first.write("a.txt", "1"), first.write("sub/b.txt", "2");
  second.write("sub/b.txt", "2"), second.write("a.txt", "1");
  const ContentHash hash = content_hash(first.path());
  CHECK(hash.bytes == 2);
  CHECK(hash.xxh3 == content_hash(second.path()).xxh3);
  CHECK(hash.xxh3 == content_hash(first.path() + "/").xxh3);
  second.write("a.txt", "3");
  CHECK(hash.xxh3 != content_hash(second.path()).xxh3);
  second.write("a.txt", "1"), second.write("c.txt", "");
  CHECK(hash.xxh3 != content_hash(second.path()).xxh3);
}

TEST_CASE("the hash of a missing path is an error") {
  CHECK_THROWS_WITH_AS(content_hash("/nowhere/x"), "/nowhere/x: cannot be read: No such file or directory", Error);
}

TEST_CASE("registered temporary files are removed; released ones and those beyond 64 are not") {
  const test::TempDir dir;
  const std::string kept = dir.write("kept", ""), lost = dir.write("lost", "");
  UnfinishedFile a, b;
  a.track(kept.c_str()), b.track(lost.c_str());
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
