// Round trips of the PLY reader and writer on random and on real models.
#include <doctest/doctest.h>

#include <filesystem>

#include "ngs/core/rng.h"
#include "ngs/edit/extract/extract_stage.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "support/ply_text.h"
#include "support/skip.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

/// Random bit patterns: NaNs, infinities and denormals among them.
GaussianCloud any_cloud(std::int64_t n, int degree) {
  GaussianCloud cloud;
  cloud.resize(n, degree);
  std::uint64_t at = 0;
  for (auto* column :
       {&cloud.position, &cloud.rotation, &cloud.log_scale, &cloud.logit_opacity, &cloud.sh_dc, &cloud.sh_rest})
    for (float& v : *column) {
      const std::uint32_t bits = std::uint32_t(rng_bits(std::uint64_t(degree), RngStream::kTest, at++));
      std::memcpy(&v, &bits, sizeof v);
    }
  return cloud;
}

std::string body_of(const std::string& file) { return file.substr(file.find("end_header\n") + 11); }

/// Checks that every column that `strict` and the model share is bit-identical in the given rows, in order.
void check_common_columns(const io::GaussianPly& model, const io::GaussianPly& strict,
                          const std::vector<std::uint8_t>& keep) {
  std::int64_t to = 0;
  for (std::int64_t i = 0; i < model.cloud.size(); ++i) {
    if (!keep[std::size_t(i)]) continue;
    for (std::size_t p = 0; p < strict.rows.properties.size(); ++p) {
      const int q = model.rows.find(strict.rows.properties[p].name);
      if (q < 0) continue;
      REQUIRE(std::memcmp(strict.rows.row(to) + strict.rows.offset[p],
                          model.rows.row(i) + model.rows.offset[std::size_t(q)], 4) == 0);
    }
    ++to;
  }
  CHECK(to == strict.cloud.size());
}

TEST_CASE("writing a model that was read gives the same bytes for random bit patterns") {
  const test::TempDir dir;
  for (int degree = 0; degree <= 3; ++degree)
    for (const std::int64_t n : {0, 1, 2, 4227, 5000}) {  // 4227 rows of 248 bytes: one buffer; 5000: two
      io::write_strict_ply(dir.file("a.ply"), any_cloud(n, degree), {});
      io::write_strict_ply(dir.file("b.ply"), io::read_gaussian_ply(dir.file("a.ply")), {});
      const std::string a = test::read_bytes(dir.file("a.ply"));
      CHECK(body_of(a).size() == std::size_t(n) * (17 + 3 * std::size_t(sh_rest_count(degree))) * 4);
      CHECK(a == test::read_bytes(dir.file("b.ply")));
    }
}

TEST_CASE("object and background files together contain every row exactly once and in order") {
  const test::TempDir dir;
  io::write_strict_ply(dir.file("model.ply"), any_cloud(3001, 2), {});
  const io::GaussianPly model = io::read_gaussian_ply(dir.file("model.ply"));
  std::vector<std::uint8_t> keep, rest;
  for (std::uint64_t i = 0; i < 3001; ++i) {
    keep.push_back(rng_uniform(5, RngStream::kTest, i) < 0.3);
    rest.push_back(!keep.back());
  }
  io::write_strict_ply(dir.file("o.ply"), model, keep);
  io::write_strict_ply(dir.file("b.ply"), model, rest);
  const io::GaussianPly object = io::read_gaussian_ply(dir.file("o.ply")),
                        background = io::read_gaussian_ply(dir.file("b.ply"));
  CHECK(object.cloud.size() + background.cloud.size() == 3001);
  check_common_columns(model, object, keep);
  check_common_columns(model, background, rest);
}

TEST_CASE("real models survive a round trip bit for bit") {
  const std::string scenes = NGS_SOURCE_DIR "/../shared/scenes/";
  const struct {
    const char* path;
    std::int64_t gaussians;
  } files[] = {
      {"bird/point_cloud.ply", 9070}, {"bird/point_cloud_floaters.ply", 35741}, {"flower/point_cloud.ply", 129065}};
  for (const auto& file : files)
    if (!std::filesystem::exists(scenes + file.path))
      return test::skip(std::string("no ../shared/scenes/") + file.path);
  const test::TempDir dir;
  for (const auto& file : files) {
    const io::GaussianPly model = io::read_gaussian_ply(scenes + file.path);
    CHECK(model.cloud.size() == file.gaussians);
    CHECK(model.cloud.sh_degree == 2);
    CHECK(model.health.excluded() == 0);
    io::write_strict_ply(dir.file("s.ply"), model, {});
    check_common_columns(model, io::read_gaussian_ply(dir.file("s.ply")),
                         std::vector<std::uint8_t>(std::size_t(file.gaussians), 1));
    CHECK(body_of(test::read_bytes(dir.file("s.ply"))) == body_of(test::read_bytes(scenes + file.path)));
  }
}

}  // namespace
}  // namespace ngs
