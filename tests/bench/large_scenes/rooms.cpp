#include "large_scenes/rooms.h"

#include <algorithm>
#include <filesystem>

#include "large_scenes/written_scene.h"
#include "ngs/io/capture/colmap.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/math/pixel_grid.h"
#include "ngs/ops/image/image_bytes.h"

namespace ngs::bench {
namespace {

constexpr double kRoomStep = 3, kOutsideStep = 60;  // in extents of the cameras

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Copy r is shifted by r steps along an axis.
GaussianCloud repeated(const GaussianCloud& room, int rooms, double step, std::size_t axis) {
  GaussianCloud all;
  all.origin = room.origin, all.sh_degree = room.sh_degree, all.antialiased = room.antialiased;
  for (int r = 0; r < rooms; ++r) {
    const std::size_t first = all.position.size();
    append(all.position, room.position), append(all.rotation, room.rotation), append(all.log_scale, room.log_scale);
    append(all.logit_opacity, room.logit_opacity), append(all.sh_dc, room.sh_dc), append(all.sh_rest, room.sh_rest);
    append(all.usable, room.usable);
    for (std::size_t i = first + axis; i < all.position.size(); i += 3) all.position[i] += float(r * step);
  }
  return all;
}

double extent_x(const std::vector<SceneView>& views) {
  const auto x = [](const SceneView& view) { return view.camera.centre().x; };
  const auto [least, most] = std::ranges::minmax_element(views, {}, x);
  return x(*most) - x(*least);
}

ImageF enlarged(const ImageF& image, int width_px, int height_px) {
  ImageF out(width_px, height_px, image.channels);
  const double sx = double(image.width_px) / width_px, sy = double(image.height_px) / height_px;
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x)
      for (int c = 0; c < image.channels; ++c)
        out.at(x, y, c) = float(read_bilinear((x + 0.5) * sx, (y + 0.5) * sy, image.width_px, image.height_px,
                                              [&](int column, int row) { return image.at(column, row, c); }));
  return out;
}

/// Enlarged photo `name` of the capture; a room without objects has only background labels.
LabelledPhoto picture_of(const RoomsOptions& options, const std::string& name, bool shows_objects) {
  const ImageF photo = io::read_image_rgb(options.capture + "/images/" + name);
  LabelledPhoto made{to_bytes(enlarged(photo, options.width_px, options.height_px)),
                     ImageU8(options.width_px, options.height_px, 1)};
  if (!shows_objects) return made;
  const std::string stem = std::filesystem::path(name).stem().string();
  const io::RawMask map = io::read_mask_raw(options.capture + "/masks_label/" + stem + ".png", io::Palette::kIndices);
  for (int y = 0; y < options.height_px; ++y)
    for (int x = 0; x < options.width_px; ++x) {
      const auto from_x = std::size_t(x) * std::size_t(map.width_px) / std::size_t(options.width_px),
                 from_y = std::size_t(y) * std::size_t(map.height_px) / std::size_t(options.height_px);
      made.label.at(x, y) = std::uint8_t(map.data[from_y * std::size_t(map.width_px) + from_x]);
    }
  return made;
}

}  // namespace

void write_rooms(const RoomsOptions& options, const std::string& folder) {
  const std::vector<SceneView> given = io::read_colmap(io::find_colmap_model(options.capture)).views;
  const double step = kRoomStep * extent_x(given);
  const auto rooms = std::size_t(options.rooms), wanted = std::size_t(options.views);
  std::vector<WrittenView> views;
  for (std::size_t v = 0; v < wanted; ++v) {
    const std::size_t room = v % rooms, of_room = (wanted - room + rooms - 1) / rooms, turn = v / rooms;
    // Fewer views than the capture has are spread evenly over its cameras.
    const std::size_t source = of_room < given.size() ? turn * given.size() / of_room : turn % given.size();
    Camera camera = resized(given[source].camera, options.width_px, options.height_px);
    camera.name = view_name(v);
    camera.translation = camera.translation - camera.rotation * Vec3<double>{double(room) * step, 0, 0};
    views.push_back({camera, 2 * source + (room == 0 ? 0 : 1)});
  }
  const GaussianCloud cloud = repeated(io::read_gaussian_ply(options.model).cloud, options.rooms, step, 0);
  write_scene(folder, cloud, views, [&](std::size_t picture) {
    return picture_of(options, given[picture / 2].camera.name, picture % 2 == 0);
  });
}

void write_copies(const RoomsOptions& options, CopyPlacement where, const std::string& path) {
  const double extent = extent_x(io::read_colmap(io::find_colmap_model(options.capture)).views);
  const GaussianCloud room = io::read_gaussian_ply(options.model).cloud;
  const bool is_behind_walls = where == CopyPlacement::kBehindWalls;
  io::write_strict_ply(
      path,
      repeated(room, options.rooms, (is_behind_walls ? kRoomStep : kOutsideStep) * extent, is_behind_walls ? 0 : 1), {},
      {});
}

}  // namespace ngs::bench
