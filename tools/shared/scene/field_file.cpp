#include "shared/scene/field_file.h"

#include <charconv>
#include <cmath>

#include "ngs/core/parse_number.h"
#include "ngs/io/files/safetensors.h"

namespace ngs::cli {
namespace {

constexpr const char* kSchema = "ngs.nerf.1";
constexpr const char* kSmoothstep = "hash_smoothstep";  // a file without it: the cells blend linearly
constexpr const char* kRemedy = "write it again: ngs-joint --nerf";

/// The shortest text that is this number: a fixed point would lose a small world's width.
template <class T>
std::string text_of(T value) {
  char text[32];
  return std::string(text, std::to_chars(text, std::end(text), value).ptr);
}

/// Numbers of the shape, by the name they have in the file; the same list for both ways.
template <class Shape, class Sample, class Visit>
void visit_numbers(Shape& s, Sample& sample, const Visit& visit) {
  visit("hash_levels", s.hash.levels, 1, kMaxHashLevels), visit("hash_features", s.hash.features, 1, 8);
  visit("hash_log2_table", s.hash.log2_table, 3, 24), visit("hash_base", s.hash.base_resolution, 2, kMaxHashResolution);
  visit("hash_finest", s.hash.max_resolution, 2, kMaxHashResolution);
  visit("hidden", s.hidden, 16, 128), visit("layers", s.layers, 1, kMaxFilmLayers);
  visit("direction_degree", s.direction_degree, 0, 3), visit("features", s.features, 3, kMaxFeatureValues);
  visit("objects", s.objects, 0, 65535), visit("neighbours", s.neighbours, 1, kMaxNeighbours);
  visit("film", s.film, 0, 1), visit("concatenate", s.concatenate, 0, 1);
  visit("depth_samples", sample.depth_samples, 1, 256);
  visit("width", s.width, 0, HUGE_VAL);
  visit("depth_span", sample.depth_span, 0, 1), visit("depth_epsilon", sample.depth_epsilon, 0, 1e6);
  visit("bbox_pad_px", sample.bbox_pad_px, 0, 1e4);
}

[[noreturn]] void bad(const std::string& what) { throw Error(ErrorCode::kBadInput, what, kRemedy); }

double number_in(const io::TensorFile& file, const std::string& key, double low, double high) {
  const std::string& text = file.meta(key);
  double value = 0;
  if (!parse_number(text, value) || !std::isfinite(value) || value < low || value > high)
    bad(file.name + ": " + key + " is '" + text + "', expected a number from " + text_of(low) + " to " + text_of(high));
  return value;
}

std::vector<float> finite(const io::TensorFile& file, const std::string& name, const std::vector<std::int64_t>& shape) {
  std::vector<float> values = file.get<float>(name, shape);
  for (const float value : values)
    if (!std::isfinite(value)) bad(file.name + ": '" + name + "' has a value that is not finite");
  return values;
}

}  // namespace

void write_field(const std::string& path, const JointField* field, const BoundarySet& boundary,
                 const SampleOptions& sample) {
  io::TensorFile file;
  file.metadata["ngs:schema"] = kSchema;
  if (field != nullptr) {
    const ParamStore& store = field->parameters();
    for (const ParamBlock& block : store.blocks) file.add(block.name, block.shape, store.value_of(block));
    file.add("boundary_row", {boundary.size()}, boundary.row);
    file.add("boundary_position", {boundary.size(), 3}, boundary.position);
    file.add("origin", {3}, std::vector<double>(boundary.origin.begin(), boundary.origin.end()));
    const HashBox<float>& box = field->shape().box;
    file.add("hash.box", {2, 3},
             std::vector<float>{box.centre.x, box.centre.y, box.centre.z, box.inv_extent.x, box.inv_extent.y,
                                box.inv_extent.z});
    visit_numbers(field->shape(), sample, [&](const char* key, auto value, double, double) {
      if constexpr (std::is_same_v<decltype(value), bool>)
        file.metadata[key] = value ? "1" : "0";
      else
        file.metadata[key] = text_of(value);
    });
    if (field->shape().hash.smoothstep) file.metadata[kSmoothstep] = "1";
    file.metadata["window"] = sample.window == WindowCentre::kPixel ? "pixel" : "mean";
  }
  io::write_safetensors(path, file);
}

FieldModel read_field(const std::string& path) {
  const io::TensorFile file = io::read_safetensors(path);
  if (file.meta("ngs:schema") != kSchema) bad(path + ": is " + file.meta("ngs:schema") + ", expected " + kSchema);
  if (!file.has("feature"))
    throw Error(ErrorCode::kNothingFound, path + ": holds no field, the run's boundary set was empty",
                "lower --tau of ngs-variance");
  FieldShape shape;
  SampleOptions sample;
  visit_numbers(shape, sample, [&](const char* key, auto& value, double low, double high) {
    value = std::remove_reference_t<decltype(value)>(number_in(file, key, low, high));
  });
  shape.hash.smoothstep = file.metadata.contains(kSmoothstep) && number_in(file, kSmoothstep, 0, 1) == 1;
  if (!are_hash_features(shape.hash.features) || shape.hash.max_resolution < shape.hash.base_resolution ||
      !(shape.width > 0))
    bad(path + ": hash_features, hash_finest or width are none that a run writes");
  sample.window = file.meta("window") == "mean" ? WindowCentre::kMean : WindowCentre::kPixel;
  const std::vector<float> box = finite(file, "hash.box", {2, 3});
  shape.box = {{box[0], box[1], box[2]}, {box[3], box[4], box[5]}};
  BoundarySet boundary;
  boundary.row = file.get<std::uint32_t>("boundary_row", {-1});
  shape.boundary = boundary.size();
  boundary.position = finite(file, "boundary_position", {shape.boundary, 3});
  const std::vector<double> origin = file.get<double>("origin", {3});
  std::copy(origin.begin(), origin.end(), boundary.origin.begin());
  JointField field(shape, FieldOptions{}, 0);
  ParamStore& store = field.parameters();
  for (const ParamBlock& block : store.blocks) {
    const std::vector<float> values = finite(file, block.name, block.shape);
    std::copy(values.begin(), values.end(), store.value_of(block).begin());
  }
  return {std::move(field), std::move(boundary), sample};
}

}  // namespace ngs::cli
