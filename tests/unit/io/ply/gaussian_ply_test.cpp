#include "ngs/io/ply/gaussian_ply.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "ngs/core/error.h"
#include "support/error_code.h"
#include "support/ply_text.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

using io::PlyFormat;
using io::PlyType;
using test::PlyColumns;

constexpr PlyFormat kFormats[] = {PlyFormat::kAscii, PlyFormat::kBinaryLittle, PlyFormat::kBinaryBig};

io::GaussianPly parse(const std::string& file) { return io::parse_gaussian_ply("model.ply", test::as_bytes(file)); }

std::string error_of(const std::string& file) {
  return test::bad_input([&] { parse(file); });
}

/// Expected result for `table`, element by element and by column name.
void check_cloud(const GaussianCloud& cloud, const PlyColumns& table) {
  const auto at = [&](std::size_t i, const std::string& name) {
    return float(table.rows[i][test::column_of(table, name)]);
  };
  REQUIRE(cloud.size() == std::int64_t(table.rows.size()));
  const int rest = cloud.rest_count();
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    CHECK(cloud.position[i * 3] == at(i, "x"));
    CHECK(cloud.position[i * 3 + 2] == at(i, "z"));
    CHECK(cloud.logit_opacity[i] == at(i, "opacity"));
    for (int k = 0; k < 3; ++k) CHECK(cloud.sh_dc[i * 3 + std::size_t(k)] == at(i, "f_dc_" + std::to_string(k)));
    for (int k = 0; k < 4; ++k) CHECK(cloud.rotation[i * 4 + std::size_t(k)] == at(i, "rot_" + std::to_string(k)));
    CHECK(cloud.log_scale[i * 3 + 1] == at(i, "scale_1"));
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < rest; ++k)
        CHECK(cloud.sh_rest[(i * std::size_t(rest) + std::size_t(k)) * 3 + std::size_t(c)] ==
              at(i, "f_rest_" + std::to_string(c * rest + k)));
  }
}

TEST_CASE("every SH degree is read in every PLY format, with any number of rows") {
  for (const PlyFormat format : kFormats)
    for (int degree = 0; degree <= 3; ++degree)
      for (const int n : {0, 1, 2, 300}) {
        CAPTURE(int(format));
        CAPTURE(degree);
        const PlyColumns table = test::inria_columns(n, degree);
        const std::string file = test::ply_bytes({table}, format);
        const io::GaussianPly ply = parse(file);
        CHECK(ply.cloud.sh_degree == degree);
        CHECK(ply.health.excluded() == 0);
        CHECK(ply.labels.label.empty());
        check_cloud(ply.cloud, table);
      }
}

TEST_CASE("a model without normals, with CRLF lines and a padded count is read by name") {
  const PlyColumns table = test::inria_columns(3, 1, false);
  for (const PlyFormat format : kFormats) {
    std::string file = test::ply_bytes({table}, format, {"obj_info made by hand"}, "\r\n");
    file.replace(file.find("vertex 3"), 8, "vertex     3    ");
    const io::GaussianPly ply = parse(file);
    check_cloud(ply.cloud, table);
  }
}

TEST_CASE("foreign columns in the middle or at the end do not affect other columns") {
  PlyColumns table = test::inria_columns(3, 3);
  test::add_column(table, test::column_of(table, "scale_0"), "mask", PlyType::kFloat32, 77);
  test::add_column(table, 3, "tag", PlyType::kUint8, 9);  // misaligns every following column
  for (int k = 0; k < 16; ++k)
    test::add_column(table, table.properties.size(), "obj_dc_" + std::to_string(k), PlyType::kFloat32, 55);
  for (const PlyFormat format : kFormats) check_cloud(parse(test::ply_bytes({table}, format)).cloud, table);
}

TEST_CASE("columns in reverse order are found by name") {
  PlyColumns table = test::inria_columns(2, 2);
  std::reverse(table.properties.begin(), table.properties.end());
  for (auto& row : table.rows) std::reverse(row.begin(), row.end());
  check_cloud(parse(test::ply_bytes({table}, PlyFormat::kBinaryLittle)).cloud, table);
}

TEST_CASE("elements before and after the Gaussians are skipped") {
  const PlyColumns table = test::inria_columns(2, 0);
  const PlyColumns camera{"camera", {{"f", PlyType::kFloat64}, {"id", PlyType::kUint8}}, {{1.5, 3}, {2.5, 4}, {3, 5}}};
  const PlyColumns empty{"nothing", {}, {}};
  for (const PlyFormat format : kFormats) {
    const std::string file = test::ply_bytes({camera, empty, table, camera}, format);
    // The last element has the name of the first.
    CHECK(error_of(file).find("twice") != std::string::npos);
    PlyColumns last = camera;
    last.element = "frame";
    const std::string good = test::ply_bytes({camera, empty, table, last}, format);
    const io::GaussianPly ply = parse(good);
    check_cloud(ply.cloud, table);
    CHECK(ply.notes.size() == 3);
  }
}

