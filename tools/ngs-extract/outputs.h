#pragma once
// The outputs of ngs-extract; at least one is required.
#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>
#include <vector>

#include "extractor.h"
#include "ngs/core/error.h"
#include "ngs/io/formats/splat_format.h"
#include "ngs/scene/scene.h"
#include "shared/tool.h"

namespace ngs::cli {

struct Outputs {
  const Output &object, &objects, &background, &background_filled, &filled, &decided, &supersplat, &npz, &inpaint;
};

inline Outputs declare_outputs(Tool& tool) {
  return {
      tool.optional_output("--object-ply", std::string("the object: ") + io::kOutputFormats),
      tool.resumed_output_dir("--objects", "with several objects: folder for each of them alone, NAME.ply"),
      tool.optional_output("--background-ply", "everything else, in the same formats"),
      tool.optional_output("--background-filled", "the same with its hole filled; not written if nothing is filled"),
      tool.optional_output("--filled", "the Gaussians that fill the hole alone, in the same formats"),
      tool.optional_output("--labelled", "the labelled model with ngs_label decided to 0 or 1"),
      tool.optional_output("--supersplat", "the same with the object selected in SuperSplat"),
      tool.optional_output("--npz", "labels and row numbers of the object, for numpy"),
      tool.optional_output_dir("--inpaint", "folder for inpainting: background, cameras, hole masks of every view")};
}

/// Throws kUsage if no output is requested.
inline void require_one_of(const Outputs& out) {
  std::string flags;
  for (const Output* output : {&out.object, &out.objects, &out.background, &out.background_filled, &out.filled,
                               &out.decided, &out.supersplat, &out.npz, &out.inpaint}) {
    if (*output) return;
    flags += (flags.empty() ? "" : ", ") + output->flags;
  }
  throw Error(ErrorCode::kUsage, "no output was given, expected one of " + flags);
}

/// Whether an output has a format that --up turns and --unit scales.
inline bool turns_any(const Outputs& out) {
  return std::ranges::any_of(
      std::array{&out.object, &out.background, &out.background_filled, &out.filled},
      [](const Output* output) { return *output && io::output_format(output->path) != io::SplatFormat::kPly; });
}

/// Throws kUsage for a format that cannot be written. Outputs that were not requested have an empty path.
inline void check_formats(const Outputs& out) {
  for (const std::string& splat : {out.object.path, out.background.path, out.background_filled.path, out.filled.path})
    (void)io::output_format(splat);
  for (const std::string& labelled : {out.decided.path, out.supersplat.path}) io::require_ply_output(labelled);
}

/// Reports the parts of the object's surface that no view sees, after Extractor::decide(); nothing if it is empty.
void report_unseen_surface(Run& run, const Extractor& extractor, const Scene& scene);

// Labels for array programs (numpy, gsplat, nerfstudio): one .npz, rows in the order of the model.
//
// clang-format off
//   labels    float32 [N]  label of each Gaussian in [0, 1], before rounding
//   seen      bool [N]     some view has evidence of the Gaussian; if false, its label carries no information
//   object    int64 [M]    rows of the object, as written by --object-ply, ascending
//   labels_NAME, seen_NAME, object_NAME   with several objects: the same per object; the above are for their union
// clang-format on
class NumpyLabels {
 public:
  /// Construct it before Extractor::decide(), which rounds the labels.
  explicit NumpyLabels(const Extractor& extractor);

  /// Call it after decide(). Uncompressed and dated 1980, so that the same labels give the same bytes.
  void write(const std::string& path, const Extractor& extractor) const;

 private:
  std::vector<std::vector<float>> labels_;  // [chosen objects][N]
};

// Writes the object, and each of several alone; with a scene clipped to the places that its views support.

/// Call it after Extractor::decide(). `scene`: clips the objects to its views and to the masks of its training views;
/// null: they are written as they are. The objects' own files are written only if there are several.
void write_objects(Run& run, const Extractor& extractor, const Scene* scene, const Outputs& out);

}  // namespace ngs::cli
