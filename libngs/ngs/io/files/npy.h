#pragma once
// Reads two-dimensional arrays from .npy files (f4 or f8, either byte order, C or Fortran order) and writes vectors.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

struct NpyMatrix {
  std::size_t rows = 0, columns = 0;
  std::vector<double> data;  // row-major
};

/// kBadInput for any other array. The shape is checked against the number of bytes before memory is allocated.
NpyMatrix parse_npy(Bytes bytes, const std::string& object);

/// A vector as a .npy file (version 1.0, little-endian) of type float32, int64 or bool (from bytes 0 or 1).
std::vector<std::uint8_t> npy_of(std::span<const float> values);
std::vector<std::uint8_t> npy_of(std::span<const std::int64_t> values);
std::vector<std::uint8_t> npy_of_flags(std::span<const std::uint8_t> flags);

}  // namespace ngs::io
