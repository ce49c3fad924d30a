#pragma once
// Many objects in one scene: balls on a floor, with exact photos and label maps.
#include <string>

namespace ngs::bench {

struct BallsOptions {
  int balls = 100, views = 60;  // at most 255 balls, since ids are bytes
  int width_px = 640, height_px = 480;
  double gaussians = 1e6;
};

/// Gaussians of the balls are interleaved in the file: no ball has contiguous rows.
void write_balls(const BallsOptions& options, const std::string& folder);

}  // namespace ngs::bench
