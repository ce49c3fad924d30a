#include "ngs/io/image/image_header.h"

#include <algorithm>
#include <array>

#include "ngs/core/error.h"

namespace ngs::io {
namespace {

constexpr std::array<unsigned char, 8> kPngSignature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

[[noreturn]] void refuse(const std::string& object, const std::string& found, const std::string& remedy = {}) {
  throw Error(ErrorCode::kBadInput, object + ": " + found, remedy);
}

std::uint32_t big_endian_32(Bytes b, std::size_t at) {
  return std::uint32_t(b[at]) << 24 | std::uint32_t(b[at + 1]) << 16 | std::uint32_t(b[at + 2]) << 8 | b[at + 3];
}
std::uint32_t big_endian_16(Bytes b, std::size_t at) { return std::uint32_t(b[at]) << 8 | b[at + 1]; }

void check_size(const ImageHeader& header, const std::string& object) {
  const std::int64_t pixels = std::int64_t(header.width_px) * header.height_px;
  if (header.width_px < 1 || header.height_px < 1 || pixels > kMaxImagePixels)
    refuse(object, "image of " + std::to_string(header.width_px) + "x" + std::to_string(header.height_px) +
                       " px, expected between 1 px and " + std::to_string(kMaxImagePixels) + " px");
}

/// Calls visit(type, offset of the chunk, length of its data) for each chunk until IEND.
template <class Visit>
bool walk_png(Bytes bytes, const Visit& visit) {
  std::size_t at = kPngSignature.size();
  while (bytes.size() - at >= 12) {
    const std::size_t length = big_endian_32(bytes, at);
    if (length > bytes.size() - at - 12) return false;
    const std::string type(reinterpret_cast<const char*>(bytes.data()) + at + 4, 4);
    visit(type, at, length);
    if (type == "IEND") return true;
    at += 12 + length;
  }
  return false;
}

ImageHeader parse_png(Bytes bytes, const std::string& object) {
  ImageHeader header;
  bool has_size = false, has_pixels = false;
  const bool complete = walk_png(bytes, [&](const std::string& type, std::size_t at, std::size_t length) {
    if (type == "IDAT") has_pixels = true;
    if (type == "PLTE" && length >= 3)
      header.begins_black = bytes[at + 8] == 0 && bytes[at + 9] == 0 && bytes[at + 10] == 0;
    if (type != "IHDR" || length < 13) return;
    constexpr std::uint32_t kMaxSide = 1u << 30;
    header.width_px = int(std::min(big_endian_32(bytes, at + 8), kMaxSide));
    header.height_px = int(std::min(big_endian_32(bytes, at + 12), kMaxSide));
    header.bits = bytes[at + 16], header.palette = bytes[at + 17] == 3;
    has_size = true;
  });
  if (!complete) refuse(object, "PNG ends before its IEND chunk, expected a complete file", "copy or export it again");
  if (!has_size || !has_pixels) refuse(object, "PNG without IHDR or IDAT chunk, expected an image");
  check_size(header, object);
  return header;
}

bool is_frame_marker(unsigned char marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

ImageHeader parse_jpeg(Bytes bytes, const std::string& object) {
  ImageHeader header;
  header.format = ImageFormat::kJpeg;
  std::size_t at = 2;
  while (at + 4 <= bytes.size()) {
    if (bytes[at] != 0xFF) break;
    const unsigned char marker = bytes[at + 1];
    if (marker == 0xFF) {  // fill byte
      ++at;
      continue;
    }
    const std::size_t length = big_endian_16(bytes, at + 2);
    if (is_frame_marker(marker) && at + 9 <= bytes.size()) {
      header.bits = bytes[at + 4];
      header.height_px = int(big_endian_16(bytes, at + 5)), header.width_px = int(big_endian_16(bytes, at + 7));
    }
    if (marker == 0xDA) {  // start of scan: entropy-coded data until the end-of-image marker
      constexpr std::array<unsigned char, 2> kEnd{0xFF, 0xD9};
      const auto rest = bytes.subspan(at);
      // searched from the end, so that the image data are not read
      if (std::find_end(rest.begin(), rest.end(), kEnd.begin(), kEnd.end()) == rest.end()) break;
      check_size(header, object);
      return header;
    }
    at += 2 + length;
  }
  refuse(object, "JPEG ends before its image does, expected a complete file", "copy or export it again");
}

std::uint32_t crc32(Bytes bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (0xEDB88320u & (0u - (crc & 1u)));
  }
  return ~crc;
}

}  // namespace

std::optional<ImageHeader> parse_image_header(Bytes bytes, const std::string& object) {
  if (bytes.size() >= kPngSignature.size() && std::equal(kPngSignature.begin(), kPngSignature.end(), bytes.begin()))
    return parse_png(bytes, object);
  if (bytes.size() >= 3 && bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF) return parse_jpeg(bytes, object);
  return std::nullopt;
}

std::vector<std::uint8_t> palette_png_as_indices(Bytes bytes) {
  std::vector<std::uint8_t> out(kPngSignature.begin(), kPngSignature.end());
  walk_png(bytes, [&](const std::string& type, std::size_t at, std::size_t length) {
    if (type == "PLTE" || type == "tRNS") return;
    const Bytes source = bytes.subspan(at, length + 12);
    std::vector<std::uint8_t> chunk(source.begin(), source.end());
    if (type == "IHDR" && length >= 13) {
      chunk[17] = 0;  // colour type: grey
      const std::uint32_t crc = crc32(Bytes(chunk).subspan(4, length + 4));
      for (std::size_t i = 0; i < 4; ++i) chunk[length + 8 + i] = std::uint8_t(crc >> (24 - 8 * i) & 0xFF);
    }
    out.insert(out.end(), chunk.begin(), chunk.end());
  });
  return out;
}

}  // namespace ngs::io
