#pragma once
// Reads a scene, requires its model, and protects its photos from being overwritten.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/scene/boundary_set.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/scene.h"
#include "shared/run/run.h"

namespace ngs::cli {

// Memory estimates shared by the --dry-run of several tools: bytes of a model and of a pass over one view.

inline constexpr double kMib = 1024.0 * 1024.0, kProgramMib = 48;
/// Per Gaussian, independent of the view: data prepared for the projection.
inline constexpr double kPreparedBytes = 60;
/// Upper bound on the mean number of tiles per Gaussian.
inline constexpr double kTilesReached = 3;
/// Per visible Gaussian: id, record, depth, rectangle, first span, first slot and a flag; spans, whose lists grow by
/// doubling.
inline constexpr double kVisibleBytes = 4 + 56 + 4 + 16 + 8 + 8 + 1 + 2 * kTilesReached * 8;

/// Position, rotation, scale, opacity, SH bands and the usable flag.
inline double model_bytes(const GaussianCloud& cloud) { return 57 + 12.0 * cloud.rest_count(); }

/// Estimate of the device memory of a run (docs/gpu.md): values, gradients, two Adam moments, the trained rows and a
/// prepared copy; records, (Gaussian, tile) pairs and their rows of a view; 1 GiB of images.
inline double device_bytes(double gaussians, int rest_count) {
  constexpr double kColumns = 6, kViewBytes = 1000, kImageBytes = 1024 * kMib;
  return gaussians * (kColumns * (57 + 12.0 * rest_count) + kViewBytes) + kImageBytes;
}

/// Label columns of a Gaussian that belongs to `owners` objects.
inline double label_bytes(double owners) { return 20 * (owners + 1); }

inline double view_px(const SceneView& view) { return double(view.camera.width_px) * view.camera.height_px; }

inline double largest_view_px(const Scene& scene) {
  double largest = 0;
  for (const SceneView& view : scene.views) largest = std::max(largest, view_px(view));
  return largest;
}

/// Peak memory in MiB for `bytes` of data plus the program itself.
inline double peak_mib(double bytes) { return std::ceil(bytes / kMib + kProgramMib); }

/// Reads a scene.json. If its photos are renders of the model, "result" of the report records that.
Scene read_scene(Run& run, const std::string& path);

/// Adds the scene's model to the run's inputs. kBadInput if the scene names none or it is no regular file.
void require_model(Run& run, const Scene& scene, const std::string& scene_path);

/// Throws kUsage if one of `files`, which the run would write, is one of `kept`, of which empty ones are none.
void refuse_over(const std::vector<std::string>& kept, const std::vector<std::string>& files, const std::string& why,
                 const std::string& remedy);
/// The same for the photos of the scene.
void refuse_over_photos(const Scene& scene, const std::vector<std::string>& files);

// Reads the boundary set of a PLY of ngs-variance, for ngs-sample, ngs-rbf and ngs-joint.

/// The boundary Gaussians of a labelled PLY; with several objects, of their union. Throws kBadInput if the PLY has no
/// ngs_boundary, and kNothingFound if the set is empty (unless --allow-empty).
BoundarySet boundary_of(Run& run, const io::GaussianPly& ply, const std::string& path);

}  // namespace ngs::cli
