#pragma once
// Labels for array programs (numpy, gsplat, nerfstudio): one .npz, rows in the order of the model.
//
//   labels       float32 [N]  how much of each Gaussian is the object, in [0, 1], before it is decided
//   seen         bool [N]     some view has evidence of it; where not, its label says nothing
//   object       int64 [M]    rows that are the object, as --object writes them, ascending
//   labels_NAME, seen_NAME, object_NAME   the same of each object, where there are several: the three above are then of
//                             all of them together
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