TEST_CASE("list properties are skipped in every format") {
  // One row: list of 2 ints, then the scalars of a degree 0 model.
  const PlyColumns table = test::inria_columns(1, 0, false);
  for (const PlyFormat format : kFormats) {
    std::string file = test::ply_bytes({table}, format);
    file.insert(file.find("property"), "property list uchar int ids\n");
    const std::size_t body = file.find("end_header\n") + 11;
    if (format == PlyFormat::kAscii)
      file.insert(body, "2 5 6 ");
    else
      file.insert(body, std::string("\x02", 1) + std::string(8, '\x07'));
    const io::GaussianPly ply = parse(file);
    check_cloud(ply.cloud, table);
    CHECK(ply.rows.properties.size() == table.properties.size());
  }
}

TEST_CASE("double positions near 0 are read unchanged, far from 0 relative to their centre") {
  PlyColumns table = test::inria_columns(2, 0, true, PlyType::kFloat64);
  for (const PlyFormat format : kFormats) {
    const io::GaussianPly near = parse(test::ply_bytes({table}, format));
    CHECK(near.cloud.origin == std::array<double, 3>{});
    check_cloud(near.cloud, table);
  }
  table.rows[0][0] = 500000.0625;
  table.rows[1][0] = 500000.0635;  // 1 mm apart: float spacing here is 31 mm
  const io::GaussianPly far = parse(test::ply_bytes({table}, PlyFormat::kBinaryLittle));
  const double a = far.cloud.origin[0] + double(far.cloud.position[0]);
  const double b = far.cloud.origin[0] + double(far.cloud.position[3]);
  CHECK(a == doctest::Approx(500000.0625).epsilon(1e-15));
  CHECK(b - a == doctest::Approx(0.001).epsilon(1e-5));
}

TEST_CASE("a 2DGS model is read as flat Gaussians, with a note") {
  PlyColumns table = test::inria_columns(2, 0);
  test::remove_column(table, "scale_2");
  const std::string file = test::ply_bytes({table}, PlyFormat::kBinaryLittle);
  const io::GaussianPly ply = parse(file);
  const float least = std::min(ply.cloud.log_scale[0], ply.cloud.log_scale[1]);
  CHECK(ply.cloud.log_scale[2] == doctest::Approx(least - std::log(1000.f)));
  CHECK(ply.notes.size() == 1);
}

TEST_CASE("render comments of a model are applied") {
  const PlyColumns table = test::inria_columns(1, 0);
  const auto antialiased = [&](const std::string& comment) {
    const std::string file = test::ply_bytes({table}, PlyFormat::kBinaryLittle, {"comment " + comment});
    return parse(file).cloud.antialiased;
  };
  CHECK(antialiased("SplatRenderMode: mip"));
  CHECK(antialiased("antialiased 1"));
  CHECK(antialiased("train_flags antialiasing"));
  CHECK_FALSE(antialiased("train_flags exposure"));
  CHECK_FALSE(antialiased("SplatRenderMode: default"));
  CHECK_FALSE(antialiased("antialiased 0"));
  CHECK_FALSE(antialiased("made on a chip in 2011"));
}

TEST_CASE("Gaussians that SuperSplat marks as deleted are counted in a note") {
  PlyColumns table = test::inria_columns(4, 0);
  table.properties.push_back({"state", io::PlyType::kUint8});
  const double states[] = {4, 0, 5, 1};
  for (std::size_t i = 0; i < 4; ++i) table.rows[i].push_back(states[i]);
  const io::GaussianPly ply = parse(test::ply_bytes({table}, PlyFormat::kBinaryLittle));
  REQUIRE(ply.notes.size() == 1);
  CHECK(ply.notes[0].find("2 Gaussians are marked as deleted (state 4 of SuperSplat)") == 0);
}

