#include "ngs/io/files/safetensors.h"

#include <doctest/doctest.h>

#include <cstring>
#include <limits>

#include "ngs/core/error.h"
#include "ngs/io/files/json_file.h"
#include "ngs/options/option_set.h"
#include "support/error_code.h"
#include "support/ply_text.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

using test::as_bytes;

io::TensorFile sample() {
  io::TensorFile file;
  file.add<float>("w", {2, 3}, std::vector<float>{1, 2, 3, 4, 5, std::numeric_limits<float>::quiet_NaN()});
  file.add<std::uint8_t>("bytes", {3}, std::vector<std::uint8_t>{7, 8, 9});
  file.add<double>("evidence", {2}, std::vector<double>{0.1, -1e300});
  file.add<std::uint64_t>("counts", {1, 1}, std::vector<std::uint64_t>{1ull << 63});
  file.add<std::uint32_t>("ids", {0, 5}, std::vector<std::uint32_t>{});
  file.add<std::int32_t>("scalar", {}, std::vector<std::int32_t>{-3});
  file.metadata = {{"model", "b\u00fccher \"x\""}, {"step", "12"}};
  return file;
}

std::string file_of(const std::string& header, const std::string& data) {
  std::string file(8, '\0');
  const std::uint64_t n = header.size();
  std::memcpy(file.data(), &n, 8);
  return file + header + data;
}

std::string error_of(const std::string& file) {
  return test::bad_input([&] { io::parse_safetensors("t.safetensors", as_bytes(file)); });
}

TEST_CASE("tensors of every type and their metadata are read back bit for bit") {
  const test::TempDir dir;
  const io::TensorFile file = sample();
  io::write_safetensors(dir.file("t.safetensors"), file);
  const io::TensorFile back = io::read_safetensors(dir.file("t.safetensors"));
  CHECK(back.metadata == file.metadata);
  REQUIRE(back.tensors.size() == file.tensors.size());
  for (const io::Tensor& t : file.tensors) {
    CAPTURE(t.name);
    const auto found =
        std::find_if(back.tensors.begin(), back.tensors.end(), [&](const io::Tensor& b) { return b.name == t.name; });
    REQUIRE(found != back.tensors.end());
    CHECK(found->type == t.type);
    CHECK(found->shape == t.shape);
    CHECK(found->bytes == t.bytes);
  }
  CHECK(back.get<double>("evidence") == std::vector<double>{0.1, -1e300});
  CHECK(back.get<float>("w", {-1, 3})[4] == 5);
  CHECK(back.meta("step") == "12");

  const std::string first = test::read_bytes(dir.file("t.safetensors"));
  std::uint64_t header_bytes = 0;
  std::memcpy(&header_bytes, first.data(), 8);
  CHECK(header_bytes % 8 == 0);
  io::write_safetensors(dir.file("again"), back);
  CHECK(io::read_safetensors(dir.file("again")).get<float>("w").size() == 6);
}

TEST_CASE("a missing tensor, or one of another type or shape, is rejected with its name") {
  const io::TensorFile file = sample();
  CHECK_THROWS_AS(file.get<float>("missing"), Error);
  CHECK_THROWS_AS(file.get<double>("w"), Error);
  CHECK_THROWS_AS(file.get<float>("w", {3, 2}), Error);
  CHECK_THROWS_AS(file.get<float>("w", {6}), Error);
  CHECK_THROWS_AS(file.meta("nothing"), Error);
}

TEST_CASE("a tensor file truncated at any byte, or with an extra byte, is rejected") {
  const test::TempDir dir;
  io::write_safetensors(dir.file("t"), sample());
  const std::string good = test::read_bytes(dir.file("t"));
  CHECK(error_of(good) == "");
  for (std::size_t n = 0; n < good.size(); ++n) {
    const std::vector<char> exact(good.begin(), good.begin() + std::ptrdiff_t(n));
    CAPTURE(n);
    CHECK_THROWS_AS(io::parse_safetensors("t", {reinterpret_cast<const std::uint8_t*>(exact.data()), n}), Error);
  }
  CHECK(error_of(good + "x").find("bytes after the header") != std::string::npos);
}

