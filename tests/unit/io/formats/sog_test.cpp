#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/io/formats/compression/codebook.h"
#include "ngs/io/formats/compression/webp_image.h"
#include "ngs/io/formats/compression/zip_archive.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/formats/write_splat.h"
#include "support/error_code.h"
#include "support/ply_text.h"
#include "support/random.h"
#include "support/splat_files.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

using nlohmann::json;

/// An image of one row with `texels`, four bytes each.
std::vector<std::uint8_t> picture(const std::vector<std::array<int, 4>>& texels, int width = 0) {
  io::RgbaImage table{width > 0 ? width : int(texels.size()), 1, {}};
  table.bytes.resize(table.texels() * 4, 0);
  for (std::size_t i = 0; i < texels.size(); ++i)
    for (std::size_t c = 0; c < 4; ++c) table.texel(i)[c] = std::uint8_t(texels[i][c]);
  return io::encode_webp(table);
}

/// Two Gaussians, SH degree 1, as version 1 or 2.
struct Files {
  json meta;
  std::vector<io::ZipEntry> pictures;

  explicit Files(int version) {
    std::vector<double> ramp;
    for (int k = 0; k < 256; ++k) ramp.push_back(-1 + k / 100.0);
    const auto files = [](const char* a, const char* b = nullptr) { return b ? json{a, b} : json{a}; };
    meta["means"] = {{"mins", {-1, 0, -2}}, {"maxs", {1, 3, 2}}, {"files", files("l.webp", "u.webp")}};
    meta["quats"] = {{"files", files("q.webp")}};
    meta["scales"] = {{"files", files("s.webp")}};
    meta["sh0"] = {{"files", files("c.webp")}};
    meta["shN"] = {{"files", files("p.webp", "n.webp")}};
    if (version == 2) {
      meta["version"] = 2;
      meta["count"] = 2;
      meta["antialias"] = true;
      for (const char* part : {"scales", "sh0", "shN"}) meta[part]["codebook"] = ramp;
      meta["shN"]["bands"] = 1;
      meta["shN"]["count"] = 2;
    } else {
      meta["means"]["shape"] = {2, 3};
      meta["scales"]["mins"] = {-1, -1, -1};
      meta["scales"]["maxs"] = {1.55, 1.55, 1.55};
      meta["sh0"]["mins"] = {-1, -1, -1, -5};
      meta["sh0"]["maxs"] = {1.55, 1.55, 1.55, 5.2};
      meta["shN"]["mins"] = -1;
      meta["shN"]["maxs"] = 1.55;
    }
    pictures = {
        {"l.webp", picture({{0, 255, 255, 255}, {255, 0, 255, 255}})},
        {"u.webp", picture({{0, 255, 127, 255}, {255, 0, 127, 255}})},
        {"q.webp", picture({{255, 0, 128, 252}, {0, 255, 0, 255}})},
        {"s.webp", picture({{0, 100, 255, 255}, {10, 20, 30, 255}})},
        {"c.webp", picture({{0, 100, 255, 51}, {10, 20, 30, 0}})},
        {"p.webp",
         picture({{0, 0, 0, 255}, {0, 0, 0, 255}, {0, 0, 0, 255}, {1, 2, 3, 255}, {4, 5, 6, 255}, {7, 8, 9, 255}},
                 192)},
        {"n.webp", picture({{1, 0, 0, 255}, {0, 0, 0, 255}})}};
  }
  std::string bytes() const {
    std::vector<io::ZipEntry> entries = pictures;
    const std::string text = meta.dump();
    entries.push_back({"meta.json", {text.begin(), text.end()}});
    const std::vector<std::uint8_t> archive = io::zip(entries);
    return {archive.begin(), archive.end()};
  }
  std::vector<std::uint8_t>& picture_of(const std::string& name) {
    for (io::ZipEntry& entry : pictures)
      if (entry.name == name) return entry.bytes;
    throw std::logic_error(name);
  }
};

