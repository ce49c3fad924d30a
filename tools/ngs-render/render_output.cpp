#include "render_output.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <sstream>

#include "ngs/io/image/exr.h"
#include "ngs/io/image/image_file.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/scene/view_names.h"

namespace ngs::picture {
namespace {

constexpr const char* kLayers[] = {"color", "mask", "alpha", "depth", "labels", "overlay"};

/// Expected depth of the covered pixels, scaled so that 65535 is the largest depth of the view.
ImageU16 depth_to_16bit(const RenderedView& view) {
  ImageU16 out(view.width_px, view.height_px, 1);
  float largest = 0;
  std::vector<float> depth(out.data.size(), 0.f);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (view.alpha.data[i] > 0.f) depth[i] = view.depth.data[i] / view.alpha.data[i];
    largest = std::max(largest, depth[i]);
  }
  for (std::size_t i = 0; i < depth.size(); ++i)
    out.data[i] = largest > 0 ? std::uint16_t(std::lround(65535 * depth[i] / largest)) : std::uint16_t(0);
  return out;
}

ImageU8 binary_mask(const ImageF& label, std::size_t object, double threshold) {
  ImageU8 out(label.width_px, label.height_px, 1);
  for (std::size_t p = 0; p < out.data.size(); ++p)
    out.data[p] = label.data[p * std::size_t(label.channels) + object] > threshold ? 255 : 0;
  return out;
}

std::string prepared(const std::filesystem::path& folder, const std::string& file) {
  const std::filesystem::path path = folder / file;
  std::filesystem::create_directories(path.parent_path());
  return path.generic_string();
}

std::filesystem::path layer_folder(const Destination& to, const std::set<std::string>& layers,
                                   const std::string& layer) {
  return layers.size() > 1 ? std::filesystem::path(to.folder) / layer : std::filesystem::path(to.folder);
}

std::filesystem::path mask_folder(const std::filesystem::path& folder, const Objects& objects, std::size_t object) {
  return objects.names.size() > 1 ? folder / objects.names[object] : folder;
}

void write_masks(const std::filesystem::path& folder, const std::string& stem, const RenderedView& view,
                 const Objects& objects, double threshold) {
  for (std::size_t k = 0; k < objects.names.size(); ++k)
    io::write_png(prepared(mask_folder(folder, objects, k), stem + ".png"), binary_mask(view.label, k, threshold));
}

void write_exr_view(const Destination& to, const RenderedView& view, const Wanted& wanted) {
  const Objects& objects = wanted.objects;
  const std::set<std::string>& layers = wanted.layers;
  io::ExrImage image;
  image.width_px = view.width_px;
  image.height_px = view.height_px;
  const auto plane = [&](std::size_t object) {
    std::vector<float> out(view.label.data.size() / objects.names.size());
    for (std::size_t p = 0; p < out.size(); ++p) out[p] = view.label.data[p * objects.names.size() + object];
    return out;
  };
  if (layers.contains("color")) image.add({"R", "G", "B"}, view.colour);
  if (layers.contains("alpha")) image.add({"A"}, view.alpha);
  if (layers.contains("depth")) {
    ImageF depth = view.depth;
    for (std::size_t p = 0; p < depth.data.size(); ++p)
      depth.data[p] = view.alpha.data[p] > 0 ? depth.data[p] / view.alpha.data[p] : 0.f;
    image.add({"Z"}, depth);
  }
  if (layers.contains("mask"))
    for (std::size_t k = 0; k < objects.names.size(); ++k)
      image.channels[objects.names.size() == 1 ? "ngs.mask" : "ngs.mask_" + objects.names[k]] = plane(k);
  if (layers.contains("labels")) {
    const ImageU16 map = label_map(view, wanted.threshold, objects.ids);
    image.channels["ngs.id"].assign(map.data.begin(), map.data.end());
  }
  image.text["ngs:schema"] = "ngs.render.1";
  io::write_exr(prepared(to.folder, to.stem + ".exr"), image);
}

}  // namespace

