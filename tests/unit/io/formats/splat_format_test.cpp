#include "ngs/io/formats/splat_format.h"

#include <doctest/doctest.h>

#include <cmath>

#include "ngs/core/error.h"
#include "ngs/io/formats/axes.h"
#include "ngs/io/formats/compression/gzip.h"
#include "ngs/io/formats/compression/packed_model.h"
#include "ngs/io/formats/compression/zip_archive.h"
#include "ngs/io/formats/write_splat.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/math/sh.h"
#include "support/error_code.h"
#include "support/ply_text.h"
#include "support/random.h"
#include "support/splat_files.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

using io::SplatFormat;
using test::contains;

TEST_CASE("the format is detected from the content, or from the name if there is no signature") {
  const auto format = [](const char* name, const std::string& bytes) {
    return io::input_format(name, test::as_bytes(bytes));
  };
  CHECK(format("a.spz", "ply\nformat") == SplatFormat::kPly);
  CHECK(format("a.ply", "NGSP\x04") == SplatFormat::kSpz);
  CHECK(format("a.bin", "\x1f\x8b\x08") == SplatFormat::kSpz);
  CHECK(format("a.splat", "\x1f\x8b\x08") == SplatFormat::kSplat);
  CHECK(format("A.SPLAT", "") == SplatFormat::kSplat);
  CHECK(format("a.spz", "") == SplatFormat::kSpz);
  CHECK(format("a.zip", "PK\x03\x04") == SplatFormat::kSog);
  CHECK(format("a.ksplat", "\x01\x02") == SplatFormat::kKsplat);
  CHECK(format("a.splat", "glTF\x02") == SplatFormat::kGlb);
  CHECK(format("a.ply", "#usda 1.0") == SplatFormat::kUsda);
  CHECK(format("a.compressed.ply", "ply\r\n") == SplatFormat::kPly);
  CHECK(format("a.sog", "") == SplatFormat::kSog);
  CHECK(format("a.obj", "v 1 2 3") == SplatFormat::kPly);
}

TEST_CASE("the output format follows from the name, and labels are written to PLY only") {
  CHECK(io::output_format("x/object.spz") == SplatFormat::kSpz);
  CHECK(io::output_format("object.SPLAT") == SplatFormat::kSplat);
  CHECK(io::output_format("object.sog") == SplatFormat::kSog);
  CHECK(io::output_format("object.glb") == SplatFormat::kGlb);
  CHECK(io::output_format("a/object.compressed.ply") == SplatFormat::kCompressedPly);
  CHECK(io::output_format("object.ply") == SplatFormat::kPly);
  CHECK(io::output_format("object.usda") == SplatFormat::kUsda);
  for (const char* name : {"object.ksplat", "object.usd", "object.USDZ", "object.usdc"})
    CHECK_THROWS_AS(io::output_format(name), Error);
  CHECK(io::output_format("spz") == SplatFormat::kPly);
  CHECK_NOTHROW(io::require_ply_output("labelled.ply"));
  const Error e = test::thrown_by([&] { io::require_ply_output("labelled.spz"); });
  CHECK(e.code() == ErrorCode::kUsage);
  CHECK(std::string(e.what()).find("labelled.spz: a format without labels") == 0);
}

TEST_CASE("formats that are only written are errors as inputs") {
  const test::TempDir dir;
  for (const std::string format : {".usda"})
    for (const std::vector<std::uint8_t>& keep : {std::vector<std::uint8_t>{}, {0, 0, 0}}) {  // all rows, none
      CAPTURE(format);
      (void)io::write_splat(dir.file("m" + format), test::plain_cloud(3, 1, 1), keep);
      test::refused([&] { (void)io::read_gaussian_ply(dir.file("m" + format)); }, ErrorCode::kBadInput,
                    format + " can be written but not read");
    }
}

TEST_CASE("equal models give equal bytes in every format, and a model without rows is read back as one") {
  const GaussianCloud cloud = test::plain_cloud(40, 2, 13);
  const test::TempDir dir;
  for (const std::string format : {".compressed.ply", ".spz", ".sog", ".splat", ".glb"}) {
    CAPTURE(format);
    for (const char* name : {"a", "b"}) (void)io::write_splat(dir.file(name + format), cloud, {});
    CHECK(test::read_bytes(dir.file("a" + format)) == test::read_bytes(dir.file("b" + format)));
    if (format == ".splat" || format == ".glb") continue;  // their readers reject a model without rows
    (void)io::write_splat(dir.file("none" + format), cloud, std::vector<std::uint8_t>(40, 0));
    CHECK(io::read_gaussian_ply(dir.file("none" + format)).cloud.size() == 0);
  }
}

