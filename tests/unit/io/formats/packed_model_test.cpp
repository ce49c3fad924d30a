// Models in gzip and zip wrappers, and files that users pass instead of a model.
#include "ngs/io/formats/compression/packed_model.h"

#include <doctest/doctest.h>

#include "ngs/core/error.h"
#include "ngs/io/formats/compression/gzip.h"
#include "ngs/io/formats/compression/zip_archive.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "support/error_code.h"
#include "support/ply_text.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

std::string model_bytes() { return test::ply_bytes({test::inria_columns(4, 1)}, io::PlyFormat::kBinaryLittle); }

std::vector<std::uint8_t> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }
std::string text_of(const std::vector<std::uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

std::string zip_of(const std::vector<std::string>& names) {
  std::vector<io::ZipEntry> entries;
  for (const std::string& name : names) entries.push_back({name, bytes_of(model_bytes())});
  return text_of(io::zip(entries));
}

Error refusal_of(const std::string& name, const std::string& bytes) {
  const test::TempDir dir;
  const Error e = test::thrown_by([&] { io::read_gaussian_ply(dir.write(name, bytes)); });
  CHECK(e.code() == ErrorCode::kBadInput);
  return e;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a gzipped PLY and the only PLY of a zip archive are read as the PLY itself") {
  const test::TempDir dir;
  const GaussianCloud plain = io::read_gaussian_ply(dir.write("m.ply", model_bytes())).cloud;
  for (const std::string& path : {dir.write("m.ply.gz", text_of(io::gzip(test::as_bytes(model_bytes())))),
                                  dir.write("luma.zip", zip_of({"gs_scene.ply"})),
                                  dir.write("mac.zip", zip_of({"a/Scene.PLY", "__MACOSX/a/._Scene.PLY"}))}) {
    CAPTURE(path);
    const io::GaussianPly ply = io::read_gaussian_ply(path);
    CHECK(ply.cloud.position == plain.position);
    CHECK(ply.cloud.sh_rest == plain.sh_rest);
    REQUIRE(!ply.notes.empty());
    CHECK(contains(ply.notes.back(), "which is read"));
  }
}

TEST_CASE("an archive without a model is rejected with its contents and a hint") {
  const Error two = refusal_of("two.zip", zip_of({"a.ply", "b.ply"}));
  CHECK(contains(two.what(), "a zip archive of a.ply, b.ply"));
  CHECK(contains(two.remedy(), "unzip it"));
  CHECK(contains(refusal_of("none.zip", zip_of({"images/0.jpg", "notes.txt"})).what(), "images/0.jpg, notes.txt"));
  CHECK(
      contains(refusal_of("last.ckpt", zip_of({"archive/data.pkl", "archive/data/0"})).what(), "a PyTorch checkpoint"));
  CHECK(contains(refusal_of("s.zip", zip_of({"lod-meta.json", "0_0/meta.json"})).what(), "a streamed .sog"));
  const Error other = refusal_of("m.obj.gz", text_of(io::gzip(test::as_bytes(std::string(99, 'v')))));
  CHECK(contains(other.what(), "without the signature NGSP"));
  CHECK(contains(other.remedy(), "gunzip"));
}

TEST_CASE("a PLY that unpacks to more than 64 times its file size is rejected early") {
  const std::string zeros = model_bytes() + std::string(std::size_t(64) << 20, '\0');
  CHECK(contains(refusal_of("bomb.ply.gz", text_of(io::gzip(test::as_bytes(zeros)))).what(), "unpacks to more than"));
}

TEST_CASE("a truncated gzipped PLY is rejected") {
  std::string gz = text_of(io::gzip(test::as_bytes(model_bytes())));
  gz.resize(gz.size() - 9);
  CHECK(contains(refusal_of("m.ply.gz", gz).what(), "gzip stream"));
}

TEST_CASE("files of an unpacked or streamed .sog, archives, LFS pointers and web pages are identified in the error") {
  const Error sog = refusal_of("meta.json", R"({"version":2,"count":4,"means":{},"quats":{},"sh0":{}})");
  CHECK(contains(sog.what(), "meta.json: an unpacked .sog, expected a .sog in one file"));
  CHECK(contains(sog.remedy(), "splat-transform"));
  CHECK(contains(refusal_of("lod-meta.json", R"({"lodLevels":1,"filenames":[],"tree":{}})").what(), "a streamed .sog"));
  CHECK(contains(refusal_of("m.7z", "7z\xbc\xaf\x27\x1c rest").what(), "a 7z archive"));
  CHECK(contains(refusal_of("m.ply", "version https://git-lfs.github.com/spec/v1\n").remedy(), "git lfs pull"));
  CHECK(contains(refusal_of("m.ply", "<!DOCTYPE html><html>").what(), "a web page"));
}

}  // namespace ngs
