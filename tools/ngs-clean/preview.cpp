#include "preview.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ngs/core/error.h"
#include "ngs/edit/select/canonical_points.h"
#include "ngs/io/image/image_file.h"
#include "ngs/math/world_unit.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/orbit/rigs.h"

namespace ngs::clean {
namespace {

constexpr int kSide_px = 480, kGap_px = 4;
constexpr double kElevation = 0.35;                   // sine of the angle above the horizontal
constexpr Vec3<float> kBackground{0.5f, 0.5f, 0.5f};  // removed Gaussians are dark or bright

/// Two poses around the bulk; for a room, two directions from inside.
std::array<orbit::Pose, 2> poses_for(const orbit::RoomFinding& room, double radius,
                                     const orbit::Intrinsics& intrinsics) {
  if (room.is_room()) {
    const orbit::Vec viewpoint = room.viewpoints.front(), level_direction{-viewpoint.x, -viewpoint.y, 0};
    const orbit::Vec ahead = length(level_direction) > 0.1 * radius ? unit(level_direction) : orbit::Vec{1, 0, 0};
    return {{{viewpoint, viewpoint + radius * ahead}, {viewpoint, viewpoint - radius * ahead}}};
  }
  const double distance = radius / intrinsics.least_half_sine();
  const double cos_elevation = std::sqrt(1 - kElevation * kElevation);
  return {{{distance * orbit::Vec{0, cos_elevation, kElevation}, {0, 0, 0}},
           {distance * orbit::Vec{0, -cos_elevation, kElevation}, {0, 0, 0}}}};
}

struct PreviewCameras {
  std::array<Camera, 2> cameras;
  double world_unit = 1;  // math/world_unit.h
};

PreviewCameras preview_cameras(const Exec& exec, const GaussianCloud& cloud) {
  const orbit::SurfacePoints points = canonical_points(cloud);
  if (points.count() == 0)
    throw Error(ErrorCode::kNothingFound, "--preview: no Gaussian is visible, expected some", "leave --preview out");
  const orbit::Ball bulk = orbit::bulk_of(points);
  const orbit::Frame frame = orbit::frame_about(points, bulk, orbit::guess_up(points, bulk).up);
  const orbit::FreeSpace space(cloud, points, frame, {1.1 * bulk.radius, 64});
  const orbit::RoomFinding room = orbit::find_room(exec, space, bulk.radius);
  const orbit::Intrinsics intrinsics{kSide_px, kSide_px, room.is_room() ? 80.0 : 40.0};
  const auto poses = poses_for(room, bulk.radius, intrinsics);
  return {{orbit::camera_at(poses[0], intrinsics, frame, cloud.origin),
           orbit::camera_at(poses[1], intrinsics, frame, cloud.origin)},
          world_unit_for(0.1 * bulk.radius, near_plane(Compat::kGsplat))};
}

/// The model with only the rows where `keep` equals `value`.
GaussianCloud only_rows(GaussianCloud cloud, const std::vector<std::uint8_t>& keep, bool value) {
  for (std::size_t i = 0; i < keep.size(); ++i)
    if ((keep[i] != 0) != value) cloud.usable[i] = 0;
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
  const PreviewCameras views = preview_cameras(exec, cloud);
  ImageU8 sheet(3 * kSide_px + 2 * kGap_px, 2 * kSide_px + kGap_px, 3);
  std::ranges::fill(sheet.data, std::uint8_t(255));
  RenderRequest request{.label = {}, .background = kBackground};
  const SplatOptions splat{.compat = Compat::kGsplat, .antialiased = cloud.antialiased, .world_unit = views.world_unit};
  for (int column = 0; column < 3; ++column) {
    const GaussianCloud part = column == 0 ? cloud : only_rows(cloud, keep, column == 1);
    for (int row = 0; row < 2; ++row)
      paste(to_bytes(render(exec, part, views.cameras[std::size_t(row)], splat, request).colour), sheet,
            column * (kSide_px + kGap_px), row * (kSide_px + kGap_px));
  }
  io::write_png(path, sheet);
}

}  // namespace ngs::clean
