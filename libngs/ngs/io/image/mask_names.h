#pragma once
// Matches mask files with views, for the naming schemes of many tools. For a view "a/0001.jpg", in this order:
//
// clang-format off
//   <name>.png        a/0001.jpg.png       COLMAP; Brush
//   <name>            a/0001.jpg           same name as the photo
//   <stem>.png        a/0001.png           the most common one
//   <stem>.mask.png   a/0001.mask.png      Brush
//   <name>.mask.png   a/0001.jpg.mask.png  RealityScan
//   <stem>_mask.png   a/0001_mask.png      many segmentation scripts; also <stem>-mask.png and mask_<stem>.png
//   <stem>.jpg.png    a/0001.jpg.png       made from JPEGs that were converted since; also <stem>.jpeg.png
//   <stem>.<other>    a/0001.exr ...       any other image format; no match if there are several
// clang-format on
//
// Then the same without the folders of the name, if only one view fits (files_of_views), or with "_" between them
// (a_0001.png). If this finds no mask for any view: the stem with what all masks have around it (seg_0001_0.png), if
// there is one such mask for a view; then sub-folders are objects: <object>/ and any of the names above. A path in the
// source itself (nerfstudio's mask_path) takes precedence over all of these.
#include <map>
#include <string>
#include <vector>

#include "ngs/scene/scene.h"

namespace ngs::io {

struct MaskMatches {
  std::map<std::string, int> views_by_rule;  // "<stem>.png" -> 21
  std::vector<std::string> unmatched;        // views without a mask
  std::vector<std::string> of_no_view;       // paths of images in the mask folder that match no view
  std::vector<std::string> objects;          // sub-folders used as objects; empty: none
  int several = 0;                           // views with a second mask, which a later rule would have found
  std::string taken, not_taken;              // of the first such view
};

/// Sets mask_path of every view that has a mask in `folder` and no mask_path yet. `objects`: object names given by the
/// user (only these sub-folders are used); empty: every sub-folder with a mask is an object.
MaskMatches match_masks(const std::string& folder, const std::vector<std::string>& objects,
                        std::vector<SceneView>& views);

/// Gives the images of `folder` to the views in the order of their names, numbers by value: first to first. Throws
/// kInconsistent unless there are as many.
MaskMatches pair_masks_in_order(const std::string& folder, std::vector<SceneView>& views);

/// Gives each view the mask that is `shift` names later than its own, in the order of the names of all views and of the
/// masks of no view. Updates `unmatched` and `of_no_view`.
void shift_masks(int shift, std::vector<SceneView>& views, MaskMatches& matches);

/// Whether a photo folder also contains masks named <name>.mask.png, <stem>.mask.png or <stem>_mask.png.
bool photo_folder_holds_masks(const std::string& folder, const std::vector<SceneView>& views);

}  // namespace ngs::io
