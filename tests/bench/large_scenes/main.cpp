// Generates very large scenes for tests/bench/large.sh.
//
//   ngs_large rooms OUT CAPTURE MODEL ROOMS VIEWS WIDTHxHEIGHT   copies of a capture side by side
//   ngs_large copies OUT.ply CAPTURE MODEL COPIES hidden|outside  copies of its model, for its cameras
//   ngs_large balls OUT BALLS GAUSSIANS VIEWS                    many objects, with exact label maps
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string_view>

#include "large_scenes/balls.h"
#include "large_scenes/rooms.h"
#include "ngs/core/error.h"

namespace ngs::bench {
namespace {

int usage() {
  std::cerr << "ngs_large rooms OUT CAPTURE MODEL ROOMS VIEWS WIDTHxHEIGHT | copies OUT.ply CAPTURE MODEL COPIES "
               "hidden|outside | balls OUT BALLS GAUSSIANS VIEWS\n";
  return 2;
}

int make(int argc, char** argv) {
  const std::string_view what = argc > 1 ? argv[1] : "";
  if (what == "rooms" && argc == 8) {
    RoomsOptions options{argv[3], argv[4], std::atoi(argv[5]), std::atoi(argv[6])};
    if (std::sscanf(argv[7], "%dx%d", &options.width_px, &options.height_px) != 2) return usage();
    write_rooms(options, argv[2]);
    return 0;
  }
  if (what == "copies" && argc == 7) {
    const bool hidden = std::string_view(argv[6]) == "hidden";
    if (!hidden && std::string_view(argv[6]) != "outside") return usage();
    write_copies({.capture = argv[3], .model = argv[4], .rooms = std::atoi(argv[5])},
                 hidden ? CopyPlacement::kBehindWalls : CopyPlacement::kOutsideViews, argv[2]);
    return 0;
  }
  if (what == "balls" && argc == 6) {
    write_balls({.balls = std::atoi(argv[3]), .views = std::atoi(argv[5]), .gaussians = std::atof(argv[4])}, argv[2]);
    return 0;
  }
  return usage();
}

}  // namespace
}  // namespace ngs::bench

int main(int argc, char** argv) {
  try {
    return ngs::bench::make(argc, argv);
  } catch (const ngs::Error& error) {
    std::cerr << "ngs_large: " << error.what() << "\n";
    return 4;
  }
}
