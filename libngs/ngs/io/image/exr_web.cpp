#include "ngs/io/formats/compression/refuse_web.h"
#include "ngs/io/image/exr.h"

namespace ngs::io {

void ExrImage::add(const std::vector<std::string>&, const ImageF&) { refuse_in_browser("picture", "an EXR file"); }
void write_exr(const std::string& path, const ExrImage&) { refuse_in_browser(path, "an EXR file"); }
ExrImage read_exr(const std::string& path) { refuse_in_browser(path, "an EXR file"); }
ExrImage parse_exr(Bytes, const std::string& object) { refuse_in_browser(object, "an EXR file"); }

}  // namespace ngs::io
