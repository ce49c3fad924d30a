#pragma once
// LLFF's poses_bounds.npy: one row of 17 numbers per image, in the order of the sorted file names: a 3x5 matrix
// [axes | centre | height, width, focal] and the near and far bounds. The axes in the world are (down, right,
// backward). One focal length; no principal point (the image centre is assumed, with a note).
#include <string>
#include <vector>

#include "ngs/io/capture/capture.h"
#include "ngs/io/files/npy.h"

namespace ngs::io {

/// `image_names`: sorted names of the images. kInconsistent: their number differs from the number of rows.
Capture llff_capture(const NpyMatrix& poses_bounds, const std::vector<std::string>& image_names,
                     const std::string& object);
Capture read_llff(const std::string& path, const std::vector<std::string>& image_names);

}  // namespace ngs::io