void check_sog_refused(const std::string& bytes, const std::string& part) {
  INFO(part);
  test::refused([&] { (void)io::decode_sog("model.sog", test::as_bytes(bytes)); }, ErrorCode::kBadInput, part);
}

TEST_CASE(".sog versions 1 and 2 are decoded according to their layouts") {
  for (const int version : {1, 2}) {
    CAPTURE(version);
    const test::TempDir dir;
    const io::GaussianPly model = io::read_gaussian_ply(dir.write("m.sog", Files(version).bytes()));
    const GaussianCloud& cloud = model.cloud;
    REQUIRE(cloud.size() == 2);
    CHECK(cloud.antialiased == (version == 2));
    CHECK(cloud.position[0] == doctest::Approx(-std::expm1(1.0)));
    CHECK(cloud.position[1] == doctest::Approx(std::expm1(3.0)));
    CHECK(cloud.position[2] == doctest::Approx(-std::expm1(2 - 4 * 32767 / 65535.0)));
    CHECK(cloud.position[3] == doctest::Approx(std::expm1(1.0)));
    CHECK(cloud.position[4] == 0.f);
    const double r = std::sqrt(0.5);
    CHECK(cloud.rotation[0] == 0.f);  // the other three already have a length above 1
    CHECK(cloud.rotation[1] == doctest::Approx(r));
    CHECK(cloud.rotation[2] == doctest::Approx(-r));
    CHECK(cloud.rotation[3] == doctest::Approx(r * (128 / 127.5 - 1)));
    CHECK(cloud.rotation[4] == doctest::Approx(-r));
    CHECK(cloud.rotation[5] == doctest::Approx(r));
    CHECK(cloud.log_scale[1] == doctest::Approx(0.0));
    CHECK(cloud.log_scale[5] == doctest::Approx(-0.7));
    CHECK(cloud.sh_dc[2] == doctest::Approx(1.55));
    CHECK(cloud.logit_opacity[0] == doctest::Approx(version == 1 ? -5 + 10.2 * 51 / 255 : std::log(0.25)));
    CHECK(cloud.sh_rest[0] == doctest::Approx(-0.99));
    CHECK(cloud.sh_rest[5] == doctest::Approx(-0.94));
    CHECK(cloud.sh_rest[9] == doctest::Approx(-1.0));
  }
}

TEST_CASE("a .sog round trip loses at most half a step of every attribute") {
  for (const int degree : {0, 1, 3}) {
    CAPTURE(degree);
    GaussianCloud cloud = test::plain_cloud(300, degree, 13);
    cloud.antialiased = degree == 1;
    const test::SplatError error =
        test::splat_error(cloud, test::in_order_of(cloud, test::written_and_read(cloud, "m.sog")));
    // The logarithm has 65535 steps over at most 2 ln 4; its slope at 3 is 1/4.
    CHECK(error.position <= 4 * 2 * std::log(4.0) / 65535 / 2 * 1.001);
    CHECK(error.opacity <= 0.5 / 255 + 1e-6);
    CHECK(error.rotation <= 3 * std::sqrt(0.5) / 255 * 1.02);
    // 900 values on 256: runs of the even spread are merged; no value is farther than one even step of 10 / 255.
    CHECK(error.log_scale <= 10.0 / 255);
    CHECK(error.sh_dc <= 3.4 / 255);
    CHECK(error.sh_rest <= 1.8 / 255);
  }
}

TEST_CASE("a truncated .sog is rejected") {
  const std::string bytes = Files(2).bytes();
  for (std::size_t n = 0; n < bytes.size(); n += 7)
    CHECK_THROWS_AS((void)io::decode_sog("cut.sog", test::as_bytes(bytes.substr(0, n))), Error);
}

