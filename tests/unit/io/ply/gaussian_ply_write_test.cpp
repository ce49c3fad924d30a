#include <doctest/doctest.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/core/error.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "support/error_code.h"
#include "support/ply_text.h"
#include "support/temp_dir.h"

namespace {
int forgotten = 0;  // number of times that pages of a mapped file were released
}

/// Replaces the C library's function: a reader releases pages at the beginning and end of every pass over a file.
extern "C" int madvise(void* at, std::size_t bytes, int advice) noexcept {
  forgotten += advice == MADV_DONTNEED;
  return int(syscall(SYS_madvise, at, bytes, advice));
}

namespace ngs {
namespace {

using io::PlyFormat;
using io::PlyType;
using test::PlyColumns;

constexpr PlyFormat kWrittenFormats[] = {PlyFormat::kAscii, PlyFormat::kBinaryLittle, PlyFormat::kBinaryBig};

io::GaussianPly written(const std::string& file) { return io::parse_gaussian_ply("model.ply", test::as_bytes(file)); }

TEST_CASE("unusable rows are counted and every writer copies them bit for bit") {
  PlyColumns table = test::inria_columns(4, 3);
  table.rows[1][0] = std::numeric_limits<double>::quiet_NaN();
  table.rows[2][test::column_of(table, "scale_1")] = std::numeric_limits<double>::infinity();
  std::string file = test::ply_bytes({table}, PlyFormat::kBinaryLittle);
  const std::size_t body = file.find("end_header\n") + 11;
  const std::string payload("\x01\x02\xc0\x7f", 4);  // a NaN with a payload
  file.replace(body + 248, 4, payload);
  const io::GaussianPly ply = written(file);
  CHECK(ply.health.non_finite == 1);
  CHECK(ply.health.absurd_scale == 1);

  const test::TempDir dir;
  io::write_strict_ply(dir.file("strict.ply"), ply, {});
  const std::string strict = test::read_bytes(dir.file("strict.ply"));
  REQUIRE(strict.size() > 4 * 248);
  CHECK(strict.substr(strict.size() - 4 * 248) == file.substr(body));
}

TEST_CASE("strict PLY at degree 3: 62 floats per row, vertex count in the third line, rows selected by a mask") {
  const PlyColumns table = test::inria_columns(5, 3, false);
  const std::string file = test::ply_bytes({table}, PlyFormat::kAscii, {"comment SplatRenderMode: mip"});
  const io::GaussianPly ply = written(file);
  const test::TempDir dir;
  io::write_strict_ply(dir.file("part.ply"), ply, {1, 0, 0, 1, 0});
  const std::string text = test::read_bytes(dir.file("part.ply"));
  CHECK(text.starts_with("ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\n"));
  CHECK(text.find("comment SplatRenderMode: mip\n") != std::string::npos);
  CHECK(text.size() - (text.find("end_header\n") + 11) == 2 * 248);
  const io::GaussianPly part = io::read_gaussian_ply(dir.file("part.ply"));
  CHECK(part.cloud.antialiased);
  REQUIRE(part.cloud.size() == 2);
  for (std::size_t k = 0; k < 45; ++k) {
    CHECK(part.cloud.sh_rest[k] == ply.cloud.sh_rest[k]);
    CHECK(part.cloud.sh_rest[45 + k] == ply.cloud.sh_rest[3 * 45 + k]);
  }
  CHECK_THROWS_AS(io::write_strict_ply(dir.file("x.ply"), ply, {1}), std::logic_error);
}

LabelColumns labels_of(std::size_t n, float base) {
  LabelColumns labels;
  for (std::size_t i = 0; i < n; ++i) {
    const float v = std::fmod(base + 0.01f * float(i), 1.f);
    labels.label.push_back(v > 0.5f ? 1.f : 0.f);
    labels.prob.push_back(v);
    labels.variance.push_back(v * v);
    labels.views.push_back(float(i));
    labels.boundary.push_back(i % 2 == 0 ? 1.f : 0.f);
  }
  return labels;
}

TEST_CASE("a labelled PLY keeps the input's columns bit for bit, and its labels are read back") {
  PlyColumns table = test::inria_columns(3, 1);
  test::add_column(table, 5, "mask", PlyType::kUint8, 200);
  test::add_column(table, table.properties.size(), "weight", PlyType::kFloat64, 0.1);
  for (const PlyFormat format : kWrittenFormats) {
    const std::string file = test::ply_bytes({table}, format, {"comment kept"});
    const io::GaussianPly ply = written(file);
    const test::TempDir dir;
    const std::vector<io::NamedLabels> objects = {{"the bird", labels_of(3, 0.495f)}};
    io::LabelledWrite options{.history = {"ngs test"}};
    io::write_labelled_ply(dir.file("l.ply"), ply, objects, options);
    const io::GaussianPly back = io::read_gaussian_ply(dir.file("l.ply"));
    CHECK(back.object == "the bird");
    CHECK(back.objects.empty());
    CHECK(back.labels.prob == objects[0].columns.prob);
    CHECK(back.labels.boundary == objects[0].columns.boundary);
    CHECK(back.file.comments() == std::vector<std::string>{"kept", "ngs-objects [\"the bird\"]", "ngs test"});
    REQUIRE(back.rows.properties.size() == table.properties.size() + 5);
    for (std::size_t p = 0; p < table.properties.size(); ++p) {
      CHECK(back.rows.properties[p].name == table.properties[p].first);
      CHECK(back.rows.properties[p].type == table.properties[p].second);
    }
    for (std::int64_t i = 0; i < 3; ++i)
      CHECK(std::equal(ply.rows.row(i), ply.rows.row(i) + ply.rows.row_bytes, back.rows.row(i)));
    // Labelling a second time replaces the columns; the bytes are equal.
    io::write_labelled_ply(dir.file("again.ply"), back, objects);
    const io::GaussianPly again = io::read_gaussian_ply(dir.file("again.ply"));
    CHECK(again.rows.properties.size() == back.rows.properties.size());
    CHECK(std::equal(again.rows.row(0), again.rows.row(0) + 3 * again.rows.row_bytes, back.rows.row(0)));
  }
}

TEST_CASE("ngs_weight is written only with the labels to which it belongs, and dropped with other labels") {
  const io::GaussianPly ply = written(test::ply_bytes({test::inria_columns(3, 1)}, PlyFormat::kBinaryLittle));
  const test::TempDir dir;
  const std::vector<io::NamedLabels> objects = {{"the bird", labels_of(3, 0.495f)}};
  const std::vector<float> weight = {0, 12.5f, 1e6f};
  io::LabelledWrite options{.weight = weight};
  io::write_labelled_ply(dir.file("with.ply"), ply, objects, options);
  const io::GaussianPly with = io::read_gaussian_ply(dir.file("with.ply"));
  CHECK(with.weight == weight);
  io::write_labelled_ply(dir.file("other.ply"), with, objects);
  const io::GaussianPly other = io::read_gaussian_ply(dir.file("other.ply"));
  CHECK(other.weight.empty());
  CHECK(other.rows.properties.size() + 1 == with.rows.properties.size());
}

TEST_CASE("filter_3D is applied exactly once, and both outputs have the comment for rendering") {
  PlyColumns table = test::inria_columns(3, 1);
  test::add_column(table, 4, "filter_3D", PlyType::kFloat32, 0.5);
  const std::string file = test::ply_bytes({table}, PlyFormat::kBinaryLittle);
  const io::GaussianPly ply = written(file);
  const test::TempDir dir;
  const std::vector<io::NamedLabels> objects = {{"cup", labels_of(3, 0.4f)}};
  io::write_labelled_ply(dir.file("l.ply"), ply, objects);
  io::write_strict_ply(dir.file("s.ply"), ply, {});
  for (const char* name : {"l.ply", "s.ply"}) {
    CAPTURE(name);
    const io::GaussianPly back = io::read_gaussian_ply(dir.file(name));
    CHECK(back.rows.find("filter_3D") < 0);
    CHECK(back.cloud.log_scale == ply.cloud.log_scale);
    CHECK(back.cloud.logit_opacity == ply.cloud.logit_opacity);
    CHECK(back.cloud.antialiased);
  }
}

TEST_CASE("several objects: one suffixed label set each, numbered if suffixes are equal, and their union without one") {
  const std::string file = test::ply_bytes({test::inria_columns(4, 0)}, PlyFormat::kBinaryLittle);
  const io::GaussianPly ply = written(file);
  const test::TempDir dir;
  const std::vector<io::NamedLabels> objects = {{"red cup", labels_of(4, 0.48f)}, {"7", labels_of(4, 0.2f)}};
  io::write_labelled_ply(dir.file("l.ply"), ply, objects);
  const io::GaussianPly back = io::read_gaussian_ply(dir.file("l.ply"));
  REQUIRE(back.objects.size() == 2);
  CHECK(back.objects[0].object == "red cup");
  CHECK(back.objects[1].object == "7");
  CHECK(back.objects[1].columns.variance == objects[1].columns.variance);
  CHECK(back.labels.prob == objects[0].columns.prob);  // the larger of the two everywhere
  CHECK(back.rows.find("ngs_prob_red_cup") > 0);
  // Written with one object: the suffixed sets are removed.
  io::write_labelled_ply(dir.file("one.ply"), back, std::vector<io::NamedLabels>{objects[1]});
  const io::GaussianPly one = io::read_gaussian_ply(dir.file("one.ply"));
  CHECK(one.objects.empty());
  CHECK(one.rows.properties.size() == ply.rows.properties.size() + 5);

  const std::vector<io::NamedLabels> clash = {{"a b", objects[0].columns}, {"a_b", objects[1].columns}};
  io::write_labelled_ply(dir.file("x.ply"), ply, clash);
  const io::GaussianPly both = io::read_gaussian_ply(dir.file("x.ply"));
  REQUIRE(both.objects.size() == 2);
  CHECK(both.objects[0].object == "a b");
  CHECK(both.objects[1].object == "a_b");
  CHECK(both.objects[1].columns.variance == objects[1].columns.variance);
  CHECK(both.rows.find("ngs_prob_a_b.2") > 0);
}

TEST_CASE("an object name with path components is rejected, in a comment or a column name") {
  const test::TempDir dir;
  const std::string file = test::ply_bytes({test::inria_columns(2, 0)}, PlyFormat::kBinaryLittle);
  const io::GaussianPly ply = written(file);
  const auto refused = [&](const std::vector<io::NamedLabels>& objects) {
    io::write_labelled_ply(dir.file("l.ply"), ply, objects);
    try {
      io::read_gaussian_ply(dir.file("l.ply"));
      return false;
    } catch (const Error& e) {
      return e.code() == ErrorCode::kBadInput && std::string(e.what()).find("can be a folder") != std::string::npos;
    }
  };
  for (const std::string name : {"../evil", "/evil", "a/b", "..", "."}) {
    CAPTURE(name);
    CHECK(refused({{name, labels_of(2, 0.2f)}}));
    CHECK(refused({{"cup", labels_of(2, 0.2f)}, {name, labels_of(2, 0.2f)}}));
  }
  CHECK_FALSE(refused({{"-x", labels_of(2, 0.2f)}, {"..cup", labels_of(2, 0.2f)}}));
  PlyColumns table = test::inria_columns(2, 0);
  test::add_column(table, table.properties.size(), "ngs_label_..", PlyType::kFloat32, 1);
  CHECK_THROWS_AS(written(test::ply_bytes({table}, PlyFormat::kBinaryLittle)),
                  Error);  // without the comment ngs-objects
}

TEST_CASE("the columns of many objects are read in one pass over the file") {
  const test::TempDir dir;
  const std::string file = test::ply_bytes({test::inria_columns(2000, 0)}, PlyFormat::kBinaryLittle);
  const io::GaussianPly model = written(file);
  int passes[2];
  for (const int count : {2, 60}) {
    std::vector<io::NamedLabels> objects;
    for (int k = 0; k < count; ++k) objects.push_back({"part " + std::to_string(k), labels_of(2000, 0.01f * float(k))});
    io::write_labelled_ply(dir.file("l.ply"), model, objects);
    forgotten = 0;
    const io::GaussianPly ply = io::read_gaussian_ply(dir.file("l.ply"));
    passes[count == 60] = forgotten / 2;
    REQUIRE(int(ply.objects.size()) == count);
    for (const int k : {0, count - 1})
      CHECK(ply.objects[std::size_t(k)].columns.prob == objects[std::size_t(k)].columns.prob);
  }
  CHECK(passes[0] > 0);
  CHECK(passes[1] == passes[0]);
}

TEST_CASE("an edited cloud overwrites only usable rows; rows may be split and removed") {
  PlyColumns table = test::inria_columns(4, 1, true, PlyType::kFloat64);
  test::add_column(table, 0, "tag", PlyType::kInt32, 0);
  for (std::size_t i = 0; i < 4; ++i) table.rows[i][0] = double(100 + i);
  table.rows[2][1] = std::numeric_limits<double>::quiet_NaN();
  table.rows[0][2] = 0.1;  // not a float: must be kept where it is not edited
  const std::string file = test::ply_bytes({table}, PlyFormat::kBinaryLittle);
  const io::GaussianPly ply = written(file);
  const test::TempDir dir;

  GaussianCloud edited = ply.cloud;
  for (std::size_t i = 0; i < 4; ++i) {
    edited.log_scale[i * 3] = 9;
    edited.sh_rest[i * 9 + 1] = 8;  // coefficient 0 of green: f_rest_3
  }
  io::LabelledWrite options{.edited = &edited};
  const std::vector<io::NamedLabels> four = {{"object", labels_of(4, 0)}};
  io::write_labelled_ply(dir.file("edit.ply"), ply, four, options);
  const io::GaussianPly back = io::read_gaussian_ply(dir.file("edit.ply"));
  for (std::int64_t i = 0; i < 4; ++i) {
    const bool usable = i != 2;
    CHECK(back.rows.column("scale_0").value(i) ==
          (usable ? 9 : table.rows[std::size_t(i)][test::column_of(table, "scale_0")]));
    CHECK(back.rows.column("f_rest_3").value(i) ==
          (usable ? 8 : table.rows[std::size_t(i)][test::column_of(table, "f_rest_3")]));
    CHECK(back.rows.column("f_rest_1").value(i) == table.rows[std::size_t(i)][test::column_of(table, "f_rest_1")]);
  }
  CHECK(back.rows.column("y").value(0) == 0.1);

  GaussianCloud split = edited;  // rows 3, 0, 0
  split.resize(3, 1);
  const std::vector<std::int64_t> source_row = {3, 0, 0};
  options.edited = &split;
  options.source_row = source_row;
  const std::vector<io::NamedLabels> three = {{"object", labels_of(3, 0)}};
  const std::vector<std::uint8_t> state = {1, 0, 1};
  options.state = state;
  io::write_labelled_ply(dir.file("split.ply"), ply, three, options);
  const io::GaussianPly parts = io::read_gaussian_ply(dir.file("split.ply"));
  REQUIRE(parts.cloud.size() == 3);
  CHECK(parts.rows.column("tag").value(0) == 103);
  CHECK(parts.rows.column("tag").value(2) == 100);
  CHECK(parts.cloud.log_scale[3] == 9);
  CHECK(parts.state == state);
  CHECK(parts.rows.properties.back().name == "state");
  CHECK(parts.rows.properties.back().type == PlyType::kUint8);
}

TEST_CASE("writing is deterministic, and a failed write leaves no file") {
  const std::string file = test::ply_bytes({test::inria_columns(7, 2)}, PlyFormat::kBinaryLittle);
  const io::GaussianPly ply = written(file);
  const test::TempDir dir;
  io::write_strict_ply(dir.file("a.ply"), ply, {});
  io::write_strict_ply(dir.file("b.ply"), ply, {});
  CHECK(test::read_bytes(dir.file("a.ply")) == test::read_bytes(dir.file("b.ply")));
  test::refused([&] { io::write_strict_ply(dir.path() + "/no/such/folder.ply", ply, {}); }, ErrorCode::kEnvironment,
                "no/such/folder.ply");
}

TEST_CASE("a column added to a strict file follows the Inria record, for the kept rows") {
  const io::GaussianPly ply = written(test::ply_bytes({test::inria_columns(3, 1)}, PlyFormat::kBinaryLittle));
  const test::TempDir dir;
  const std::vector<float> values{0, 1, 0.5f};
  io::write_strict_ply(dir.file("a.ply"), ply.cloud, {1, 0, 1}, {}, io::AddedColumn{"ngs_filled", values});
  const io::GaussianPly back = io::read_gaussian_ply(dir.file("a.ply"));
  REQUIRE(back.rows.rows == 2);
  CHECK(back.rows.properties.back().name == "ngs_filled");
  const io::PlyColumn column = back.rows.column("ngs_filled");
  CHECK(column.value(0) == 0);
  CHECK(column.value(1) == 0.5);
  CHECK(back.cloud.sh_rest.size() == 18);
  CHECK(back.cloud.position[3] == ply.cloud.position[6]);
  CHECK_THROWS_AS(io::write_strict_ply(dir.file("b.ply"), ply.cloud, {}, {}, io::AddedColumn{"x", {values.data(), 2}}),
                  std::logic_error);
}

}  // namespace
}  // namespace ngs
