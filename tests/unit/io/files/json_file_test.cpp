#include "ngs/io/files/json_file.h"

#include <doctest/doctest.h>

#include "ngs/core/error.h"
#include "ngs/io/files/safetensors.h"
#include "ngs/options/option_set.h"
#include "support/error_code.h"
#include "support/ply_text.h"

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