TEST_CASE("a .sog with invalid metadata is rejected before memory is allocated") {
  const auto with = [](const std::function<void(Files&)>& spoil) {
    Files files(2);
    spoil(files);
    return files.bytes();
  };
  check_sog_refused(with([](Files& f) { f.meta["count"] = 200000000; }), "expected at most 1032 times as many");
  check_sog_refused(with([](Files& f) { f.meta["count"] = 3; }), "has 2 pixels, expected at least 3");
  check_sog_refused(with([](Files& f) { f.meta["count"] = -1; }), "count -1, expected a whole number");
  check_sog_refused(with([](Files& f) { f.meta["count"] = 1e300; }), "expected a whole number");
  check_sog_refused(with([](Files& f) { f.meta.erase("count"); }), "'count' is missing");
  check_sog_refused(with([](Files& f) { f.meta["version"] = 3; }), "version 3 of .sog, expected 1 or 2");
  check_sog_refused(with([](Files& f) { f.meta.erase("quats"); }), "'quats.files' is missing");
  check_sog_refused(with([](Files& f) { f.meta["means"]["mins"] = {1, 2}; }), "holds 2 numbers, expected 3");
  check_sog_refused(with([](Files& f) { f.meta["means"]["maxs"][1] = nullptr; }), "holds 2 numbers, expected 3");
  check_sog_refused(with([](Files& f) { f.meta["sh0"]["codebook"] = json::array(); }), "holds 0 numbers, expected 256");
  check_sog_refused(with([](Files& f) { f.meta["sh0"]["files"] = {"../../etc/passwd"}; }),
                    "no entry '../../etc/passwd'");
  check_sog_refused(with([](Files& f) { f.meta["shN"]["bands"] = 2; }), "contradicts the width");
  check_sog_refused(with([](Files& f) { f.meta = json::array(); }), "not a JSON object");
  check_sog_refused(with([](Files& f) {
                      f.picture_of("q.webp") = picture({{0, 0, 0, 255}, {0, 0, 0, 251}});
                    }),
                    "251 as the mode of Gaussian 1");
  check_sog_refused(with([](Files& f) {
                      f.picture_of("n.webp") = picture({{64, 0, 0, 255}, {0, 0, 0, 255}});
                    }),
                    "label 64 of Gaussian 0, expected less than 64");
  check_sog_refused(with([](Files& f) { f.picture_of("p.webp") = picture({{0, 0, 0, 255}}, 100); }), "100 pixels wide");
  check_sog_refused(with([](Files& f) { f.picture_of("s.webp") = {'R', 'I', 'F', 'F'}; }), "not a WebP image");
  check_sog_refused(with([](Files& f) { f.picture_of("s.webp").resize(30); }), "WebP image");
  // 16383 x 16383 constant pixels are a few hundred bytes of WebP
  io::RgbaImage large{16383, 400, std::vector<std::uint8_t>(std::size_t(16383) * 400 * 4, 7)};
  check_sog_refused(with([&](Files& f) { f.picture_of("c.webp") = io::encode_webp(large); }),
                    "16383 x 400 pixels, expected at most 65540 in all");
}

TEST_CASE("zip entries: size is checked before reading, folders are searched, damage is detected") {
  const std::vector<std::uint8_t> bytes = io::zip({{"folder/a", {1, 2, 3}}, {"b", {}}});
  const std::string name = "x.zip";
  const io::ZipReader reader(name, bytes);
  CHECK(reader.read("a", 3) == std::vector<std::uint8_t>{1, 2, 3});
  CHECK(reader.read("b", 0).empty());
  CHECK_THROWS_AS((void)reader.read("a", 2), Error);
  CHECK_THROWS_AS((void)reader.read("c", 9), Error);
  std::vector<std::uint8_t> damaged = bytes;
  damaged[30 + 8 + 1] ^= 1;  // after the local header and the name
  const io::ZipReader other(name, damaged);
  CHECK_THROWS_AS((void)other.read("a", 3), Error);
}

}  // namespace

