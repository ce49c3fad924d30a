// Splats saved by other programs: other names of columns, SH of degree 4, values after activation.
#include <doctest/doctest.h>

#include <cmath>

#include "ngs/core/error.h"
#include "ngs/io/ply/gaussian_columns.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "support/ply_text.h"
#include "support/random.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

using io::PlyFormat;
using test::contains;
using test::PlyColumns;

io::GaussianPly parse(const PlyColumns& table) {
  // Rows are not borrowed: the text does not outlive the model.
  return io::parse_gaussian_ply("model.ply", test::as_bytes(test::ply_bytes({table}, PlyFormat::kAscii)));
}

/// A trained model: log scales of -7 to 0, logits of -5 to 8.
PlyColumns trained(int n, std::uint64_t seed) {
  test::Random random(seed);
  PlyColumns table = test::inria_columns(n, 0);
  for (auto& row : table.rows) {
    for (const char* name : {"x", "y", "z"}) row[test::column_of(table, name)] = random.uniform(-2, 2);
    for (const char* name : {"scale_0", "scale_1", "scale_2"})
      row[test::column_of(table, name)] = random.uniform(-7, 0);
    row[test::column_of(table, "opacity")] = random.uniform(-5, 8);
  }
  return table;
}

PlyColumns activated(PlyColumns table, bool scale, bool opacity) {
  for (auto& row : table.rows) {
    for (const char* name : {"scale_0", "scale_1", "scale_2"})
      if (double& v = row[test::column_of(table, name)]; scale) v = std::exp(v);
    if (double& v = row[test::column_of(table, "opacity")]; opacity) v = 1 / (1 + std::exp(-v));
  }
  return table;
}

struct Refusal {
  std::string what, remedy;
};
Refusal refusal_of(const PlyColumns& table) {
  try {
    parse(table);
  } catch (const Error& e) {
    CHECK(e.code() == ErrorCode::kBadInput);
    return {e.what(), e.remedy()};
  }
  return {};
}

}  // namespace

TEST_CASE(
    "columns named as by CloudCompare, nerfstudio, gsplat or with letters have the values of the original splat") {
  const PlyColumns table = test::inria_columns(5, 1);
  const io::GaussianPly plain = parse(table);
  using Stems = std::vector<std::pair<std::string, std::string>>;  // ours, theirs
  for (const Stems& stems :
       {Stems{{"scale_", "scalar_scale_"}, {"opacity", "scalar_opacity"}, {"f_rest_", "scalar_f_rest_"}},
        {{"rot_", "rotation_"},
         {"scale_", "scaling_"},
         {"f_dc_", "features_dc_"},
         {"f_rest_", "features_rest_"},
         {"opacity", "opacities"}},
        {{"rot_", "quats_"}, {"scale_", "scales_"}, {"f_dc_", "sh0_"}, {"f_rest_", "shN_"}, {"opacity", "opacities_0"}},
        {{"rot_0", "rot_w"}, {"rot_1", "rot_x"}, {"rot_2", "rot_y"}, {"rot_3", "rot_z"}, {"scale_1", "scale_y"}}}) {
    PlyColumns renamed = table;
    for (auto& [name, type] : renamed.properties)
      for (const auto& [ours, theirs] : stems)
        if (name.starts_with(ours)) {
          name = theirs + name.substr(ours.size());
          break;
        }
    CAPTURE(stems[0].second);
    const io::GaussianPly ply = parse(renamed);
    CHECK(ply.cloud.sh_rest == plain.cloud.sh_rest);
    CHECK(ply.cloud.sh_dc == plain.cloud.sh_dc);
    CHECK(ply.cloud.log_scale == plain.cloud.log_scale);
    CHECK(ply.cloud.rotation == plain.cloud.rotation);
    CHECK(ply.cloud.logit_opacity == plain.cloud.logit_opacity);
    REQUIRE(ply.notes.size() == 1);
    CHECK(contains(ply.notes[0], "columns are read by their names in 3DGS ("));
    CHECK(contains(ply.notes[0], "all of red, then green") == (stems.size() == 5 && stems[3].first == "f_rest_"));
    const test::TempDir dir;
    CHECK(io::is_gaussian_element(
        *io::PlyFile::open(dir.write("m.ply", test::ply_bytes({renamed}, PlyFormat::kAscii))).find("vertex")));
  }
}

