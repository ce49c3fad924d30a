#include "ngs/io/formats/compression/refuse_web.h"
#include "ngs/io/formats/compression/webp_image.h"

namespace ngs::io {

RgbaImage decode_webp(const std::string& object, Bytes, std::size_t) { refuse_in_browser(object, "a WebP image"); }
std::vector<std::uint8_t> encode_webp(const RgbaImage&) { refuse_in_browser("output", "a WebP image"); }

}  // namespace ngs::io
