#pragma once
// Writes consistent label maps, a scene of them, and what is known of each object.
#include <string>
#include <vector>

#include "ngs/cut/groups/grouped_objects.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/scene/scene.h"
#include "shared/run/run.h"

namespace ngs::group {

struct Grouped {
  const Scene& scene;  // with the masks of everything
  const io::GaussianPly& ply;
  const SplatOptions& splat;
  const std::vector<std::size_t>& views;      // training views
  const std::vector<ViewGaussians>& of_view;  // [views]
  const GroupedObjects& objects;
  bool without_masks = false;  // label maps as the objects are rendered
};

/// "001" for the largest object.
std::string object_name(std::size_t index);

/// Throws kUsage if the masks or the scene in `folder` would replace an input.
void refuse_over_inputs(const Scene& scene, const std::string& folder);

/// Writes FOLDER/masks/STEM.png, FOLDER/scene.json and FOLDER/objects.json. `truth`: the folder of true masks that the
/// scene names. Returns false after a stop request.
bool write_groups(cli::Run& run, const Grouped& grouped, const std::string& folder, const std::string& truth);

}  // namespace ngs::group
