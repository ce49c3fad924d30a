#include "ngs/render/render_stage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "ngs/scene/mask_threshold.h"
#include "ngs/scene/view_names.h"

namespace ngs {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) parts.push_back(part);
  return parts;
}

/// The colour of object k; hues are well separated.
std::array<float, 3> hue(std::size_t k) {
  const double h = std::fmod(0.02 + 0.618033988749895 * double(k), 1.0) * 6;
  const auto channel = [h](double offset) {
    const double x = std::fmod(h + offset, 6.0);
    return float(std::clamp(std::abs(x - 3) - 1, 0.0, 1.0));
  };
  return {channel(0), channel(4), channel(2)};
}

}  // namespace

std::vector<std::size_t> select_views(const Scene& scene, const std::string& selection) {
  std::vector<std::size_t> views;
  if (selection == "all" || selection == "train" || selection == "held-out") {
    for (std::size_t i = 0; i < scene.views.size(); ++i)
      if (selection == "all" || (scene.views[i].split == Split::kTrain) == (selection == "train")) views.push_back(i);
    return views;
  }
  const ViewNames names(scene.views);
  for (const std::string& name : split(selection, ',')) {
    const std::vector<std::size_t> found = names.find(name);
    if (found.size() > 1)
      throw Error(ErrorCode::kUsage, "--views: several views are named '" + name + "'",
                  "give the whole name, such as '" + scene.views[found[0]].camera.name + "'");
    if (found.empty())
      throw Error(ErrorCode::kUsage, "--views: no view is named '" + name + "'",
                  "the scene has " + std::to_string(scene.views.size()) + " views, the first is '" +
                      (scene.views.empty() ? std::string() : scene.views.front().camera.name) + "'");
    views.push_back(found[0]);
  }
  return views;
}

namespace {

/// [N, K]
std::vector<float> label_matrix(const std::vector<LabelColumns>& objects, std::size_t n) {
  const std::size_t k_count = objects.size();
  std::vector<float> label(n * k_count);
  for (std::size_t k = 0; k < k_count; ++k)
    for (std::size_t i = 0; i < n; ++i) label[i * k_count + k] = objects[k].label[i];
  return label;
}

}  // namespace

LabelChannels::LabelChannels(const Exec& exec, const GaussianCloud& cloud, const std::vector<LabelColumns>& objects)
    : cloud_(cloud),
      objects_(objects.size()),
      label_(label_matrix(objects, std::size_t(cloud.size()))),
      object_(std::size_t(cloud.size()), 0),
      labelled_(object_),
      resident_(exec) {
  resident_.add_input(label_);
  // A pixel's label is a weighted mean of Gaussians' labels and 0, up to rounding: above 1/2 only if one of them is.
  constexpr float kRounding = 0.01f;
  for (const LabelColumns& object : objects)
    for (std::size_t i = 0; i < object_.size(); ++i) {
      const float label = object.label[i];
      object_[i] |= label > kHalfShare - kRounding;
      labelled_[i] |= label != 0;
    }
}

ImageF LabelChannels::masks(const Exec& exec, const Camera& camera, const SplatOptions& splat) const {
  return view(exec, camera, splat, object_.data());
}

ImageF LabelChannels::view(const Exec& exec, const Camera& camera, const SplatOptions& splat,
                           const std::uint8_t* tiles_touching) const {
  RenderRequest request{.colour = false, .label = {label_.data(), cloud_.size(), int(objects_)}};
  request.tiles_touching = tiles_touching != nullptr ? tiles_touching : labelled_.data();
  request.stop_after = labelled_.data();
  return std::move(render(exec, cloud_, camera, splat, request).label);
}

RenderedView render_labelled(const Exec& exec, const LabelledModel& model, const Camera& camera,
                             const LabelledRequest& request) {
  const auto& [cloud, objects] = model;
  std::vector<float> label;
  RenderRequest wanted;
  wanted.colour = request.colour;
  wanted.depth = request.depth;
  wanted.background = request.background;
  if (!objects.empty() && request.labels) {
    label = label_matrix(objects, std::size_t(cloud.size()));
    wanted.label = {label.data(), cloud.size(), int(objects.size())};
  }
  RenderedView view = render(exec, cloud, camera, request.splat, wanted);
  if (request.amodal && request.labels) show_objects_alone(exec, model, camera, request.splat, view);
  return view;
}

ObjectsAlone::ObjectsAlone(const Exec& exec, const GaussianCloud& cloud, const std::vector<LabelColumns>& objects)
    : cloud_(cloud), resident_(exec) {
  for (const LabelColumns& object : objects) {
    std::vector<std::uint8_t>& member = member_.emplace_back(object.label.size());
    for (std::size_t i = 0; i < member.size(); ++i) member[i] = label_is_foreground(object.label[i]);
    resident_.add_input(member);
  }
}

ImageF ObjectsAlone::view(const Exec& exec, std::size_t k, const Camera& camera, const SplatOptions& splat) const {
  RenderRequest alone{.colour = false, .label = {}, .include = member_[k].data()};
  return std::move(render(exec, cloud_, camera, splat, alone).alpha);
}

void show_objects_alone(const Exec& exec, const LabelledModel& model, const Camera& camera, const SplatOptions& splat,
                        RenderedView& view) {
  const ObjectsAlone objects(exec, model.cloud, model.labels);
  const std::size_t k_count = model.labels.size();
  for (std::size_t k = 0; k < k_count; ++k) {
    const ImageF alpha = objects.view(exec, k, camera, splat);
    for (std::size_t p = 0; p < alpha.data.size(); ++p) view.label.data[p * k_count + k] = alpha.data[p];
  }
}

ImageU16 label_map(const RenderedView& view, double threshold, const std::vector<std::uint16_t>& ids) {
  ImageU16 map(view.width_px, view.height_px, 1);
  const auto objects = std::size_t(view.label.channels);
  for (std::size_t p = 0; p < map.data.size(); ++p) {
    float best = float(threshold);
    for (std::size_t k = 0; k < objects; ++k)
      if (view.label.data[p * objects + k] > best) {
        best = view.label.data[p * objects + k];
        map.data[p] = ids.empty() ? std::uint16_t(k + 1) : ids[k];
      }
  }
  return map;
}

ImageU8 overlay_picture(const RenderedView& view, double threshold) {
  const ImageU16 map = label_map(view, threshold);
  ImageU8 picture(view.width_px, view.height_px, 3);
  for (int y = 0; y < view.height_px; ++y)
    for (int x = 0; x < view.width_px; ++x) {
      const std::uint16_t id = map.at(x, y);
      const bool edge = (x > 0 && map.at(x - 1, y) != id) || (y > 0 && map.at(x, y - 1) != id);
      const std::uint16_t owner =
          id != 0 ? id
                  : (edge ? (x > 0 && map.at(x - 1, y) != 0 ? map.at(x - 1, y) : map.at(x, std::max(0, y - 1))) : 0);
      const float mix = edge ? 1.f : (id != 0 ? 0.3f : 0.f);
      const std::array<float, 3> tint = owner != 0 ? hue(std::size_t(owner - 1)) : std::array<float, 3>{0, 0, 0};
      for (int c = 0; c < 3; ++c) {
        const float value = (1 - mix) * view.colour.at(x, y, c) + mix * tint[std::size_t(c)];
        picture.at(x, y, c) = std::uint8_t(std::lround(255 * std::clamp(value, 0.f, 1.f)));
      }
    }
  return picture;
}

}  // namespace ngs
