#include "ngs/io/formats/compression/refuse_web.h"
#include "ngs/io/formats/compression/zstd_frame.h"

namespace ngs::io {

void unzstd(const std::string& object, Bytes, std::span<std::uint8_t>) {
  refuse_in_browser(object, "a Zstandard frame");
}

}  // namespace ngs::io
