// What refined contours say of masks and labels.
#include "ngs/passes/contours/refined_masks.h"

#include <doctest/doctest.h>

namespace ngs {

TEST_CASE("labels lie on edges where the photos have next to nothing to add to their contours' contrast") {
  RefinedView near, far;
  near.rendered_contrast = 0.75, near.refined_contrast = 0.76;
  far.rendered_contrast = 0.5, far.refined_contrast = 0.6;
  CHECK(labels_on_edges({near}));
  CHECK_FALSE(labels_on_edges({far}));
  CHECK_FALSE(labels_on_edges({near, far}));  // on the mean
}

}  // namespace ngs
