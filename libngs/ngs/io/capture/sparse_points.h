#pragma once
// Sparse points in, COLMAP text models out.
#include <span>
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/sparse_points.h"

namespace ngs::io {

/// COLMAP's points3D.txt or points3D.bin, or a PLY with x y z and, if there, red green blue (else grey). Told apart by
/// content. Tracks are not kept. Anything odd, points that are not finite included, is kBadInput.
std::vector<SparsePoint> read_points(const std::string& path);
/// The same from memory; `object` names it in messages.
std::vector<SparsePoint> parse_points(Bytes bytes, const std::string& object);

/// cameras.txt (PINHOLE, one per distinct size and intrinsics), images.txt and points3D.txt in `folder`, which is
/// made. All numbers keep all bits. Image k has the id k + 1, point k too.
void write_colmap_text(const std::string& folder, std::span<const Camera> cameras, std::span<const SparsePoint> points);

}  // namespace ngs::io
