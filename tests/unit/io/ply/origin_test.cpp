// Georeferenced models: world coordinates that float cannot represent.
#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "ngs/core/error.h"
#include "ngs/edit/extract/import_stage.h"
#include "ngs/io/formats/write_splat.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "support/ply_text.h"
#include "support/random.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

using test::PlyColumns;

constexpr int kRows = 100;
constexpr double kUtm[3] = {448262.3, 5411932.7, 35.2};

/// Gaussians of 2 cm within a metre, in double columns about UTM coordinates.
PlyColumns utm_model() {
  test::Random random(3);
  PlyColumns table = test::inria_columns(kRows, 0, true, io::PlyType::kFloat64);
  for (auto& row : table.rows) {
    for (std::size_t a = 0; a < 3; ++a) row[a] = kUtm[a] + random.uniform(-0.5, 0.5);
    for (const char* name : {"scale_0", "scale_1", "scale_2"})
      row[test::column_of(table, name)] = std::log(0.02) + random.uniform(-0.5, 0.5);
    row[test::column_of(table, "opacity")] = random.uniform(-2, 5);
  }
  return table;
}

io::GaussianPly parse_columns(const PlyColumns& table) {
  return io::parse_gaussian_ply("utm.ply", test::as_bytes(test::ply_bytes({table}, io::PlyFormat::kAscii)));
}

double world(const GaussianCloud& cloud, std::size_t row, std::size_t axis) {
  return cloud.origin[axis] + double(cloud.position[row * 3 + axis]);
}

std::size_t distinct(const GaussianCloud& cloud, std::size_t axis) {
  std::set<float> values;
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) values.insert(cloud.position[i * 3 + axis]);
  return values.size();
}

}  // namespace

TEST_CASE(
    "a strict PLY of a georeferenced model stores its origin in a comment and is read back in world coordinates") {
  const PlyColumns table = utm_model();
  const io::GaussianPly ply = parse_columns(table);
  const test::TempDir dir;
  const std::vector<std::string> notes = io::write_splat(dir.file("o.ply"), {ply, {}});
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("positions are relative to 448262") != std::string::npos);
  CHECK(test::read_bytes(dir.file("o.ply")).find("\ncomment ngs-origin 448262") != std::string::npos);
  const io::GaussianPly back = io::read_gaussian_ply(dir.file("o.ply"));
  for (std::size_t a = 0; a < 3; ++a) {
    CHECK(distinct(back.cloud, a) == kRows);
    for (std::size_t i = 0; i < kRows; ++i) CHECK(world(back.cloud, i, a) == world(ply.cloud, i, a));
    CHECK(std::abs(world(back.cloud, 5, a) - table.rows[5][a]) < 1e-7);
  }
  io::write_splat(dir.file("again.ply"), {back, {}});
  CHECK(test::read_bytes(dir.file("again.ply")) == test::read_bytes(dir.file("o.ply")));
}

TEST_CASE("every format keeps a georeferenced model's detail and reports the origin of its positions") {
  const io::GaussianPly ply = parse_columns(utm_model());
  const test::TempDir dir;
  for (const char* name : {"o.spz", "o.sog", "o.splat", "o.compressed.ply"}) {
    CAPTURE(name);
    const std::vector<std::string> notes = io::write_splat(dir.file(name), {ply, {}});
    REQUIRE(notes.size() == 1);
    CHECK(notes[0].find("relative to 448262") != std::string::npos);
    const GaussianCloud back = io::read_gaussian_ply(dir.file(name)).cloud;
    for (std::size_t a = 0; a < 3; ++a) CHECK(distinct(back, a) > kRows / 2);
  }
}

TEST_CASE("one distant row does not prevent detection of positions far from 0") {
  PlyColumns table = utm_model();
  for (std::size_t a = 0; a < 3; ++a) table.rows[0][a] = 0;
  const io::GaussianPly ply = parse_columns(table);
  CHECK(ply.cloud.origin[1] == doctest::Approx(kUtm[1]).epsilon(1e-6));
  for (std::size_t a = 0; a < 3; ++a) CHECK(distinct(ply.cloud, a) == kRows);
}

TEST_CASE("double positions that float represents well stay in world coordinates") {
  PlyColumns table = utm_model();
  for (auto& row : table.rows)
    for (std::size_t a = 0; a < 3; ++a) row[a] -= kUtm[a] - 20;
  const io::GaussianPly ply = parse_columns(table);
  CHECK(ply.cloud.origin[0] != 0);
  const test::TempDir dir;
  CHECK(io::write_splat(dir.file("o.ply"), {ply, {}}).empty());
  const io::GaussianPly back = io::read_gaussian_ply(dir.file("o.ply"));
  CHECK(back.cloud.origin == std::array<double, 3>{});
  CHECK(back.cloud.position[0] == doctest::Approx(table.rows[0][0]).epsilon(1e-6));
}

TEST_CASE("an edited georeferenced object is matched with or without the origin comment") {
  const io::GaussianPly ply = parse_columns(utm_model());
  const test::TempDir dir;
  std::vector<std::uint8_t> keep(kRows, 0);
  for (std::size_t i = 0; i < kRows; i += 2) keep[i] = 1;
  io::write_splat(dir.file("o.ply"), {ply, keep});
  std::string bytes = test::read_bytes(dir.file("o.ply"));
  const std::size_t comment = bytes.find("comment ngs-origin");
  bytes.erase(comment, bytes.find('\n', comment) + 1 - comment);
  dir.write("dropped.ply", bytes);
  for (const char* name : {"o.ply", "dropped.ply"}) {
    CAPTURE(name);
    const GaussianCloud edit = io::read_gaussian_ply(dir.file(name)).cloud;
    const ImportedEdit imported = import_edit(ply.cloud, keep, std::vector<float>(kRows, 0.5f), edit, {});
    CHECK(imported.matched == kRows / 2);
    for (std::size_t i = 0; i < kRows; ++i) CHECK(imported.fixed[i] == float(keep[i]));
  }
}

TEST_CASE(
    "an edit that comes back in a format that rounds positions is matched by the nearest rows, a moved one is not") {
  PlyColumns table = utm_model();
  for (const bool far : {true, false}) {
    CAPTURE(far);
    if (!far)
      for (auto& row : table.rows)
        for (std::size_t a = 0; a < 3; ++a) row[a] -= kUtm[a];
    const io::GaussianPly ply = parse_columns(table);
    std::vector<std::uint8_t> keep(kRows, 0);
    for (std::size_t i = 0; i < kRows; i += 2) keep[i] = 1;
    const test::TempDir dir;
    for (const char* name : {"o.spz", "o.sog", "o.compressed.ply"}) {
      CAPTURE(name);
      io::write_splat(dir.file(name), {ply, keep});
      GaussianCloud edit = io::read_gaussian_ply(dir.file(name)).cloud;
      const ImportedEdit imported = import_edit(ply.cloud, keep, std::vector<float>(kRows, 0.5f), edit, {});
      CHECK(imported.by_nearest);
      CHECK(imported.matched == kRows / 2);
      for (std::size_t i = 0; i < kRows; ++i) CHECK(imported.fixed[i] == float(keep[i]));
      for (std::size_t i = 0; i < std::size_t(edit.size()); ++i) edit.position[3 * i] += 0.004f;
      CHECK_THROWS_AS(import_edit(ply.cloud, keep, std::vector<float>(kRows, 0.5f), edit, {}), Error);
    }
  }
}

}  // namespace ngs