TEST_CASE("a column scalar_NAME next to a column NAME is a foreign column and is kept") {
  PlyColumns table = test::inria_columns(2, 0);
  test::add_column(table, table.properties.size(), "scalar_label", io::PlyType::kFloat32, 1);
  const io::GaussianPly ply = parse(table);
  CHECK(ply.rows.find("scalar_label") >= 0);
  CHECK(ply.notes.empty());
}

TEST_CASE("SH beyond degree 3 are truncated to 3 when read, and kept in the file when the model is edited") {
  for (const int degree : {4, 5}) {
    CAPTURE(degree);
    const PlyColumns table = test::inria_columns(3, degree);
    const io::GaussianPly ply = parse(table);
    REQUIRE(ply.cloud.sh_degree == 3);
    const std::size_t before = std::size_t((degree + 1) * (degree + 1) - 1);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t k = 0; k < 15; ++k)
          CHECK(ply.cloud.sh_rest[(i * 15 + k) * 3 + c] ==
                float(table.rows[i][test::column_of(table, "f_rest_" + std::to_string(c * before + k))]));
    REQUIRE(ply.notes.size() == 1);
    CHECK(contains(ply.notes[0], "degree 4"));

    GaussianCloud edited = ply.cloud;
    edited.sh_rest[(15 + 14) * 3 + 2] = 77;  // row 1, last coefficient of blue
    const test::TempDir dir;
    const std::vector<float> ones(3, 1.f);
    io::NamedLabels labels;
    for (LabelColumn LabelColumns::*column : {&LabelColumns::label, &LabelColumns::prob, &LabelColumns::variance,
                                              &LabelColumns::views, &LabelColumns::boundary})
      labels.columns.*column = LabelColumn(ones);
    io::LabelledWrite options{.edited = &edited};
    io::write_labelled_ply(dir.file("l.ply"), ply, std::vector<io::NamedLabels>{labels}, options);
    CHECK(io::read_gaussian_ply(dir.file("l.ply")).cloud.sh_rest == edited.sh_rest);
  }
}

TEST_CASE("a number of f_rest_* that matches no SH degree is rejected") {
  PlyColumns table = test::inria_columns(1, 4);
  test::remove_column(table, "f_rest_71");
  CHECK(contains(refusal_of(table).what, "71 properties f_rest_*"));
}

TEST_CASE("activated scales and opacities are rejected with the command that converts them") {
  const PlyColumns table = trained(200, 7);
  CHECK(refusal_of(table).what.empty());
  for (const auto& of_case : {std::pair{true, true}, {true, false}, {false, true}}) {
    const bool scale = of_case.first, opacity = of_case.second;
    CAPTURE(scale);
    CAPTURE(opacity);
    const Refusal refusal = refusal_of(activated(table, scale, opacity));
    CHECK(contains(refusal.what, "scale_* all > 0") == scale);
    CHECK(contains(refusal.what, "opacity 0 to 1") == opacity);
    CHECK(contains(refusal.remedy, "ngs-extract model.ply --activated --object-ply"));
  }
  PlyColumns large = activated(table, true, true);  // a world in millimetres
  for (auto& row : large.rows)
    for (const char* name : {"x", "y", "z", "scale_0", "scale_1", "scale_2"}) row[test::column_of(large, name)] *= 1000;
  CHECK(contains(refusal_of(large).what, "scale_* all > 0"));
  PlyColumns opaque = activated(table, true, true);
  for (auto& row : opaque.rows) row[test::column_of(opaque, "opacity")] = 1;
  CHECK(contains(refusal_of(opaque).what, "opacity 0 to 1"));
  PlyColumns high = activated(table, false, true);
  for (auto& row : high.rows) row[test::column_of(high, "opacity")] = 0.9 + row[test::column_of(high, "opacity")] / 10;
  CHECK(contains(refusal_of(high).what, "opacity 0 to 1: activated, not logits"));
  PlyColumns logarithms = activated(table, false, true);
  for (auto& row : logarithms.rows)
    row[test::column_of(logarithms, "opacity")] = std::log(row[test::column_of(logarithms, "opacity")]);
  CHECK(contains(refusal_of(logarithms).what, "opacity all <= 0 and many near it: logarithms of 0 to 1"));
  for (const int full : {100, 255}) {
    PlyColumns scaled = activated(table, false, true);
    for (auto& row : scaled.rows) row[test::column_of(scaled, "opacity")] *= full;
    CHECK(contains(refusal_of(scaled).what, "opacity 0 to " + std::to_string(full) + ": activated"));
  }
}