TEST_CASE("filter_3D of Mip-Splatting becomes part of scales and opacities, in every format") {
  constexpr double kFilter[] = {0.0, 0.02, 3.0, 1e-9};
  PlyColumns table = test::inria_columns(4, 1);
  const auto cell = [&](std::size_t i, const std::string& name) -> double& {
    return table.rows[i][test::column_of(table, name)];
  };
  for (std::size_t i = 0; i < 4; ++i) {
    cell(i, "opacity") = double(i) - 1.5;
    for (int k = 0; k < 3; ++k) cell(i, "scale_" + std::to_string(k)) = -4 + k;
  }
  const PlyColumns plain = table;
  const auto at = std::ptrdiff_t(
      test::column_of(table, "opacity"));  // in the middle, so that later columns must keep their offsets
  table.properties.insert(table.properties.begin() + at, {"filter_3D", PlyType::kFloat32});
  for (std::size_t i = 0; i < 4; ++i) table.rows[i].insert(table.rows[i].begin() + at, kFilter[i]);
  for (const PlyFormat format : kFormats) {
    CAPTURE(int(format));
    const std::string file = test::ply_bytes({table}, format), unfiltered = test::ply_bytes({plain}, format);
    const io::GaussianPly ply = parse(file), without = parse(unfiltered);
    for (std::size_t i = 0; i < 4; ++i) {
      CAPTURE(i);
      double kept = 1;  // the textbook form, where it is accurate
      for (std::size_t k = 0; k < 3; ++k) {
        const double s = std::exp(double(k) - 4), wide = std::sqrt(s * s + kFilter[i] * kFilter[i]);
        CHECK(ply.cloud.log_scale[3 * i + k] == doctest::Approx(std::log(wide)).epsilon(1e-6));
        kept *= s / wide;
      }
      const double alpha = kept / (1 + std::exp(1.5 - double(i)));
      CHECK(ply.cloud.logit_opacity[i] == doctest::Approx(std::log(alpha / (1 - alpha))).epsilon(1e-5));
    }
    CHECK(ply.cloud.logit_opacity[0] == without.cloud.logit_opacity[0]);  // a width of 0 changes nothing
    CHECK(ply.cloud.rotation == without.cloud.rotation);
    CHECK(ply.cloud.position == without.cloud.position);
    CHECK(ply.cloud.sh_rest == without.cloud.sh_rest);
    CHECK(ply.rows.find("filter_3D") < 0);  // else reading a labelled copy would filter again
    CHECK(ply.cloud.antialiased);
    CHECK_FALSE(without.cloud.antialiased);
  }
}

TEST_CASE("a model without rows still has its columns") {
  PlyColumns table = test::inria_columns(0, 0);
  table.properties.push_back({"filter_3D", PlyType::kFloat32});
  const io::GaussianPly ply = parse(test::ply_bytes({table}, PlyFormat::kBinaryLittle));
  CHECK(ply.cloud.size() == 0);
  CHECK(ply.cloud.antialiased);
  CHECK(ply.rows.column("x"));
  CHECK_FALSE(ply.rows.column("filter_3D"));
}

TEST_CASE("filter_3D keeps opaque Gaussians opaque and non-finite rows detectable") {
  PlyColumns table = test::inria_columns(3, 0);
  table.properties.push_back({"filter_3D", PlyType::kFloat32});
  for (std::size_t i = 0; i < 3; ++i) table.rows[i].push_back(i == 2 ? NAN : 1e-4);
  table.rows[0][test::column_of(table, "opacity")] = 40;  // σ is 1 in double
  table.rows[1][test::column_of(table, "opacity")] = INFINITY;
  for (std::size_t i = 0; i < 3; ++i)
    for (const char* name : {"scale_0", "scale_1", "scale_2"}) table.rows[i][test::column_of(table, name)] = 0;
  const io::GaussianPly ply = parse(test::ply_bytes({table}, PlyFormat::kBinaryLittle));
  const double lost = 1.5e-8;  // 1 - c = 3 f²/2 to first order
  CHECK(ply.cloud.logit_opacity[0] == doctest::Approx(-std::log(lost)).epsilon(1e-3));
  CHECK(ply.cloud.logit_opacity[1] == doctest::Approx(-std::log(lost)).epsilon(1e-3));
  CHECK(ply.health.excluded() == 1);
}

TEST_CASE("missing and contradictory columns are named in the error") {
  for (const std::string name : {"x", "opacity", "scale_0", "scale_1", "rot_3", "f_dc_2", "f_rest_4"}) {
    PlyColumns table = test::inria_columns(2, 1);
    test::remove_column(table, name);
    if (name == "f_rest_4") test::add_column(table, 0, "f_rest_99", PlyType::kFloat32, 0);
    CHECK(error_of(test::ply_bytes({table}, PlyFormat::kBinaryLittle)).find("'" + name + "'") != std::string::npos);
  }
  PlyColumns rest = test::inria_columns(2, 1);
  test::remove_column(rest, "f_rest_8");
  CHECK(error_of(test::ply_bytes({rest}, PlyFormat::kAscii)).find("0, 9, 24 or 45") != std::string::npos);
  CHECK(error_of("ply\nformat ascii 1.0\nend_header\n").find("vertex") != std::string::npos);
}