namespace {

double squared_error(const io::Codebook& codebook, const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += std::pow(double(v) - double(codebook[io::nearest_in(codebook, v)]), 2);
  return sum;
}

TEST_CASE("up to 256 distinct values are kept exactly") {
  std::vector<float> values;
  for (int i = 0; i < 1000; ++i) values.push_back(float((i * 37) % 256) * 0.5f - 3.f);
  const io::Codebook codebook = io::fit_codebook(values);
  CHECK(std::is_sorted(codebook.begin(), codebook.end()));
  CHECK(squared_error(codebook, values) == 0);
  CHECK(io::fit_codebook({})[7] == 0);
  const float one = 5;
  CHECK(io::fit_codebook({&one, 1})[255] == 5.f);
}

TEST_CASE("a codebook has less error than 256 even steps, with and without an outlier") {
  for (const bool far : {false, true}) {
    CAPTURE(far);
    test::Random random(3);
    std::vector<float> values;
    for (int i = 0; i < 20000; ++i) values.push_back(float(std::pow(random.uniform(-1, 1), 3)));
    if (far) values.push_back(30.f);
    const io::Codebook codebook = io::fit_codebook(values);
    CHECK(std::is_sorted(codebook.begin(), codebook.end()));
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    io::Codebook even;
    for (std::size_t k = 0; k < even.size(); ++k) even[k] = *low + (*high - *low) * float(k) / 255.f;
    CHECK(squared_error(codebook, values) < squared_error(even, values) * (far ? 0.01 : 1));
    // Panter and Dite: (integral of the cube root of the density)³ / 12 K² a value; the density is |v|^(-2/3) / 6.
    if (!far) CHECK(squared_error(codebook, values) < 20000 * 8 / 6.0 * std::pow(9 / 7.0, 3) / 12 / (256 * 256));
  }
}

TEST_CASE("the nearest value of a codebook is found, also with equal values") {
  io::Codebook codebook;
  codebook.fill(4.f);
  codebook[0] = -1;
  codebook[1] = 0;
  codebook[2] = 0;
  codebook[3] = 1;
  CHECK(io::nearest_in(codebook, -9.f) == 0);
  CHECK(io::nearest_in(codebook, 0.f) == 1);
  CHECK(io::nearest_in(codebook, 0.4f) == 1);
  CHECK(io::nearest_in(codebook, 0.5f) == 1);
  CHECK(io::nearest_in(codebook, 0.6f) == 3);
  CHECK(io::nearest_in(codebook, 3.f) == 4);
  CHECK(io::nearest_in(codebook, 9.f) == 4);
}

TEST_CASE("a palette keeps few distinct rows exactly, and many as cluster means") {
  const std::vector<float> few = {1, 2, 3, 4, 1, 2, 5, 6};
  const io::RowPalette kept = io::fit_palette(few, 2, 3);
  REQUIRE(kept.rows.size() == 6);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t c = 0; c < 2; ++c) CHECK(kept.rows[kept.label[i] * 2 + c] == few[i * 2 + c]);

  test::Random random(5);
  std::vector<float> many;  // four clusters far apart
  for (int i = 0; i < 400; ++i)
    for (int c = 0; c < 3; ++c) many.push_back(float((i % 4 == c ? 10 : 0) + random.uniform(-0.1, 0.1)));
  const io::RowPalette palette = io::fit_palette(many, 3, 4);
  REQUIRE(palette.rows.size() == 12);
  for (std::size_t i = 0; i < 400; ++i) {
    CHECK(palette.label[i] == palette.label[i % 4]);
    for (std::size_t c = 0; c < 3; ++c)
      CHECK(std::abs(palette.rows[palette.label[i] * 3 + c] - many[i * 3 + c]) < 0.21);
  }
}

TEST_CASE("rows whose mean rounds to one of them are still split") {
  const float a = 1, b = std::nextafter(1.f, 2.f);
  const io::RowPalette palette = io::fit_palette(std::vector<float>{b, a, b, b}, 1, 4);
  CHECK(palette.rows[palette.label[1]] == a);
  CHECK(palette.rows[palette.label[0]] == b);
}

}  // namespace
}  // namespace ngs
