#include "mask_views.h"

#include <algorithm>

#include "ngs/core/error.h"
#include "ngs/cut/groups/surface_parts.h"
#include "ngs/io/image/mask_names.h"
#include "ngs/io/image/masks.h"
#include "ngs/orbit/orbit_stage.h"
#include "ngs/problem/view_list.h"
#include "ngs/scene/geometry/frame.h"

namespace ngs::group {

Scene with_masks_of(cli::Run& run, Scene scene, const std::string& scene_path, const std::string& folder) {
  if (!folder.empty()) {
    for (SceneView& view : scene.views) view.mask_path.clear();
    if (!io::match_masks(folder, {}, scene.views).objects.empty())
      throw Error(ErrorCode::kInconsistent, folder + ": one folder per object, expected one label map per view",
                  "the objects of these masks are known: import them with the capture, without this tool");
    scene.mask_mode = MaskMode::kLabel;
  }
  if (scene.mask_mode != MaskMode::kLabel)
    throw Error(ErrorCode::kInconsistent, scene_path + ": its masks are no label maps, expected masks of everything",
                "name their folder with --masks DIR");
  std::size_t without = 0;
  for (SceneView& view : scene.views) {
    if (view.split == Split::kHeldOut) view.mask_path.clear();
    without += view.split == Split::kTrain && view.mask_path.empty();
  }
  const std::size_t views = training_views(scene).size();
  if (without == views)
    throw Error(ErrorCode::kInconsistent,
                (folder.empty() ? scene_path : folder) + ": no mask of any view (such as " +
                    scene.views[0].camera.name + "), expected label maps named after the photos",
                "name their folder with --masks DIR");
  if (without > 0) run.monitor().warn(std::to_string(without) + " of " + std::to_string(views) + " views have no mask");
  return scene;
}

NumberedMasks read_masks(const Scene& scene, std::size_t view) {
  const SceneView& of = scene.views[view];
  if (of.mask_path.empty()) return {};
  NumberedMasks masks{io::read_label_map(of.mask_path, of.camera, scene.image_scale), 0};
  std::vector<std::uint16_t> number(65536);
  for (const std::uint16_t id : masks.number.data) number[id] = 1;
  number[0] = 0;
  if (scene.void_id) number[std::min<std::uint32_t>(*scene.void_id, 65535)] = 0;
  constexpr int kMaxMasks = 1024;
  for (std::uint16_t& n : number)
    if (n != 0) n = std::uint16_t(++masks.masks);
  if (masks.masks > kMaxMasks)
    throw Error(ErrorCode::kBadInput,
                of.mask_path + ": " + std::to_string(masks.masks) + " masks in one view, expected at most " +
                    std::to_string(kMaxMasks),
                "save the ids of the masks, not a depth map or a picture");
  if (scene.void_id && *scene.void_id <= 65535) number[*scene.void_id] = NumberedMasks::kUnknown;
  for (std::uint16_t& id : masks.number.data) id = number[id];
  return masks;
}

orbit::Vec up_of(const io::GaussianPly& ply) {
  const UpAxis axis = up_or(UpAxis::kAuto, ply.vertical_axis);
  const orbit::SurfacePoints points = orbit::surface_points(ply.cloud);
  if (axis != UpAxis::kAuto || points.count() == 0) return orbit::axis_of(axis);
  return orbit::guess_up(points, orbit::bulk_of(points)).up;
}

std::vector<NumberedMasks> masks_of_surface(cli::Run& run, const Scene& scene, const std::vector<std::size_t>& views,
                                            const io::GaussianPly& ply, const SplatOptions& splat) {
  const auto timed = run.monitor().scope("surface");
  std::vector<DepthView> depths(views.size());
  const bool complete = for_each_view(&run.monitor(), views, [&](std::size_t n, std::size_t v) {
    depths[n] = depth_view(run.exec(), ply.cloud, scene.views[v].camera, splat);
  });
  if (!complete) return {};
  const SurfaceCells cells = surface_cells(run.exec(), depths);
  const SurfaceParts parts = surface_parts(cells, up_of(ply));
  std::vector<NumberedMasks> masks;
  for (const DepthView& view : depths) masks.push_back(masks_of_parts(view, cells, parts));
  return masks;
}

NumberedMasks at_size_of(const Camera& camera, NumberedMasks masks) {
  const ImageU16& from = masks.number;
  if (from.empty() || (from.width_px == camera.width_px && from.height_px == camera.height_px)) return masks;
  ImageU16 to(camera.width_px, camera.height_px, 1);
  for (int y = 0; y < to.height_px; ++y)
    for (int x = 0; x < to.width_px; ++x)  // the pixel below the centre of the new one
      to.at(x, y) = from.at(int((2 * std::int64_t(x) + 1) * from.width_px / (2 * std::int64_t(to.width_px))),
                            int((2 * std::int64_t(y) + 1) * from.height_px / (2 * std::int64_t(to.height_px))));
  masks.number = std::move(to);
  return masks;
}

}  // namespace ngs::group
