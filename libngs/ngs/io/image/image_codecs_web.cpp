// In a browser: PNG without compression, as the bytes do not leave the machine. No picture is read.
#include <algorithm>
#include <array>
#include <string_view>

#include "ngs/io/image/image_codecs.h"

namespace ngs::io {
namespace {

using Out = std::vector<std::uint8_t>;

void add_number(Out& out, std::uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(std::uint8_t(number >> shift));
}

/// The check sum of a chunk: CRC-32.
std::uint32_t crc_of(const std::uint8_t* begin, const std::uint8_t* end) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> made{};
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
      made[byte] = byte;
      for (int bit = 0; bit < 8; ++bit) made[byte] = made[byte] >> 1 ^ (made[byte] & 1 ? 0xedb88320u : 0);
    }
    return made;
  }();
  std::uint32_t crc = 0xffffffffu;
  for (; begin != end; ++begin) crc = crc >> 8 ^ table[(crc ^ *begin) & 0xffu];
  return ~crc;
}

void add_chunk(Out& out, std::string_view name, const Out& content) {
  add_number(out, std::uint32_t(content.size()));
  const std::size_t begin = out.size();
  out.insert(out.end(), name.begin(), name.end());
  out.insert(out.end(), content.begin(), content.end());
  add_number(out, crc_of(out.data() + begin, out.data() + out.size()));
}

/// The rows of samples, most significant byte first, each after the number of its filter, none.
Out rows_of(const PictureView& picture) {
  const std::size_t bytes = std::size_t(picture.bits) / 8,
                    row = std::size_t(picture.width_px) * std::size_t(picture.channels) * bytes;
  const std::uint8_t* from = static_cast<const std::uint8_t*>(picture.samples);
  Out rows;
  rows.reserve((row + 1) * std::size_t(picture.height_px));
  for (int y = 0; y < picture.height_px; ++y, from += row) {
    rows.push_back(0);
    rows.insert(rows.end(), from, from + row);
    for (std::size_t i = rows.size() - row; bytes == 2 && i < rows.size(); i += 2) std::swap(rows[i], rows[i + 1]);
  }
  return rows;
}

/// A zlib stream of stored blocks.
Out stored(const Out& data) {
  constexpr std::size_t kMostBytes = 65535;
  Out out{0x78, 0x01};
  out.reserve(data.size() + data.size() / kMostBytes * 5 + 16);
  std::uint32_t low = 1, high = 0;
  for (const std::uint8_t byte : data) {
    low = (low + byte) % 65521;
    high = (high + low) % 65521;
  }
  for (std::size_t begin = 0; begin < data.size(); begin += kMostBytes) {
    const std::size_t size = std::min(kMostBytes, data.size() - begin);
    out.push_back(begin + size == data.size());
    for (const std::size_t number : {size, ~size})
      for (const int shift : {0, 8}) out.push_back(std::uint8_t(number >> shift));
    out.insert(out.end(), data.begin() + std::ptrdiff_t(begin), data.begin() + std::ptrdiff_t(begin + size));
  }
  add_number(out, high << 16 | low);
  return out;
}

Out encode_png(const PictureView& picture) {
  Out out{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}, header;
  add_number(header, std::uint32_t(picture.width_px));
  add_number(header, std::uint32_t(picture.height_px));
  const std::uint8_t colours = picture.channels == 1 ? 0 : picture.channels == 3 ? 2 : 6;
  header.insert(header.end(), {std::uint8_t(picture.bits), colours, 0, 0, 0});
  add_chunk(out, "IHDR", header);
  add_chunk(out, "IDAT", stored(rows_of(picture)));
  add_chunk(out, "IEND", {});
  return out;
}

constexpr ImageCodecs kCodecs{[](Bytes) { return Picture{}; }, encode_png, nullptr};

}  // namespace

const ImageCodecs& image_codecs() { return kCodecs; }

}  // namespace ngs::io