TEST_CASE("models with large, equal or few Gaussians are not detected as activated") {
  PlyColumns large = trained(200, 8);  // logarithms of 1 to 8: sizes of 3 to 3000 in a world of 10000
  for (auto& row : large.rows) {
    for (const char* name : {"x", "y", "z"}) row[test::column_of(large, name)] *= 5000;
    for (const char* name : {"scale_0", "scale_1", "scale_2"}) row[test::column_of(large, name)] += 8;
  }
  CHECK(refusal_of(large).what.empty());
  PlyColumns equal = trained(200, 9);  // of a program that writes one scale for all Gaussians
  for (auto& row : equal.rows) {
    for (const char* name : {"scale_0", "scale_1", "scale_2"}) row[test::column_of(equal, name)] = 0.5;
    row[test::column_of(equal, "opacity")] = 1;
  }
  CHECK(refusal_of(equal).what.empty());
  CHECK(refusal_of(activated(trained(15, 10), true, true)).what.empty());
  PlyColumns faint = trained(200, 12);  // logits of -8 to -0.5: no opacity above .38
  for (auto& row : faint.rows)
    row[test::column_of(faint, "opacity")] = -4.9 + 0.54 * row[test::column_of(faint, "opacity")];
  CHECK(refusal_of(faint).what.empty());
}

TEST_CASE("rotations as bytes or in 0..1 are converted, and zeros are read as the identity, with a note") {
  constexpr int kRows = 40;
  test::Random random(13);
  PlyColumns table = trained(kRows, 13), zeros = table;
  const std::size_t first = test::column_of(table, "rot_0");
  for (auto& row : table.rows) {
    double norm = 0;
    for (std::size_t k = first; k < first + 4; ++k) {
      row[k] = random.uniform(-1, 1);
      norm = std::hypot(norm, row[k]);
    }
    for (std::size_t k = first; k < first + 4; ++k) row[k] /= norm;
  }
  CHECK(parse(table).notes.empty());
  const std::vector<float> right = parse(table).cloud.rotation;
  for (const double half : {0.5, 128.0}) {
    PlyColumns coded = table;
    const bool is_bytes = half > 1;
    for (std::size_t k = first; k < first + 4; ++k) {
      if (is_bytes) coded.properties[k].second = io::PlyType::kUint8;
      for (auto& row : coded.rows)
        row[k] = is_bytes ? std::min(255.0, std::round(128 + 128 * row[k])) : 0.5 + row[k] / 2;
    }
    const io::GaussianPly ply = parse(coded);
    REQUIRE(ply.notes.size() == 1);
    CHECK(contains(ply.notes[0], is_bytes ? "rot_* are bytes: converted" : "rot_* are values in 0..1: converted"));
    for (std::size_t i = 0; i < right.size(); ++i)
      CHECK(std::abs(ply.cloud.rotation[i] - right[i]) < (is_bytes ? 0.01 : 1e-5));
  }
  for (auto& row : zeros.rows) std::fill_n(row.begin() + std::ptrdiff_t(first), 4, 0.0);
  const io::GaussianPly ply = parse(zeros);
  REQUIRE(ply.notes.size() == 1);
  CHECK(contains(ply.notes[0], "rot_* are all 0: read as Gaussians that are not turned"));
  CHECK(ply.health.zero_rotation == 0);
  CHECK(ply.cloud.rotation[0] == 1);
}