Objects objects_of(const io::GaussianPly& ply, const Scene& scene) {
  Objects objects;
  for (const io::NamedLabels& o : ply.objects) {
    objects.names.push_back(o.object);
    objects.columns.push_back(o.columns);
  }
  objects.gaussians = ply.cloud.size();
  if (objects.names.empty() && !ply.labels.label.empty()) {
    objects.names = {ply.object};
    objects.columns = {ply.labels};
  }
  for (const std::string& name : objects.names)
    for (const SceneObject& object : scene.objects)
      if (object.name == name && object.id > 0) objects.ids.push_back(std::uint16_t(object.id));
  if (objects.ids.size() == objects.names.size()) return objects;
  objects.ids.resize(objects.names.size());
  std::iota(objects.ids.begin(), objects.ids.end(), std::uint16_t(1));
  return objects;
}

std::set<std::string> parse_layers(const std::vector<std::string>& layers, const Objects& objects, Format format) {
  std::set<std::string> chosen;
  for (const std::string& entry : layers) {
    std::istringstream in(entry);
    for (std::string layer; std::getline(in, layer, ',');) {
      if (std::find(std::begin(kLayers), std::end(kLayers), layer) == std::end(kLayers))
        throw Error(ErrorCode::kUsage,
                    "--layers: '" + layer + "', expected color, mask, alpha, depth, labels or overlay");
      chosen.insert(layer);
    }
  }
  if (chosen.empty()) chosen.insert("mask");
  if (format == Format::kExr && chosen.contains("overlay"))
    throw Error(ErrorCode::kUsage, "--layers: 'overlay' cannot be stored in an EXR, expected --format png",
                "leave overlay out");
  const bool needs_labels = chosen.contains("mask") || chosen.contains("labels") || chosen.contains("overlay");
  if (needs_labels && objects.gaussians == 0)
    throw Error(ErrorCode::kNothingFound, "the model has no Gaussians, expected some for masks", "use --layers color");
  if (needs_labels && objects.names.empty())
    throw Error(ErrorCode::kBadInput, "the model has no property ngs_label, expected a labelled PLY for masks",
                "label the model first: ngs-variance scene.json -o boundary.ply, or use --layers color");
  return chosen;
}

std::vector<std::string> file_names(const Scene& scene, FileNames names) {
  std::vector<std::string> of_views = output_names(scene.views);
  for (std::size_t v = 0; v < of_views.size() && names == FileNames::kImage; ++v)
    of_views[v] = scene.views[v].camera.name;
  return of_views;
}

std::vector<std::string> files_of(const Destination& to, const Objects& objects, const std::set<std::string>& layers,
                                  Format format) {
  if (format == Format::kExr) return {(std::filesystem::path(to.folder) / (to.stem + ".exr")).generic_string()};
  std::vector<std::string> files;
  for (const std::string& layer : layers) {
    const std::filesystem::path folder = layer_folder(to, layers, layer);
    for (std::size_t k = 0; k < (layer == "mask" ? objects.names.size() : 1); ++k)
      files.push_back(
          ((layer == "mask" ? mask_folder(folder, objects, k) : folder) / (to.stem + ".png")).generic_string());
  }
  return files;
}

void write_view(const Destination& to, const RenderedView& view, const Wanted& wanted) {
  if (wanted.format == Format::kExr) return write_exr_view(to, view, wanted);
  for (const std::string& layer : wanted.layers) {
    const std::filesystem::path folder = layer_folder(to, wanted.layers, layer);
    const std::string file = to.stem + ".png";
    if (layer == "mask")
      write_masks(folder, to.stem, view, wanted.objects, wanted.threshold);
    else if (layer == "color")
      io::write_png(prepared(folder, file), to_bytes(view.colour));
    else if (layer == "alpha")
      io::write_png(prepared(folder, file), to_bytes(view.alpha));
    else if (layer == "depth")
      io::write_png16(prepared(folder, file), depth_to_16bit(view));
    else if (layer == "labels")
      io::write_png16(prepared(folder, file), label_map(view, wanted.threshold, wanted.objects.ids));
    else if (layer == "overlay")
      io::write_png(prepared(folder, file), overlay_picture(view, wanted.threshold));
  }
}

}  // namespace ngs::picture
