#pragma once
// Two-dimensional arrays from .npy files: f4 or f8, either byte order, C or Fortran order.
#include <cstddef>
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

struct NpyMatrix {
  std::size_t rows = 0, columns = 0;
  std::vector<double> data;  // row-major
};

/// kBadInput for anything else; the shape is checked against the number of bytes before it is believed.
NpyMatrix parse_npy(Bytes bytes, const std::string& object);

}  // namespace ngs::io