TEST_CASE("a model is turned upright and scaled in every format but PLY") {
  const test::TempDir dir;
  (void)io::write_splat(dir.file("m.ply"), test::plain_cloud(40, 1, 13), {});
  const io::GaussianPly model = io::read_gaussian_ply(dir.file("m.ply"));
  const auto mean = [](const std::vector<float>& values, std::size_t first) {
    double sum = 0;
    for (std::size_t i = first; i < values.size(); i += 3) sum += double(values[i]);
    return 3 * sum / double(values.size());
  };
  const GaussianCloud& before = model.cloud;
  for (const std::string format : {".ply", ".compressed.ply", ".spz", ".sog", ".splat", ".glb"}) {
    CAPTURE(format);
    (void)io::write_splat(dir.file("t" + format), {model, {}, nullptr, Vec3<double>{0, 0, 1}, 0.5});
    const GaussianCloud after = io::read_gaussian_ply(dir.file("t" + format)).cloud;
    const bool is_ply = format == ".ply";
    const double unit = is_ply ? 1 : 0.5;
    CHECK(mean(after.position, 0) == doctest::Approx(unit * mean(before.position, 0)).epsilon(0.01));
    CHECK(mean(after.position, 1) ==
          doctest::Approx(is_ply ? mean(before.position, 1) : -unit * mean(before.position, 2)).epsilon(0.01));
    CHECK(mean(after.log_scale, 0) == doctest::Approx(std::log(unit) + mean(before.log_scale, 0)).epsilon(0.01));
  }
}

using Matrix = std::array<std::array<double, 3>, 3>;

/// R diag(scale²) Rᵀ of a row.
Matrix covariance(const io::SplatRow& row) {
  const double w = row.rotation[0], x = row.rotation[1], y = row.rotation[2], z = row.rotation[3];
  const Matrix r = {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                     {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                     {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
  Matrix c{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) c[i][j] += r[i][k] * std::exp(2.0 * row.log_scale[k]) * r[j][k];
  return c;
}

TEST_CASE("a row converted to another frame has the mirrored ellipsoid and the same colours from mirrored directions") {
  test::Random random(4);
  io::SplatRow row;
  double length = 0;
  for (float& v : row.position) v = float(random.uniform(-1, 1));
  for (float& v : row.log_scale) v = float(random.uniform(-1, 1));
  for (float& v : row.sh_rest) v = float(random.uniform(-1, 1));
  for (float& v : row.rotation) {
    v = float(random.uniform(-1, 1));
    length += double(v) * v;
  }
  for (float& v : row.rotation) v /= float(std::sqrt(length));
  const double direction[3] = {0.48, -0.6, 0.64};
  for (int choice = 0; choice < 8; ++choice) {
    CAPTURE(choice);
    const io::AxisSigns signs = {choice & 1 ? -1.f : 1.f, choice & 2 ? -1.f : 1.f, choice & 4 ? -1.f : 1.f};
    io::SplatRow other = row;
    io::reverse_axes(other, signs);
    const Matrix before = covariance(row), after = covariance(other);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(other.position[i] == signs[i] * row.position[i]);
      for (std::size_t j = 0; j < 3; ++j)
        CHECK(after[i][j] == doctest::Approx(double(signs[i]) * double(signs[j]) * before[i][j]).epsilon(1e-5));
    }
    double basis[15], mirrored[15], seen = 0, seen_mirrored = 0;
    sh_rest_basis(3, Vec3<double>{direction[0], direction[1], direction[2]}, basis);
    sh_rest_basis(3, Vec3<double>{signs[0] * direction[0], signs[1] * direction[1], signs[2] * direction[2]}, mirrored);
    for (std::size_t k = 0; k < 15; ++k) {
      seen += basis[k] * row.sh_rest[3 * k];
      seen_mirrored += mirrored[k] * other.sh_rest[3 * k];
    }
    CHECK(seen_mirrored == doctest::Approx(seen).epsilon(1e-9));
    io::reverse_axes(other, signs);
    CHECK(other.rotation == row.rotation);
    CHECK(other.sh_rest == row.sh_rest);
  }
}

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
  Error e = test::thrown_by([&] { io::read_gaussian_ply(dir.write(name, bytes)); });
  CHECK(e.code() == ErrorCode::kBadInput);
  return e;
}

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
  const std::string capture = dir.write("c.zip", zip_of({"c/m.ply", "c/sparse/0/images.bin"}));
  CHECK(contains(io::read_gaussian_ply(capture).notes.back(), "not its photos and cameras: unpack it"));
}

TEST_CASE("an archive without a model is rejected with its contents and a hint") {
  const Error two = refusal_of("two.zip", zip_of({"a.ply", "b.ply"}));
  CHECK(contains(two.what(), "a zip archive of a.ply, b.ply"));
  CHECK(contains(two.remedy(), "unzip it"));
  CHECK(contains(refusal_of("none.zip", zip_of({"images/0.jpg", "notes.txt"})).what(), "images/0.jpg, notes.txt"));
  const std::string checkpoint = zip_of({"archive/data.pkl", "archive/data/0"});
  CHECK(contains(refusal_of("last.zip", checkpoint).what(), "a PyTorch checkpoint"));
  CHECK(contains(refusal_of("last.ckpt", checkpoint).what(), "a checkpoint of a trainer"));
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