TEST_CASE("invalid tensor headers are rejected") {
  const std::string four(4, 'x');
  const auto entry = [](const std::string& dtype, const std::string& shape, const std::string& offsets) {
    return "{\"a\":{\"dtype\":\"" + dtype + "\",\"shape\":" + shape + ",\"data_offsets\":" + offsets + "}}";
  };
  CHECK(error_of(file_of(entry("F32", "[1]", "[0,4]"), four)) == "");
  CHECK(error_of(file_of(entry("F99", "[1]", "[0,4]"), four)).find("dtype") != std::string::npos);
  CHECK(error_of(file_of(entry("F32", "[2]", "[0,4]"), four)).find("shape [2]") != std::string::npos);
  CHECK(error_of(file_of(entry("F32", "[-1]", "[0,4]"), four)).find("shape") != std::string::npos);
  CHECK(error_of(file_of(entry("F32", "[1]", "[4,0]"), four)).find("data_offsets") != std::string::npos);
  CHECK(error_of(file_of(entry("F32", "[1]", "[0,8]"), four)).find("data_offsets") != std::string::npos);
  CHECK(error_of(file_of(entry("F32", "[1]", "[0]"), four)).find("data_offsets") != std::string::npos);
  // 2^63 elements of 4 bytes wrap to 0 in 64 bits.
  CHECK(error_of(file_of(entry("F32", "[4294967296,2147483648]", "[0,0]"), "")).find("shape") != std::string::npos);
  CHECK(error_of(file_of(entry("F32", "[0,4294967296,4294967296]", "[0,0]"), "")) == "");
  CHECK(error_of(file_of("{\"a\":{\"dtype\":\"U8\",\"shape\":[2],\"data_offsets\":[0,2]},"
                         "\"b\":{\"dtype\":\"U8\",\"shape\":[3],\"data_offsets\":[1,4]}}",
                         four))
            .find("no overlaps") != std::string::npos);
  CHECK(error_of(file_of("{\"__metadata__\":{\"n\":1}}", "")).find("not a string") != std::string::npos);
  CHECK(error_of(file_of("[]", "")).find("not a JSON object") != std::string::npos);
  CHECK(error_of(file_of("{\"a\":3}", "")).find("expected an object") != std::string::npos);
  CHECK(error_of(file_of(std::string(100000, '['), "")).find("more than 64 levels") != std::string::npos);
}

}  // namespace
}  // namespace ngs

namespace ngs::io {
namespace {

std::string nested(int levels, const std::string& open, const std::string& close) {
  std::string text;
  for (int i = 0; i < levels; ++i) text += open;
  text += "1";
  for (int i = 0; i < levels; ++i) text += close;
  return text;
}

std::string message_of(const auto& body) { return test::thrown_by(body).what(); }

}  // namespace

TEST_CASE("JSON with 64 levels is read; deeper JSON is rejected") {
  CHECK(parse_json(nested(64, "[", "]"), "a.json").is_array());
  CHECK(parse_json(nested(64, "{\"a\":", "}"), "a.json").is_object());
  for (const int levels : {65, 1000000}) {
    CAPTURE(levels);
    const std::string expected = "a.json: more than 64 levels of arrays and objects, expected at most that many";
    CHECK(message_of([&] { parse_json(nested(levels, "[", "]"), "a.json"); }) == expected);
    CHECK(message_of([&] { parse_json(nested(levels, "{\"a\":", "}"), "a.json"); }) == expected);
    CHECK(message_of([&] { ngs::parse_json(nested(levels, "[", "]"), "a.json"); }) == expected);  // options
  }
}

TEST_CASE("a tensor file with a deeply nested header is rejected") {
  const std::string header = "{\"w\":" + nested(100000, "[", "]") + "}";
  std::string file(8, '\0');
  for (std::size_t i = 0; i < 8; ++i) file[i] = char(header.size() >> (8 * i));
  CHECK(message_of([&] {
          parse_safetensors("t.safetensors", test::as_bytes(file + header));
        }).find("more than 64 levels") != std::string::npos);
}

}  // namespace ngs::io
