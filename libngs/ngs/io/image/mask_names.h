#pragma once
// Which mask file belongs to which view, whatever tool named it. For a view "a/0001.jpg", in this order:
//
//   <name>.png        a/0001.jpg.png     COLMAP; Brush
//   <name>            a/0001.jpg         same name as the photo
//   <stem>.png        a/0001.png         the usual one
//   <stem>.mask.png   a/0001.mask.png    Brush
//   <name>.mask.png   a/0001.jpg.mask.png  RealityScan
//   <stem>_mask.png   a/0001_mask.png    many scripts around segmenters
//   <stem>.<other>    a/0001.exr ...     any other image format; refused where there are several
//
// then the same without the folders of the name, if it is one view's only (files_of_views). If no view has a file
// so, sub-folders are objects: <object>/ and any of the above. A path that the source itself names (nerfstudio's
// mask_path) comes before all of these.
#include <map>
#include <string>
#include <vector>

#include "ngs/scene/scene.h"

namespace ngs::io {

struct MaskMatches {
  std::map<std::string, int> views_by_rule;  // "<stem>.png" -> 21
  std::vector<std::string> unmatched;        // views without a mask
  std::vector<std::string> of_no_view;       // paths of pictures among the masks that are no view's
  std::vector<std::string> objects;          // sub-folders that were taken as objects; empty: none
  int several = 0;                           // masks beside which another one lies that a later rule would have found
  std::string taken, not_taken;              // the first of these
};

/// Sets mask_path of every view of `views` that has a mask in `folder` and no mask_path yet. `objects`: the
/// names that the user gave (only these sub-folders count); empty: every sub-folder with a mask is an object.
MaskMatches match_masks(const std::string& folder, const std::vector<std::string>& objects,
                        std::vector<SceneView>& views);

/// Whether a folder of photos holds masks too, called <name>.mask.png, <stem>.mask.png or <stem>_mask.png.
bool holds_masks_beside(const std::string& folder, const std::vector<SceneView>& views);

}  // namespace ngs::io
