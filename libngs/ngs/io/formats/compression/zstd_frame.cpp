#include "ngs/io/formats/compression/zstd_frame.h"

#include <zstd.h>

#include "ngs/core/error.h"

namespace ngs::io {

void unzstd(const std::string& object, Bytes frames, std::span<std::uint8_t> out) {
  const std::size_t size = ZSTD_decompress(out.data(), out.size(), frames.data(), frames.size());
  if (ZSTD_isError(size) == 0 && size == out.size()) return;
  const std::string found = ZSTD_isError(size) != 0 ? std::string("a zstd stream that is damaged or too long (") +
                                                          ZSTD_getErrorName(size) + ")"
                                                    : "a zstd stream of " + std::to_string(size) + " bytes";
  throw Error(ErrorCode::kBadInput, object + ": " + found + ", expected " + std::to_string(out.size()) + " bytes",
              "copy or export it again");
}

}  // namespace ngs::io
