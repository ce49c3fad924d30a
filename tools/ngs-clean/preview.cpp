#include "preview.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ngs/core/error.h"
#include "ngs/io/image/image_file.h"
#include "ngs/math/world_unit.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/stages/orbit/rigs.h"
#include "ngs/stages/select/canonical_points.h"

namespace ngs::clean {
namespace {

constexpr int kSide_px = 480, kGap_px = 4;
constexpr double kElevation = 0.35;                   // sine of the angle above the horizontal
constexpr Vec3<float> kBackground{0.5f, 0.5f, 0.5f};  // removed Gaussians are dark or bright

/// Two poses around the bulk; for a room, two directions from inside.
std::array<orbit::Pose, 2> poses_for(const orbit::RoomFinding& room, double radius, const orbit::Lens& lens) {
  if (room.is_room()) {
    const orbit::Vec stand = room.viewpoints.front(), level{-stand.x, -stand.y, 0};
    const orbit::Vec ahead = orbit::length(level) > 0.1 * radius ? orbit::unit(level) : orbit::Vec{1, 0, 0};
    return {{{stand, stand + radius * ahead}, {stand, stand - radius * ahead}}};
  }
  const double distance = radius / lens.least_half_sine(), level = std::sqrt(1 - kElevation * kElevation);
  return {{{distance * orbit::Vec{0, level, kElevation}, {0, 0, 0}},
           {distance * orbit::Vec{0, -level, kElevation}, {0, 0, 0}}}};
}

struct Look {
  std::array<Camera, 2> cameras;
  double world_unit = 1;  // math/world_unit.h
};

Look look_at(const Exec& exec, const GaussianCloud& cloud) {
  const orbit::SurfacePoints points = canonical_points(cloud);
  if (points.count() == 0)
    throw Error(ErrorCode::kNothingFound, "--preview: no Gaussian is visible, expected some", "leave --preview out");
  const orbit::Ball bulk = orbit::bulk_of(points);
  const orbit::Frame frame = orbit::frame_about(points, bulk, orbit::guess_up(points, bulk).up);
  const orbit::FreeSpace space(cloud, points, frame, {1.1 * bulk.radius, 64});
  const orbit::RoomFinding room = orbit::find_room(exec, space, bulk.radius);
  const orbit::Lens lens{kSide_px, kSide_px, room.is_room() ? 80.0 : 40.0};
  const auto poses = poses_for(room, bulk.radius, lens);
  return {
      {orbit::camera_at(poses[0], lens, frame, cloud.origin), orbit::camera_at(poses[1], lens, frame, cloud.origin)},
      world_unit_for(0.1 * bulk.radius, near_plane(Compat::kGsplat))};
}

/// The model with only the rows where `keep` equals `kept`.
GaussianCloud shown(GaussianCloud cloud, const std::vector<std::uint8_t>& keep, bool kept) {
  for (std::size_t i = 0; i < keep.size(); ++i)
    if ((keep[i] != 0) != kept) cloud.usable[i] = 0;
  return cloud;
}

void paste(const ImageU8& colour, ImageU8& sheet, int left, int top) {
  for (int y = 0; y < colour.height_px; ++y)
    for (int x = 0; x < colour.width_px; ++x)
      for (int c = 0; c < 3; ++c) {
        const std::size_t from = (std::size_t(y) * std::size_t(colour.width_px) + std::size_t(x)) * 3 + std::size_t(c);
        const std::size_t to =
            (std::size_t(top + y) * std::size_t(sheet.width_px) + std::size_t(left + x)) * 3 + std::size_t(c);
        sheet.data[to] = colour.data[from];
      }
}

}  // namespace

void write_preview(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& keep,
                   const std::string& path) {
  const Look look = look_at(exec, cloud);
  ImageU8 sheet(3 * kSide_px + 2 * kGap_px, 2 * kSide_px + kGap_px, 3);
  std::ranges::fill(sheet.data, std::uint8_t(255));
  RenderRequest request;
  request.background = kBackground;
  const SplatOptions splat{.compat = Compat::kGsplat, .antialiased = cloud.antialiased, .world_unit = look.world_unit};
  for (int column = 0; column < 3; ++column) {
    const GaussianCloud part = column == 0 ? cloud : shown(cloud, keep, column == 1);
    for (int row = 0; row < 2; ++row)
      paste(to_bytes(render(exec, part, look.cameras[std::size_t(row)], splat, request).colour), sheet,
            column * (kSide_px + kGap_px), row * (kSide_px + kGap_px));
  }
  io::write_png(path, sheet);
}

}  // namespace ngs::clean
