#pragma once
// Compares the masks of a result with the masks that it was made from.
#include <string>
#include <vector>

#include "ngs/scene/scene.h"

namespace ngs::ngs_tool {

struct ResultAgreement {
  std::size_t masks = 0;           // compared: one of each object in each view that has a mask and a picture
  double median = 1;               // IoU
  std::vector<std::string> apart;  // "0001.png" or "0001.png (cup)": IoU below 0.5, in the order of the views
  double least = 1;                // IoU of the worst of them
  std::string mistakes;            // "0001.png: mirrored (...)"; empty: no usual mistake explains them
  bool covers_borders = false;     // the result covers most of the borders of the pictures

  /// A sentence about what disagrees; empty: the result agrees with its masks.
  std::string text() const;
};

/// `scene` has the given masks; `folder` the masks of the result: NAME.png or OBJECT/NAME.png. Views without a file
/// there, and masks in which neither shows the object, are not compared. Throws as load_masks().
ResultAgreement compare_with_masks(const Scene& scene, const std::string& folder);

}  // namespace ngs::ngs_tool
