#pragma once
// Masks in JSON files of annotation programs, by the names of the photos:
//   labelme   a file per photo: "shapes" with label, shape_type polygon, rectangle or circle, and points
//   COCO      a file for all photos: "images", "categories", "annotations" with polygons or run lengths (RLE)
// A label or category is an object; the mask of an object is the union of its shapes.
#include <string>
#include <vector>

#include "ngs/scene/scene.h"

namespace ngs::io {

bool is_annotations(const std::string& path);

struct AnnotationMatches {
  std::vector<std::string> labels;  // of the matching files, sorted
  int views = 0;                    // that got a mask_path
};

/// Sets mask_path of the views without one that these files annotate. Files that are neither labelme nor COCO are
/// skipped; kBadInput for a broken one of these.
AnnotationMatches match_annotations(const std::vector<std::string>& files, std::vector<SceneView>& views);

/// The masks of a view that match_annotations() matched, a plane [H, W, 1] of 0 and 1 per object, at the size of the
/// annotations.
std::vector<ImageF> read_annotations(const std::string& path, const std::string& view,
                                     const std::vector<SceneObject>& objects);

/// All masks of a view in such a file as an id map [H, W, 1], whatever their labels: ids 1, 2, … in the order of their
/// size, the largest first, smaller masks over larger ones; 0: no mask. kBadInput for more than 65,535 masks.
ImageU16 read_id_map(const std::string& path, const std::string& view);

}  // namespace ngs::io
