#include "ngs/io/image/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/core/error.h"
#include "ngs/core/rng.h"
#include "support/error_code.h"
#include "support/temp_dir.h"

namespace ngs::io {
namespace {

ExrImage sample(int width, int height) {
  ExrImage image;
  ImageF colour(width, height, 3), mask(width, height, 1);
  for (std::size_t i = 0; i < colour.data.size(); ++i) colour.data[i] = float(rng_normal(1, RngStream::kTest, i));
  for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = float(rng_uniform(2, RngStream::kTest, i));
  image.add({"R", "G", "B"}, colour);
  image.add({"ngs.mask"}, mask);
  image.text["ngs:schema"] = "layers-1";
  image.numbers["ngs:tau"] = 0.6;
  return image;
}

std::string refusal(const std::string& bytes) {
  return test::thrown_by([&] {
           parse_exr({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, "a.exr");
         })
      .what();
}

}  // namespace

TEST_CASE("an EXR is read back bit for bit with all channels and attributes") {
  const test::TempDir dir;
  ExrImage image = sample(37, 21);
  image.channels["Z"] = std::vector<float>(37 * 21, std::numeric_limits<float>::infinity());
  image.channels["Z"][5] = std::nextafter(1.f, 2.f);
  write_exr(dir.file("a.exr"), image);
  const ExrImage back = read_exr(dir.file("a.exr"));
  CHECK(back.width_px == 37);
  CHECK(back.height_px == 21);
  CHECK(back.channels == image.channels);
  CHECK(back.text == image.text);
  CHECK(back.numbers == image.numbers);
}

TEST_CASE("every prefix of an EXR is refused as bad input") {
  const test::TempDir dir;
  write_exr(dir.file("a.exr"), sample(5, 3));
  const std::string bytes = test::read_bytes(dir.file("a.exr"));
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    CAPTURE(n);
    const Bytes prefix(reinterpret_cast<const std::uint8_t*>(bytes.data()), n);
    CHECK_THROWS_AS(parse_exr(prefix, "a.exr"), Error);
  }
}

TEST_CASE("an EXR attribute whose declared size differs from its value is rejected") {
  const test::TempDir dir;
  write_exr(dir.file("a.exr"), sample(5, 3));
  for (const std::string type : {"chlist", "box2i", "compression", "lineOrder", "v2f", "float"})
    for (const int change : {-1, 1}) {
      CAPTURE(type);
      CAPTURE(change);
      std::string bytes = test::read_bytes(dir.file("a.exr"));
      const std::size_t at = bytes.rfind('\0' + type + '\0');  // an attribute may have the name of its type
      REQUIRE(at != std::string::npos);
      bytes[at + type.size() + 2] = char(bytes[at + type.size() + 2] + change);
      CHECK(refusal(bytes).find("an attribute of type " + type) != std::string::npos);
    }
  std::string bytes = test::read_bytes(dir.file("a.exr"));
  const std::size_t size_at = bytes.find("chlist") + 7;
  bytes[size_at + 4 + std::size_t(bytes[size_at]) - 1] = '\xff';  // the channel list ends after its declared size
  CHECK(refusal(bytes).find("an attribute of type chlist") != std::string::npos);
}

TEST_CASE("an EXR header that declares far more pixels than its bytes can hold is rejected") {
  const test::TempDir dir;
  write_exr(dir.file("a.exr"), sample(5, 3));
  const auto refused = [&](std::int32_t right, std::int32_t bottom) {
    std::string bytes = test::read_bytes(dir.file("a.exr"));
    const std::size_t at =
        bytes.find("dataWindow") + std::string("dataWindow").size() + 1 + 6 + 4;  // name, "box2i", size
    bytes.replace(at + 8, 4, reinterpret_cast<const char*>(&right), 4);
    bytes.replace(at + 12, 4, reinterpret_cast<const char*>(&bottom), 4);
    return refusal(bytes);
  };
  CHECK(refused(9000, 9000).find("header declares") != std::string::npos);
  CHECK(refused(12000, 12000).find("image of 12001x12001 px") != std::string::npos);
  // One row of 4 MB, which the library would unpack 16 rows at a time, with a buffer for each of several chunks.
  CHECK(refused(999999, 0).find("header declares") != std::string::npos);
  // A larger file may declare more, up to the limit of its compression: here 11 million columns, which the
  // library would unpack 16 rows at a time, 700 MB in one piece.
  write_exr(dir.file("a.exr"), sample(60, 60));
  CHECK(refused(11272195, 2).find("header declares") != std::string::npos);
}

TEST_CASE("a constant EXR, which compresses best, is read with every compression") {
  const test::TempDir dir;
  for (int compression = Imf::NO_COMPRESSION; compression < Imf::NUM_COMPRESSION_METHODS; ++compression)
    for (const int height : {2048, 1}) {
      CAPTURE(compression);
      CAPTURE(height);
      constexpr int width = 4096;
      Imf::Header header(width, height);
      header.compression() = Imf::Compression(compression);
      header.channels().insert("Y", Imf::Channel(Imf::HALF));
      std::vector<half> row(std::size_t(width), half(1.f));
      {
        Imf::OutputFile file(dir.file("one.exr").c_str(), header);
        Imf::FrameBuffer from;
        from.insert("Y", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(row.data()), sizeof(half), 0));
        file.setFrameBuffer(from);
        file.writePixels(height);
      }
      const ExrImage back = read_exr(dir.file("one.exr"));
      CHECK(back.width_px == width);
      CHECK(std::ranges::all_of(back.channels.at("Y"), [](float v) { return v == 1; }));
    }
}

}  // namespace ngs::io
