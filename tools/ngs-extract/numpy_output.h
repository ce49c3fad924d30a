#pragma once
// Labels for array programs (numpy, gsplat, nerfstudio): one .npz, rows in the order of the model.
//
// clang-format off
//   labels    float32 [N]  label of each Gaussian in [0, 1], before rounding
//   seen      bool [N]     some view has evidence of the Gaussian; if false, its label carries no information
//   object    int64 [M]    rows of the object, as written by --object-ply, ascending
//   labels_NAME, seen_NAME, object_NAME   with several objects: the same per object; the above are for their union
// clang-format on
#include <string>
#include <vector>

#include "extractor.h"

namespace ngs::cli {

class NumpyLabels {
 public:
  /// Construct it before Extractor::decide(), which rounds the labels.
  explicit NumpyLabels(const Extractor& extractor);

  /// Call it after decide(). Uncompressed and dated 1980, so that the same labels give the same bytes.
  void write(const std::string& path, const Extractor& extractor) const;

 private:
  std::vector<std::vector<float>> labels_;  // [chosen objects][N]
};

}  // namespace ngs::cli
