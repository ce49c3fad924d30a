#pragma once
// Which file of a capture's folder is its splat.
#include <string>

namespace ngs::io {

struct ModelSearch {
  std::string path;     // empty: none, or several to choose between
  std::string problem;  // why `path` is empty, with the files that are there and what they are
  std::string unused;   // other splats beside the one that was found; empty: none
};

/// Looked at are point_cloud.ply and model.ply, the newest point_cloud/iteration_N/point_cloud.ply, then the only splat
/// of the folder, PLY before other formats, then the only splat of the folders up to two levels below it. A PLY is a
/// splat by the properties in its header: point clouds and meshes are left out.
ModelSearch find_model(const std::string& folder);

}  // namespace ngs::io
