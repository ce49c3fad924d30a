#include <doctest/doctest.h>

#include <cmath>

#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/formats/write_splat.h"
#include "support/splat_files.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

/// The numbers of the array that follows `declaration` and " = [".
std::vector<float> numbers(const std::string& text, const std::string& declaration) {
  const std::string opening = "    " + declaration + " = [";
  const std::size_t begin = text.find(opening);
  REQUIRE(begin != std::string::npos);
  const std::string array = text.substr(begin + opening.size(), text.find("]\n", begin) - begin - opening.size());
  std::vector<float> values;
  for (const char* at = array.c_str(); *at != 0;) {
    char* end = nullptr;
    const float value = std::strtof(at, &end);
    if (end != at) values.push_back(value);
    at = end != at ? end : at + 1;
  }
  return values;
}

std::string written(const GaussianCloud& cloud, const std::vector<std::uint8_t>& keep = {}) {
  const test::TempDir dir;
  CHECK(io::write_splat(dir.file("m.usda"), cloud, keep).empty());
  return test::read_bytes(dir.file("m.usda"));
}

TEST_CASE("a .usda has the attributes of ParticleField3DGaussianSplat, x right, y up, z back") {
  GaussianCloud cloud = test::plain_cloud(2, 2, 9);
  cloud.position = {1, 2, 3, -4, 5, -6};
  cloud.rotation = {2, 0, 0, 0, 0.5f, 0.5f, -0.5f, 0.5f};
  cloud.log_scale = {0, 1, -1, -2, -3, -4};
  cloud.logit_opacity = {0, INFINITY};
  const std::string text = written(cloud);
  CHECK(text.rfind("#usda 1.0\n", 0) == 0);
  CHECK(text.find("defaultPrim = \"Splat\"") != std::string::npos);
  CHECK(text.find("upAxis = \"Y\"") != std::string::npos);
  CHECK(text.find("def ParticleField3DGaussianSplat \"Splat\"") != std::string::npos);
  CHECK(text.find("uniform int radiance:sphericalHarmonicsDegree = 2\n") != std::string::npos);
  CHECK(numbers(text, "point3f[] positions") == std::vector<float>{1, -2, -3, -4, -5, 6});
  CHECK(numbers(text, "quatf[] orientations") == std::vector<float>{1, 0, 0, 0, 0.5f, 0.5f, 0.5f, -0.5f});
  CHECK(numbers(text, "float[] opacities") == std::vector<float>{0.5f, 1.f});
  const std::vector<float> scales = numbers(text, "float3[] scales");
  REQUIRE(scales.size() == 6);
  for (std::size_t i = 0; i < 6; ++i) CHECK(scales[i] == doctest::Approx(std::exp(double(cloud.log_scale[i]))));

  // y and z change their sign with the axes: the odd bands of one of them too
  const int sign[8] = {-1, -1, 1, -1, 1, 1, -1, 1};
  const std::vector<float> found = numbers(text, "float3[] radiance:sphericalHarmonicsCoefficients");
  REQUIRE(found.size() == 2 * 9 * 3);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK(found[i * 27 + c] == cloud.sh_dc[i * 3 + c]);
      for (std::size_t k = 0; k < 8; ++k)
        CHECK(found[i * 27 + 3 + k * 3 + c] == float(sign[k]) * cloud.sh_rest[(i * 8 + k) * 3 + c]);
    }

  const std::vector<float> extent = numbers(text, "float3[] extent");
  REQUIRE(extent.size() == 6);
  CHECK(extent[0] < 1 - 3.33 * std::exp(1.0));  // alpha falls below 1/255 at sqrt(2 ln 255) = 3.33
  CHECK(extent[4] > -2 + 3.33 * std::exp(1.0));
}

TEST_CASE("numbers of a .usda are read back as the same floats, and equal models give equal bytes") {
  const GaussianCloud cloud = test::plain_cloud(200, 3, 4);
  const std::string text = written(cloud);
  CHECK(written(cloud) == text);
  const std::vector<float> positions = numbers(text, "point3f[] positions");
  REQUIRE(positions.size() == 600);
  for (std::size_t i = 0; i < 600; ++i) CHECK(positions[i] == (i % 3 == 0 ? 1.f : -1.f) * cloud.position[i]);
}

TEST_CASE("an empty model gives a valid .usda") {
  const std::string text = written(test::plain_cloud(3, 1, 1), {0, 0, 0});
  CHECK(numbers(text, "point3f[] positions").empty());
  CHECK(text.find("extent") == std::string::npos);
}

}  // namespace
}  // namespace ngs
