#pragma once
// Copies of a capture side by side: a scene with any number of Gaussians and views, and with real statistics.
#include <cstdint>
#include <string>

namespace ngs::bench {

struct RoomsOptions {
  std::string capture, model;  // a COLMAP folder with images/ and masks_label/, and its splat
  int rooms = 1, views = 0;
  int width_px = 0, height_px = 0;
};

/// Room r is next to room r - 1, at three times the extent of the cameras. Views are assigned to rooms in turn; a room
/// with more views than the capture reuses cameras. Photos are enlarged copies; only the label maps of the first room
/// contain objects.
void write_rooms(const RoomsOptions& options, const std::string& folder);

/// Placement of copies relative to the cameras of the capture: next to the room, occluded by walls, or far above,
/// outside all views.
enum class CopyPlacement : std::uint8_t { kBehindWalls, kOutsideViews };

/// Writes options.rooms copies of the model as a PLY.
void write_copies(const RoomsOptions& options, CopyPlacement where, const std::string& path);

}  // namespace ngs::bench