TEST_CASE("of a coloured point cloud the error states what it is") {
  const auto remedy_of = [](PlyColumns table, std::initializer_list<const char*> missing) {
    for (const char* name : missing) test::remove_column(table, name);
    for (const char* name : {"red", "green", "blue"}) test::add_column(table, 0, name, PlyType::kUint8, 9);
    try {
      parse(test::ply_bytes({table}, PlyFormat::kBinaryLittle));
    } catch (const Error& e) {
      return e.remedy();
    }
    return std::string();
  };
  const PlyColumns splat = test::inria_columns(2, 0);
  CHECK(remedy_of(splat, {"scale_0", "scale_1", "scale_2", "f_dc_0"}).find("a point cloud") != std::string::npos);
  CHECK(remedy_of(splat, {"opacity"}).empty());
  CHECK(remedy_of(splat, {}).empty());
}

TEST_CASE("a model truncated at any byte is rejected, in every format") {
  PlyColumns table = test::inria_columns(2, 0, false);
  const PlyColumns tail{"tail", {{"a", PlyType::kInt16}}, {{1}, {-20}}};
  for (const PlyFormat format : kFormats) {
    const std::string file = test::ply_bytes({table, tail}, format, {"comment antialiased 1"});
    CHECK(parse(file).cloud.size() == 2);
    for (std::size_t n = 0; n < file.size(); ++n) {
      const std::vector<char> exact(
          file.begin(),
          file.begin() + std::ptrdiff_t(n));  // exact size, so that a sanitizer sees reads past the end
      const io::Bytes prefix(reinterpret_cast<const std::uint8_t*>(exact.data()), n);
      CAPTURE(n);
      CHECK(test::code_of([&] { io::parse_gaussian_ply("cut.ply", prefix); }) == ErrorCode::kBadInput);
    }
  }
}

TEST_CASE("label values out of range are rejected with column and row") {
  const auto with = [](const std::string& column, double value) {
    PlyColumns table = test::inria_columns(3, 0);
    for (const char* name : {"ngs_label", "ngs_prob", "ngs_variance", "ngs_views", "ngs_boundary", "ngs_label_cup",
                             "ngs_prob_cup", "ngs_weight"})
      test::add_column(table, table.properties.size(), name, PlyType::kFloat32, 1);
    table.rows[1][test::column_of(table, column)] = value;
    return error_of(test::ply_bytes({table}, PlyFormat::kBinaryLittle));
  };
  CHECK(with("ngs_views", 700) == "");
  CHECK(with("ngs_prob", 0.25) == "");
  CHECK(with("ngs_weight", 1e6) == "");
  for (const double value : {-1.0, 1e30, std::numeric_limits<double>::quiet_NaN()})
    CHECK(with("ngs_weight", value).find("ngs_weight of row 1: ") != std::string::npos);
  CHECK(with("ngs_prob", 1.00001) == "");  // rounding
  CHECK(with("ngs_prob", 7).find("ngs_prob of row 1: 7.000000, expected 0 to 1") != std::string::npos);
  CHECK(with("ngs_views", -5).find("ngs_views of row 1: -5.000000, expected a number of views") != std::string::npos);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  for (const char* column :
       {"ngs_label", "ngs_prob", "ngs_variance", "ngs_views", "ngs_boundary", "ngs_label_cup", "ngs_prob_cup"})
    for (const double value : {kNan, kInfinity, -1.0}) {
      CAPTURE(column);
      CHECK(with(column, value).find(std::string(column) + " of row 1") != std::string::npos);
    }
}

TEST_CASE("a header with too many elements or properties is rejected before the names are compared") {
  const auto header = [](int count, const std::string& line, const std::string& behind) {
    std::string text = "ply\nformat ascii 1.0\n";
    if (behind.empty()) text += "element vertex 1\n";
    for (int i = 0; i < count; ++i) text += line + std::to_string(i) + behind + "\n";
    return text + "end_header\n";
  };
  CHECK(error_of(header(300000, "element e", " 0")).find("more than 256 elements") != std::string::npos);
  CHECK(error_of(header(300000, "property float p", "")).find("more than 16384 properties") != std::string::npos);
  CHECK(error_of(header(256, "element e", " 0")).find("no element 'vertex'") != std::string::npos);
}

TEST_CASE("counts beyond the file size are rejected before memory is allocated") {
  const PlyColumns table = test::inria_columns(2, 0, false);
  for (const PlyFormat format : kFormats)
    for (const std::string count : {"3", "4000000000", "9223372036854775807", "-1", "1e3", "99999999999999999999"}) {
      std::string file = test::ply_bytes({table}, format);
      file.replace(file.find("vertex 2"), 8, "vertex " + count);
      CAPTURE(count);
      CHECK(error_of(file).find("expected") != std::string::npos);
    }
  // An element without properties takes no bytes, whatever its count.
  std::string file = test::ply_bytes({{"vertex", {}, {}}}, PlyFormat::kBinaryLittle);
  file.replace(file.find("vertex 0"), 8, "vertex 9000000000000000000");
  CHECK(error_of(file).find("'x' is missing") != std::string::npos);
}

}  // namespace
}  // namespace ngs
