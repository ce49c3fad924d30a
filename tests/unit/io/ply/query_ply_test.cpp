#include "ngs/io/ply/query_ply.h"

#include <doctest/doctest.h>

#include "ngs/core/error.h"
#include "support/error_code.h"
#include "support/ply_text.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

QueryField sampled(std::size_t queries) {
  QueryField field;
  field.origin = {1e6 + 0.1, 0, -3};
  field.depth_span = 0.1;
  field.depth_epsilon = 1e-3;
  field.views = {{"a b.png", {1.5, 2, 30.25, 40}, 2, 3, 8, 4.2}, {"empty\n\"name\".png", {}, 0, 0, 8, 0}};
  for (std::size_t i = 0; i < queries; ++i) {
    const float v = float(i);
    field.position.insert(field.position.end(), {v, -v, 0.1f * v});
    field.uv.insert(field.uv.end(), {2 * v, 3 * v});
    field.view.push_back(int(i % 2));
    field.slot.push_back(int(i) * 7);
    field.depth.push_back(4 + v);
  }
  return field;
}

QueryField interpolated(std::size_t queries) {
  QueryField field = sampled(queries);
  field.features = 3;
  field.neighbours = 2;
  for (std::size_t i = 0; i < queries; ++i) {
    field.feature.insert(field.feature.end(), {0.5f, float(i), -1.f});
    field.neighbour.insert(field.neighbour.end(), {std::uint32_t(i), 4000000000u});
    field.weight.insert(field.weight.end(), {0.75f, 0.25f});
  }
  return field;
}

void check_equal(const QueryField& a, const QueryField& b) {
  CHECK(a.origin == b.origin);
  CHECK(a.depth_span == b.depth_span);
  CHECK(a.depth_epsilon == b.depth_epsilon);
  CHECK(a.position == b.position);
  CHECK(a.uv == b.uv);
  CHECK(a.view == b.view);
  CHECK(a.slot == b.slot);
  CHECK(a.depth == b.depth);
  CHECK(a.features == b.features);
  CHECK(a.feature == b.feature);
  CHECK(a.neighbours == b.neighbours);
  CHECK(a.neighbour == b.neighbour);
  CHECK(a.weight == b.weight);
  REQUIRE(a.views.size() == b.views.size());
  for (std::size_t v = 0; v < a.views.size(); ++v) {
    CHECK(a.views[v].name == b.views[v].name);
    CHECK(a.views[v].box.min_x == b.views[v].box.min_x);
    CHECK(a.views[v].box.max_y == b.views[v].box.max_y);
    CHECK(a.views[v].rows == b.views[v].rows);
    CHECK(a.views[v].cols == b.views[v].cols);
    CHECK(a.views[v].depth_samples == b.views[v].depth_samples);
    CHECK(a.views[v].mean_depth == b.views[v].mean_depth);
  }
}

std::string query_error_of(const std::string& file) {
  return test::bad_input([&] { io::parse_query_ply("q.ply", test::as_bytes(file)); });
}

TEST_CASE("sampled and interpolated queries are read back as written") {
  const test::TempDir dir;
  for (const std::size_t n : {std::size_t(0), std::size_t(1), std::size_t(5)}) {
    const QueryField fields[] = {sampled(n), interpolated(n)};
    for (const QueryField& field : fields) {
      io::write_query_ply(dir.file("q.ply"), field, {"ngs test"});
      check_equal(io::read_query_ply(dir.file("q.ply")), field);
      const std::string first = test::read_bytes(dir.file("q.ply"));
      io::write_query_ply(dir.file("q.ply"), io::read_query_ply(dir.file("q.ply")), {"ngs test"});
      CHECK(test::read_bytes(dir.file("q.ply")) == first);
    }
  }
}

TEST_CASE("a PLY with only x y z is a query field without views") {
  const test::PlyColumns points{
      "vertex", {{"x", io::PlyType::kFloat64}, {"y", io::PlyType::kFloat32}, {"z", io::PlyType::kInt8}}, {{1.5, 2, 3}}};
  const std::string file = test::ply_bytes({points}, io::PlyFormat::kAscii);
  const QueryField field = io::parse_query_ply("q.ply", test::as_bytes(file));
  CHECK(field.position == std::vector<float>{1.5f, 2, 3});
  CHECK(field.views.empty());
  CHECK(field.view.empty());
  CHECK(field.neighbours == 0);
}

TEST_CASE("damaged query files are rejected with the cause") {
  const test::TempDir dir;
  io::write_query_ply(dir.file("q.ply"), interpolated(3));
  const std::string good = test::read_bytes(dir.file("q.ply"));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string file = good;
    file.replace(file.find(from), from.size(), to);
    return query_error_of(file);
  };
  CHECK(query_error_of(good) == "");
  CHECK(with("property float x", "property float a").find("'x' is missing") != std::string::npos);
  CHECK(with("property float w_1", "property float v_1").find("1 properties w_*, expected 2") != std::string::npos);
  CHECK(with("\"rows\":2", "\"rows\":-").find("not JSON") != std::string::npos);
  CHECK(with("\"rows\":2", "\"raws\":2").find("rows: missing") != std::string::npos);
  CHECK(with("[1.5,2.0,", "[1.5,").find("box_px") != std::string::npos);
  QueryField stray = sampled(3);
  stray.view[2] = 2;
  io::write_query_ply(dir.file("stray.ply"), stray);
  CHECK_THROWS_AS(io::read_query_ply(dir.file("stray.ply")), Error);
  for (std::size_t n = 0; n < good.size(); ++n) CHECK(query_error_of(good.substr(0, n)) != "");
}

}  // namespace
}  // namespace ngs
