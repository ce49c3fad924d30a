#pragma once
// Many objects in one scene: balls on a floor, whose photos and label maps are exact.
#include <string>

namespace ngs::bench {

struct BallsOptions {
  int balls = 100, views = 60;  // at most 255 balls: their ids are bytes
  int width_px = 640, height_px = 480;
  double gaussians = 1e6;
};

/// Gaussians of all balls take turns in the file: none of them has rows together.
void write_balls(const BallsOptions& options, const std::string& folder);

}  // namespace ngs::bench