TEST_CASE("reading an activated model with kActivated restores the trained values; other models are rejected") {
  const PlyColumns table = trained(64, 11);
  const test::TempDir dir;
  const io::ReadOptions reading{.encoding = io::ValueEncoding::kActivated};
  const auto write = [&](const PlyColumns& columns) {
    return dir.write("m.ply", test::ply_bytes({columns}, PlyFormat::kBinaryLittle));
  };
  const io::GaussianPly plain = parse(table);
  for (const auto& [scale, opacity] : {std::pair{true, true}, {true, false}, {false, true}}) {
    const io::GaussianPly ply = io::read_gaussian_ply(write(activated(table, scale, opacity)), reading);
    for (std::size_t i = 0; i < 64; ++i) {
      CHECK(ply.cloud.logit_opacity[i] == doctest::Approx(plain.cloud.logit_opacity[i]).epsilon(1e-3));
      CHECK(ply.cloud.log_scale[3 * i] == doctest::Approx(plain.cloud.log_scale[3 * i]).epsilon(1e-5));
      CHECK(ply.rows.column("scale_0").value_float(std::int64_t(i)) == ply.cloud.log_scale[3 * i]);
    }
  }
  PlyColumns of_255 = activated(table, false, true);
  for (auto& row : of_255.rows) row[test::column_of(of_255, "opacity")] *= 255;
  CHECK(io::read_gaussian_ply(write(of_255), reading).cloud.logit_opacity[5] ==
        doctest::Approx(plain.cloud.logit_opacity[5]).epsilon(1e-3));
  CHECK_THROWS_AS(io::read_gaussian_ply(write(table), reading), Error);
  PlyColumns ones = table;
  for (auto& row : ones.rows) row[test::column_of(ones, "opacity")] = 1;
  const io::GaussianPly as_logits = parse(ones);
  REQUIRE(as_logits.notes.size() == 1);
  CHECK(contains(as_logits.notes[0], "opacity is 1 in every row, as a logit .73; if the Gaussians are opaque"));
  CHECK(io::read_gaussian_ply(write(ones), reading).cloud.logit_opacity[0] > 16);
}

TEST_CASE("colours in red, green, blue and opacity as an integer are read as f_dc_* and logits, and written as such") {
  using io::PlyType;
  PlyColumns table = trained(20, 3);
  for (const char* name : {"f_dc_0", "f_dc_1", "f_dc_2", "opacity"}) test::remove_column(table, name);
  const struct {
    PlyType type;
    double full;
    const char* opacity;
  } cases[] = {{PlyType::kUint8, 255, "alpha"}, {PlyType::kUint8, 255, "opacity"}, {PlyType::kUint16, 65535, "alpha"}};
  for (const auto& c : cases) {
    PlyColumns plain = table;
    for (const char* name : {"blue", "green", "red"}) test::add_column(plain, 3, name, c.type, c.full);
    test::add_column(plain, 6, c.opacity, c.type, c.full / 5);
    plain.rows[0][test::column_of(plain, "green")] = 0;
    const test::TempDir dir;
    const io::GaussianPly ply =
        io::read_gaussian_ply(dir.write("m.ply", test::ply_bytes({plain}, PlyFormat::kBinaryLittle)));
    CHECK(ply.cloud.sh_dc[0] == doctest::Approx(0.5 / 0.28209479177387814));
    CHECK(ply.cloud.sh_dc[1] == doctest::Approx(-0.5 / 0.28209479177387814));
    CHECK(ply.cloud.logit_opacity[7] == doctest::Approx(std::log(0.25)));
    CHECK(ply.cloud.log_scale[4] == float(plain.rows[1][test::column_of(plain, "scale_1")]));
    CHECK(ply.rows.find("red") < 0);
    REQUIRE(ply.notes.size() == 1);
    CHECK(contains(ply.notes[0], "red green blue"));
  }
  PlyColumns both = trained(20, 4);  // next to f_dc_* and a logit they are columns of an editor
  for (const char* name : {"red", "green", "blue", "alpha"}) test::add_column(both, 3, name, PlyType::kUint8, 9);
  CHECK(parse(both).rows.find("red") >= 0);
  CHECK(parse(both).cloud.sh_dc == parse(trained(20, 4)).cloud.sh_dc);
}

}  // namespace ngs
