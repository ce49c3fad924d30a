#pragma once
// EXR files with named float channels: one part, FLOAT, ZIP. Channel names follow "<layer>.<channel>": R G B A Z
// ngs.mask ngs.prob ngs.variance ngs.views ngs.id nerf.R nerf.G nerf.B nerf.density. Attributes must be named "ngs:*";
// exrheader prints them. Equal content gives equal bytes; writing is atomic. The data window must start at (0, 0). An
// unreadable file is kBadInput.
#include <map>
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"
#include "ngs/scene/views.h"

namespace ngs::io {

struct ExrImage {
  int width_px = 0, height_px = 0;
  std::map<std::string, std::vector<float>> channels;  // [H·W] each; HALF and UINT channels are read as float
  std::map<std::string, std::string> text;             // attributes "ngs:*" of type string
  std::map<std::string, double> numbers;               // attributes "ngs:*" of type float, double or int

  /// Adds one channel per name from an interleaved image of the same size.
  void add(const std::vector<std::string>& names, const ImageF& image);
};

void write_exr(const std::string& path, const ExrImage& image);
ExrImage read_exr(const std::string& path);
/// The same from bytes in memory; `object` is the name in messages.
ExrImage parse_exr(Bytes bytes, const std::string& object);

}  // namespace ngs::io
