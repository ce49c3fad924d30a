#include "ngs/io/files/npy.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>

#include "ngs/core/error.h"

namespace ngs::io {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

constexpr std::array<std::uint8_t, 6> kMagic{0x93, 'N', 'U', 'M', 'P', 'Y'};

[[noreturn]] void refuse(const std::string& object, const std::string& text) {
  throw Error(ErrorCode::kBadInput, object + ": " + text);
}

struct Header {
  std::size_t scalar_bytes = 8;
  bool swap = false, fortran = false;
  std::size_t rows = 0, columns = 0;
  std::size_t data_at = 0;
};

/// The text after `key` and its colon in the Python literal of the header.
std::string_view value_of(std::string_view dict, std::string_view key, const std::string& object) {
  const std::size_t at = dict.find(key);
  const std::size_t colon = at == std::string_view::npos ? at : dict.find(':', at);
  if (colon == std::string_view::npos)
    refuse(object, "no " + std::string(key) + " in the header, expected a .npy file");
  const std::string_view rest = dict.substr(colon + 1);
  return rest.substr(std::min(rest.find_first_not_of(' '), rest.size()));
}

void read_shape(std::string_view text, const std::string& object, Header& header) {
  std::array<std::size_t, 2> sizes{};
  const char *at = text.data(), *end = text.data() + text.size();
  if (at == end || *at != '(') refuse(object, "no shape in the header, expected (rows, columns)");
  ++at;
  for (std::size_t& size : sizes) {
    while (at < end && (*at == ' ' || *at == ',')) ++at;
    const auto parsed = std::from_chars(at, end, size);
    if (parsed.ec != std::errc()) refuse(object, "shape that is not a pair of sizes, expected (rows, columns)");
    at = parsed.ptr;
  }
  while (at < end && (*at == ' ' || *at == ',')) ++at;
  if (at == end || *at != ')') refuse(object, "shape that is not a pair of sizes, expected (rows, columns)");
  header.rows = sizes[0];
  header.columns = sizes[1];
}

Header parse_header(Bytes bytes, const std::string& object) {
  if (bytes.size() < 12 || !std::equal(kMagic.begin(), kMagic.end(), bytes.begin()))
    refuse(object, "not a .npy file, expected one");
  const bool long_header = bytes[6] >= 2;
  const std::size_t length = std::size_t(bytes[8]) | std::size_t(bytes[9]) << 8 |
                             (long_header ? std::size_t(bytes[10]) << 16 | std::size_t(bytes[11]) << 24 : 0);
  const std::size_t start = long_header ? 12 : 10;
  if (length > bytes.size() - start) refuse(object, "ends inside its header, expected a complete file");
  const std::string_view dict(reinterpret_cast<const char*>(bytes.data()) + start, length);
  Header header;
  header.data_at = start + length;
  const std::string_view type = value_of(dict, "'descr'", object).substr(0, 5);
  const std::string_view kind = type.size() == 5 ? type.substr(2, 2) : "";
  if (kind != "f4" && kind != "f8") refuse(object, "elements of another type, expected f4 or f8");
  header.scalar_bytes = kind == "f4" ? 4 : 8;
  header.swap = type[1] == '>';
  header.fortran = value_of(dict, "'fortran_order'", object).substr(0, 4) == "True";
  read_shape(value_of(dict, "'shape'", object), object, header);
  return header;
}

/// `UInt` has the size of `Float`.
template <class Float, class UInt>
double scalar_at(const std::uint8_t* data, bool swap) {
  UInt bits = 0;
  for (std::size_t i = 0; i < sizeof(UInt); ++i) bits |= UInt(data[swap ? sizeof(UInt) - 1 - i : i]) << (8 * i);
  return double(std::bit_cast<Float>(bits));
}

/// The header is padded to a multiple of 64 bytes, as numpy does, and ends with a line feed.
std::vector<std::uint8_t> encode(const char* descr, std::size_t count, std::span<const std::uint8_t> data) {
  constexpr std::size_t kAlignment = 64, kPrefix = kMagic.size() + 4;  // magic, version 1.0, header length
  const std::string text =
      std::string("{'descr': '") + descr + "', 'fortran_order': False, 'shape': (" + std::to_string(count) + ",), }";
  const std::size_t header = (kPrefix + text.size() + kAlignment) / kAlignment * kAlignment;
  std::vector<std::uint8_t> bytes(header, ' ');
  std::ranges::copy(kMagic, bytes.begin());
  bytes[6] = 1;
  bytes[7] = 0;
  bytes[8] = std::uint8_t((header - kPrefix) & 255);
  bytes[9] = std::uint8_t((header - kPrefix) >> 8);
  std::ranges::copy(text, bytes.begin() + kPrefix);
  bytes.back() = '\n';
  bytes.insert(bytes.end(), data.begin(), data.end());
  return bytes;
}

template <class T>
std::span<const std::uint8_t> bytes_of(std::span<const T> values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()};
}

}  // namespace

std::vector<std::uint8_t> npy_of(std::span<const float> values) {
  return encode("<f4", values.size(), bytes_of(values));
}

std::vector<std::uint8_t> npy_of(std::span<const std::int64_t> values) {
  return encode("<i8", values.size(), bytes_of(values));
}

std::vector<std::uint8_t> npy_of_flags(std::span<const std::uint8_t> flags) {
  return encode("|b1", flags.size(), flags);
}

NpyMatrix parse_npy(Bytes bytes, const std::string& object) {
  const Header header = parse_header(bytes, object);
  const std::size_t capacity = (bytes.size() - header.data_at) / header.scalar_bytes;
  if (header.columns != 0 && header.rows > capacity / header.columns)
    refuse(object, "shape of " + std::to_string(header.rows) + "x" + std::to_string(header.columns) +
                       ", expected at most " + std::to_string(capacity) + " elements for the size of the file");
  NpyMatrix matrix{header.rows, header.columns, {}};
  if (header.rows == 0 || header.columns == 0) return matrix;
  matrix.data.resize(header.rows * header.columns);
  for (std::size_t r = 0; r < header.rows; ++r)
    for (std::size_t c = 0; c < header.columns; ++c) {
      const std::size_t at = header.fortran ? c * header.rows + r : r * header.columns + c;
      const std::uint8_t* element = bytes.data() + header.data_at + at * header.scalar_bytes;
      matrix.data[r * header.columns + c] = header.scalar_bytes == 8
                                                ? scalar_at<double, std::uint64_t>(element, header.swap)
                                                : scalar_at<float, std::uint32_t>(element, header.swap);
    }
  return matrix;
}

}  // namespace ngs::io
