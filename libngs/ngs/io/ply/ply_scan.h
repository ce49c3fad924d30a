#pragma once
// The parts of ply.h that walk rows: where an element ends, and its rows as little-endian bytes.
#include "ngs/io/ply/ply.h"

namespace ngs::io {

/// Where `element`, which starts at `element.begin`, ends. Throws kBadInput where the bytes do not suffice.
std::size_t element_end(const std::string& name, PlyFormat format, const PlyElement& element, Bytes bytes);

/// At most 60 characters of a hostile word, other than printable ASCII replaced.
std::string printable(std::string_view word);

}  // namespace ngs::io
