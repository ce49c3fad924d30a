#include "ngs/io/formats/compression/webp_image.h"

#include <webp/decode.h>
#include <webp/encode.h>

#include <memory>

#include "ngs/core/check.h"
#include "ngs/core/error.h"

namespace ngs::io {

RgbaImage decode_webp(const std::string& object, Bytes bytes, std::size_t max_texels) {
  const auto bad = [&](const std::string& message) {
    throw Error(ErrorCode::kBadInput, object + ": " + message, "copy or export it again");
  };
  RgbaImage table;
  if (WebPGetInfo(bytes.data(), bytes.size(), &table.width, &table.height) == 0)
    bad("not a WebP image, or a truncated one, expected WebP");
  if (table.texels() > max_texels)
    bad(std::to_string(table.width) + " x " + std::to_string(table.height) + " pixels, expected at most " +
        std::to_string(max_texels) + " in all");
  table.bytes.resize(table.texels() * 4);
  if (WebPDecodeRGBAInto(bytes.data(), bytes.size(), table.bytes.data(), table.bytes.size(), table.width * 4) ==
      nullptr)
    bad("a damaged WebP image, expected an intact one");
  return table;
}

std::vector<std::uint8_t> encode_webp(const RgbaImage& table) {
  constexpr int kEffort = 6;  // of 0 to 9; each further level doubles the time for 1 % less size
  WebPConfig config;
  WebPPicture picture;
  NGS_CHECK(WebPConfigInit(&config) != 0 && WebPPictureInit(&picture) != 0, "libwebp of the version of its headers");
  NGS_CHECK(WebPConfigLosslessPreset(&config, kEffort) != 0, "a level of libwebp");
  config.exact = 1;
  picture.use_argb = 1;
  picture.width = table.width;
  picture.height = table.height;
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  const std::unique_ptr<WebPPicture, void (*)(WebPPicture*)> picture_freed(&picture, WebPPictureFree);
  const std::unique_ptr<WebPMemoryWriter, void (*)(WebPMemoryWriter*)> writer_freed(&writer, WebPMemoryWriterClear);
  if (WebPPictureImportRGBA(&picture, table.bytes.data(), table.width * 4) == 0 || WebPEncode(&config, &picture) == 0)
    throw Error(ErrorCode::kEnvironment, "a WebP picture of " + std::to_string(table.width) + " x " +
                                             std::to_string(table.height) +
                                             " pixels cannot be made, expected memory for it");
  return {writer.mem, writer.mem + writer.size};
}

}  // namespace ngs::io
