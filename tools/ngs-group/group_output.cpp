#include "group_output.h"

#include <algorithm>
#include <filesystem>

#include "mask_views.h"
#include "ngs/cut/groups/object_maps.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/orbit/orbit_stage.h"
#include "ngs/problem/view_list.h"
#include "ngs/scene/geometry/frame.h"
#include "ngs/scene/view_names.h"
#include "shared/scene/scene_model.h"

namespace ngs::group {
namespace {

using orbit::Vec;

/// The interval with all but kFar of the values at either end, so that a stray Gaussian does not enlarge it.
std::pair<double, double> extent(std::vector<double> values) {
  constexpr double kFar = 0.005;
  const auto rank = std::ptrdiff_t(kFar * double(values.size()));
  const auto low = values.begin() + rank, high = values.end() - 1 - rank;
  std::nth_element(values.begin(), low, values.end());
  const double least = *low;
  std::nth_element(values.begin(), high, values.end());
  return {least, *high};
}

Json geometry_of(const GaussianCloud& cloud, const std::vector<std::uint32_t>& rows, Vec up) {
  std::vector<double> along[4];
  for (const std::uint32_t i : rows) {
    const Vec at = world_position(cloud, i);
    const double value[4] = {at.x, at.y, at.z, dot(at, up)};
    for (std::size_t c = 0; c < 4; ++c) along[c].push_back(value[c]);
  }
  Json low, high, centre;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto [least, most] = extent(along[c]);
    low.push_back(least);
    high.push_back(most);
    centre.push_back((least + most) / 2);
  }
  const auto [bottom, top] = extent(along[3]);
  return {{"box", {{"min", low}, {"max", high}}}, {"centre", centre}, {"height", top - bottom}};
}

Json objects_json(const Grouped& grouped) {
  const GroupedObjects& found = grouped.objects;
  const Vec up = up_of(grouped.ply);
  std::vector<std::vector<std::uint32_t>> rows(found.objects.size());
  for (std::size_t i = 0; i < found.object.size(); ++i)
    if (found.object[i] > 0) rows[found.object[i] - 1].push_back(std::uint32_t(i));
  Json sure = Json::array(), doubtful = Json::array();
  for (std::size_t k = 0; k < found.objects.size(); ++k) {
    const GroupedObject& object = found.objects[k];
    const bool is_sure = k < found.sure;
    Json entry = is_sure ? Json{{"name", object_name(k)}, {"id", k + 1}} : Json::object();
    entry["gaussians"] = object.gaussians;
    entry.update(geometry_of(grouped.ply.cloud, rows[k], up));
    entry["confidence"] = object.confidence;
    if (object.part_of > 0 && object.part_of <= found.sure) {
      entry["part_of"] = object_name(object.part_of - 1);
      entry["part_share"] = object.part_share;
    }
    entry["views"] = Json::array();
    for (const std::size_t v : object.views)
      entry["views"].push_back(grouped.scene.views[grouped.views[v]].camera.name);
    (is_sure ? sure : doubtful).push_back(std::move(entry));
  }
  return {{"ngs_objects", 1}, {"up", {up.x, up.y, up.z}}, {"objects", sure}, {"doubtful", doubtful}};
}

std::string mask_file(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / "masks" / (name + ".png")).generic_string();
}

}  // namespace

void refuse_over_inputs(const Scene& scene, const std::string& folder) {
  std::vector<std::string> written;
  for (const std::string& name : output_names(scene.views)) written.push_back(mask_file(folder, name));
  cli::refuse_over_photos(scene, written);
  for (const SceneView& view : scene.views)
    for (const std::string& file : written)
      if (std::error_code ignored;
          !view.mask_path.empty() && std::filesystem::equivalent(view.mask_path, file, ignored))
        throw Error(ErrorCode::kUsage, file + ": is a mask of the scene, which this run would replace",
                    "choose another folder for the output");
}

std::string object_name(std::size_t index) {
  const std::string digits = std::to_string(index + 1);
  return std::string(3 - std::min<std::size_t>(digits.size(), 3), '0') + digits;
}

bool write_groups(cli::Run& run, const Grouped& grouped, const std::string& folder, const std::string& truth) {
  const auto timed = run.monitor().scope("write");
  Scene scene = grouped.scene;
  scene.objects.clear();
  for (std::size_t k = 0; k < grouped.objects.sure; ++k)
    scene.objects.push_back({object_name(k), std::uint32_t(k + 1)});
  scene.void_id = NumberedMasks::kUnknown;
  const std::vector<std::string> names = output_names(scene.views);
  const ObjectMaps maps(run.exec(), grouped.ply.cloud, grouped.splat, grouped.objects);
  const bool complete = for_each_view(&run.monitor(), grouped.views, [&](std::size_t n, std::size_t v) {
    const Camera& camera = scene.views[v].camera;
    const NumberedMasks masks = read_masks(grouped.scene, v);
    if (masks.number.empty() && !grouped.without_masks) return;
    std::string& path = scene.views[v].mask_path;
    path = mask_file(folder, names[v]);
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    io::write_png16(path, grouped.without_masks ? maps.known(run.exec(), camera)
                                                : maps.corrected(run.exec(), camera, grouped.of_view[n], masks));
  });
  if (!complete) return false;
  io::write_scene_json(folder + "/scene.json", scene, io::StoredPaths::kRelative, truth);
  const std::string text = objects_json(grouped).dump(1) + "\n";
  io::write_file(folder + "/objects.json", {text.data(), text.size()});
  return true;
}

}  // namespace ngs::group
