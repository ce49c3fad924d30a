#include "ngs/io/formats/compression/refuse_web.h"
#include "ngs/io/formats/compression/zip_archive.h"

namespace ngs::io {

struct ZipReader::Impl {};
ZipReader::ZipReader(const std::string& name, Bytes) : name_(name) { refuse_in_browser(name, "a zip archive"); }
ZipReader::~ZipReader() = default;
std::vector<std::string> ZipReader::names() const { refuse_in_browser(name_, "a zip archive"); }
std::vector<std::uint8_t> ZipReader::read(const std::string&, std::size_t) const {
  refuse_in_browser(name_, "a zip archive");
}
std::vector<std::uint8_t> zip(const std::vector<ZipEntry>&) { refuse_in_browser("output", "a zip archive"); }

}  // namespace ngs::io
