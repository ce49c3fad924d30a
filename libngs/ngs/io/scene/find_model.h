#pragma once
// Finds the splat in the folder of a capture.
#include <string>

namespace ngs::io {

struct ModelSearch {
  std::string path;     // empty: no splat, or several candidates
  std::string problem;  // why `path` is empty, with the files found and their kinds
  std::string unused;   // other splats in the folder; empty: none
};

/// Search order: point_cloud.ply and model.ply; the newest point_cloud/iteration_N/point_cloud.ply; the only splat of
/// the folder, PLY before other formats; the only splat of the folders up to two levels below. A PLY is a splat if its
/// header has the properties of Gaussians: point clouds and meshes are skipped.
ModelSearch find_model(const std::string& folder);

/// The dataparser_transforms.json of nerfstudio below this folder; empty: none.
std::string find_world_transform(const std::string& folder);

/// The settings next to a model, or above the folders that trainers make for it, that state antialiasing: cfg_args
/// (3DGS), cfg.yml (gsplat), config.yml (nerfstudio). Empty: none do.
std::string antialiasing_settings(const std::string& model);

}  // namespace ngs::io
