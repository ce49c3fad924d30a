#pragma once
// A capture several times side by side: as many Gaussians and views as are wanted, of a real scene's kind.
#include <cstdint>
#include <string>

namespace ngs::bench {

struct RoomsOptions {
  std::string capture, model;  // a COLMAP folder with images/ and masks_label/, and its splat
  int rooms = 1, views = 0;
  int width_px = 0, height_px = 0;
};

/// Room r stands beside room r - 1, three times the extent of the cameras away. Views go round the rooms, so that each
/// has its share; what a room has more of them than the capture are the same cameras once more. Photos are the
/// capture's, enlarged; only the label maps of the first room show anything.
void write_rooms(const RoomsOptions& options, const std::string& folder);

/// Where copies of a room stand for the cameras of its capture: beside it as rooms do, where walls hide them, or so far
/// above and below it that no camera looks there.
enum class CopiesStand : std::uint8_t { kBehindWalls, kOutOfSight };

/// The model of `options` options.rooms times, as a PLY.
void write_copies(const RoomsOptions& options, CopiesStand where, const std::string& path);

}  // namespace ngs::bench
