#pragma once
// Scans the rows of a PLY element: their end, and their scalars as packed little-endian bytes.
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/ply/ply_types.h"

namespace ngs::io {

/// The bytes of a file; `name` is for messages.
struct PlyBytes {
  const std::string& name;
  PlyFormat format;
  Bytes bytes;
};

/// The offset at which `element`, which starts at `element.begin`, ends. Throws kBadInput if there are too few bytes.
std::size_t element_end(const PlyBytes& file, const PlyElement& element);

/// The rows of `element`, borrowed from the file if they are plain little-endian. Throws kBadInput.
PlyTable element_table(const PlyBytes& file, const PlyElement& element);

/// At most 60 characters of an untrusted word, with non-printable and non-ASCII characters replaced.
std::string printable(std::string_view word);

}  // namespace ngs::io
