#pragma once
// Query points on the rays of the boundary grids (Eqs. 4-7), with the features that ngs-rbf adds (Eqs. 8-9). One struct
// for both artifacts: columns that no stage has computed yet are empty.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/math/pixel_grid.h"

namespace ngs {

/// The grid of one view. A view without visible boundary Gaussians has rows = cols = 0 and no queries.
struct QueryView {
  std::string name;        // Camera::name
  PixelBox box;            // Eq. (4), clipped to the image; or the whole image
  int rows = 0, cols = 0;  // grid nodes (rays): node (r, c) is ray r · cols + c
  int depth_samples = 0;   // samples per ray
  double mean_depth = 0;   // world, mean Euclidean distance from the camera centre to the boundary (C12)
};

struct QueryField {
  std::array<double, 3> origin{};  // world = origin + position; the model's GaussianCloud::origin
  double depth_span = 0;           // window ratio: half window of a ray = max(depth_span · t, depth_epsilon),
  double depth_epsilon = 0;        //   world; t = the ray's own centre depth
  std::vector<QueryView> views;    // indexed by `view`

  std::vector<float> position;     // [Q, 3] world, relative to origin
  std::vector<float> uv;           // [Q, 2] px, where the ray meets the image
  std::vector<std::int32_t> view;  // [Q] index into views
  std::vector<std::int32_t> slot;  // [Q] (row · cols + col) · depth_samples + k: grid node and sample k, near to far;
                                   //     skipped slots are absent
  std::vector<float> depth;        // [Q] world, Euclidean distance from the camera centre along the unit ray

  int features = 0;                      // F; 0: not interpolated yet
  std::vector<float> feature;            // [Q, F] f_inter                                             Eq. (9)
  int neighbours = 0;                    // K; 0: not searched yet
  std::vector<std::uint32_t> neighbour;  // [Q, K] row in the boundary PLY (= row of the model), nearest first
  std::vector<float> weight;             // [Q, K] Σ_k = 1                                             Eq. (8)

  std::int64_t size() const { return std::int64_t(position.size() / 3); }
};

}  // namespace ngs
