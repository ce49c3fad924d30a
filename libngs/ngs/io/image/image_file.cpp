#include "ngs/io/image/image_file.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/image/image_codecs.h"
#include "ngs/scene/view_names.h"

namespace ngs::io {
namespace {

/// Photos of phones: HEIC and AVIF are boxes of ISO/IEC 14496-12, whatever the file extension.
bool is_heif(Bytes bytes) {
  constexpr std::string_view kType = "ftyp";
  return bytes.size() > 12 &&
         std::equal(kType.begin(), kType.end(), bytes.begin() + 4, [](char c, auto byte) { return c == char(byte); });
}

bool begins_like_pointer(Bytes bytes) {
  constexpr std::string_view kPointer = "version https://git-lfs";
  return bytes.size() > kPointer.size() && std::equal(kPointer.begin(), kPointer.end(), bytes.begin());
}

Picture decode(Bytes bytes, const std::string& path) {
  if (is_heif(bytes) || has_unread_extension(path))
    throw Error(ErrorCode::kBadInput,
                path +
                    ": a photo in a format that is not read (HEIC, AVIF, JPEG XL, GIF, raw data of a camera), "
                    "expected PNG, JPEG, TIFF or WebP",
                "convert the photos, e.g. with mogrify -format jpg FILES: a copy next to the file is used if "
                "only its extension differs");
  Picture picture = image_codecs().decode(bytes);
  if (picture.width_px == 0)
    throw Error(ErrorCode::kBadInput, path + ": not a readable image, expected PNG, JPEG or another common format",
                begins_like_pointer(bytes) ? "it is a Git LFS pointer, without the data: git lfs pull" : "");
  if (picture.bits == 0 || (picture.channels != 1 && picture.channels != 3 && picture.channels != 4))
    throw Error(ErrorCode::kBadInput,
                path + ": samples of an unsupported type, expected 8 or 16 bit, 1, 3 or 4 channels",
                "convert it, e.g. with: convert " + path + " -depth 8 out.png");
  return picture;
}

/// Calls visit(samples) with the samples as 8 or 16 bit.
template <class Visit>
void with_samples(const Picture& picture, const Visit& visit) {
  if (picture.bits == 8)
    visit(picture.samples.data());
  else
    visit(reinterpret_cast<const std::uint16_t*>(picture.samples.data()));
}

template <class T>
PictureView view_of(const Image<T>& image) {
  NGS_CHECK(!image.empty() && (image.channels == 1 || image.channels == 3 || image.channels == 4),
            "a picture has pixels of 1, 3 or 4 channels");
  return {image.width_px, image.height_px, image.channels, 8 * int(sizeof(T)), image.data.data()};
}

template <class T>
std::vector<std::uint8_t> png_of(const Image<T>& image) {
  std::vector<std::uint8_t> bytes = image_codecs().encode_png(view_of(image));
  if (bytes.empty()) throw Error(ErrorCode::kEnvironment, "the PNG encoder failed, expected a compressed image");
  return bytes;
}

template <class T>
void write_png_of(const std::string& path, const Image<T>& image) {
  const std::vector<std::uint8_t> bytes = with_context(path, [&] { return png_of(image); });
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

RawMask raw_mask(const Picture& picture, bool lossy) {
  RawMask mask{picture.width_px, picture.height_px, picture.channels, picture.bits, lossy, {}};
  mask.data.resize(picture.samples.size() * 8 / std::size_t(picture.bits));
  with_samples(picture, [&](const auto* sample) { std::copy_n(sample, mask.data.size(), mask.data.begin()); });
  return mask;
}

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
    header.bits = bytes[at + 16];
    header.palette = bytes[at + 17] == 3;
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
      header.height_px = int(big_endian_16(bytes, at + 5));
      header.width_px = int(big_endian_16(bytes, at + 7));
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

PackedPhoto read_photo(const std::string& path, std::optional<Vec3<float>> behind) {
  const MappedFile file = map_regular_file(path);
  parse_image_header(file.bytes(), path);
  Picture picture = decode(file.bytes(), path);
  if (!behind && picture.channels == 4) {
    const std::size_t bytes = std::size_t(picture.bits) / 8;
    for (std::size_t at = 3 * bytes; at < picture.samples.size(); at += 4 * bytes)
      std::fill_n(picture.samples.begin() + std::ptrdiff_t(at), bytes, std::uint8_t{255});
  }
  const auto as_image = [&]<class T>(Image<T> image, std::vector<T> samples) {
    image.width_px = picture.width_px;
    image.height_px = picture.height_px;
    image.channels = picture.channels;
    image.data = std::move(samples);
    return PackedPhoto(std::move(image), behind.value_or(Vec3<float>{0, 0, 0}));
  };
  if (picture.bits == 8) return as_image(ImageU8(), std::move(picture.samples));
  const auto* wide = reinterpret_cast<const std::uint16_t*>(picture.samples.data());
  return as_image(ImageU16(), std::vector<std::uint16_t>(wide, wide + picture.samples.size() / 2));
}

ImageF read_image_rgb(const std::string& path, Vec3<float> behind) { return read_photo(path, behind).rgb(); }

bool is_transparent(const std::string& path) {
  const MappedFile file = map_regular_file(path);
  const auto header = parse_image_header(file.bytes(), path);
  if (header && header->format == ImageFormat::kJpeg) return false;
  const Picture picture = decode(file.bytes(), path);
  bool found = false;
  if (picture.channels == 4)
    with_samples(picture, [&](const auto* sample) {
      const int opaque = picture.bits == 8 ? 255 : 65535;
      const std::size_t pixels = std::size_t(picture.width_px) * std::size_t(picture.height_px);
      for (std::size_t p = 0; p < pixels && !found; ++p) found = int(sample[4 * p + 3]) < opaque;
    });
  return found;
}

RawMask read_mask_raw(const std::string& path, Palette palette) {
  const MappedFile file = map_regular_file(path);
  const auto header = parse_image_header(file.bytes(), path);
  const bool lossy = header && header->format == ImageFormat::kJpeg;
  if (lossy && palette == Palette::kIndices)
    throw Error(ErrorCode::kBadInput, path + ": a JPEG, whose compression changes ids, expected a label map",
                "export the label maps again as PNG; converting the JPEG does not restore the ids");
  if (!header || !header->palette) return raw_mask(decode(file.bytes(), path), lossy);
  if (palette != Palette::kIndices) {
    RawMask colours = raw_mask(decode(file.bytes(), path), lossy);
    if (palette == Palette::kColours || !header->begins_black || is_grey(colours.samples())) return colours;
  }
  RawMask indices = raw_mask(decode(palette_png_as_indices(file.bytes()), path), lossy);
  // Decoders scale 1, 2 and 4 bit grey to 0..255; indices must not be scaled.
  const int stretch = header->bits < 8 ? 255 / ((1 << header->bits) - 1) : 1;
  for (std::uint16_t& value : indices.data) value = std::uint16_t(value / stretch);
  return indices;
}

ImageSize read_image_size(const std::string& path) {
  const MappedFile file = map_regular_file(path);
  if (const auto header = parse_image_header(file.bytes(), path)) return {header->width_px, header->height_px};
  const Picture picture = decode(file.bytes(), path);
  return {picture.width_px, picture.height_px};
}

std::string to_string(ImageSize size) { return std::to_string(size.width_px) + "x" + std::to_string(size.height_px); }

void write_png(const std::string& path, const ImageU8& image) { write_png_of(path, image); }
void write_png16(const std::string& path, const ImageU16& image) { write_png_of(path, image); }

std::vector<std::uint8_t> encode_png(const ImageU8& image) { return png_of(image); }

PagePicture encode_for_page(const ImageU8& image, int quality) {
  if (image_codecs().encode_jpeg == nullptr) return {"image/png", encode_png(image)};
  return {"image/jpeg", encode_jpeg(image, quality)};
}

std::vector<std::uint8_t> encode_jpeg(const ImageU8& image, int quality) {
  NGS_CHECK(image.channels == 3, "JPEG needs an RGB image");
  std::vector<std::uint8_t> bytes = image_codecs().encode_jpeg(view_of(image), quality);
  if (bytes.empty()) throw Error(ErrorCode::kEnvironment, "the JPEG encoder failed, expected a compressed image");
  return bytes;
}

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
