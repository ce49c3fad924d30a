#pragma once
// Reads sparse points and writes COLMAP text models.
#include <span>
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/sparse_points.h"

namespace ngs::io {

/// Reads COLMAP's points3D.txt or points3D.bin, or a PLY with x y z and optionally red green blue (default: grey). The
/// format is detected from the content. Tracks are dropped. Malformed input, non-finite points included, is kBadInput.
std::vector<SparsePoint> read_points(const std::string& path);
/// The same from memory; `object` names it in messages.
std::vector<SparsePoint> parse_points(Bytes bytes, const std::string& object);

/// Writes cameras.txt (PINHOLE, one per distinct size and intrinsics), images.txt and points3D.txt to `folder`, which
/// is created. Numbers round-trip exactly. Image k has the id k + 1, and so has point k.
void write_colmap_text(const std::string& folder, std::span<const Camera> cameras, std::span<const SparsePoint> points);

}  // namespace ngs::io
