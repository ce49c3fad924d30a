#include "ngs/io/formats/compression/gzip.h"
#include "ngs/io/formats/compression/refuse_web.h"

namespace ngs::io {

GunzipReader::GunzipReader(const std::string& name, Bytes) : name_(name), state_(nullptr) {
  refuse_in_browser(name, "a gzip stream");
}
GunzipReader::~GunzipReader() = default;
void GunzipReader::read(std::span<std::uint8_t>) { refuse_in_browser(name_, "a gzip stream"); }
std::vector<std::uint8_t> GunzipReader::read_all(std::size_t) { refuse_in_browser(name_, "a gzip stream"); }
void GunzipReader::finish() { refuse_in_browser(name_, "a gzip stream"); }
std::vector<std::uint8_t> gzip(Bytes) { refuse_in_browser("output", "a gzip stream"); }
void unzstd(const std::string& object, Bytes, std::span<std::uint8_t>) {
  refuse_in_browser(object, "a Zstandard frame");
}

}  // namespace ngs::io
