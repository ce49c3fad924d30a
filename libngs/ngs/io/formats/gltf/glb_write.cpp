#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include "ngs/core/error.h"
#include "ngs/core/version.h"
#include "ngs/io/formats/axes.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/math/stable.h"

namespace ngs::io {
namespace {

using nlohmann::ordered_json;

constexpr const char* kExtension = "KHR_gaussian_splatting";
constexpr int kFloat = 5126, kArrayBuffer = 34962, kPoints = 0;  // glTF constants
constexpr std::uint32_t kMagic = 0x46546c67, kVersion2 = 2, kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;

struct Attribute {
  std::string name;
  std::size_t width;  // floats per row
  std::function<void(const SplatRow&, float*)> fill;
};

std::vector<Attribute> attributes_of(int sh_degree) {
  const std::string prefix = std::string(kExtension) + ":";
  const auto copy_of = [](const auto& from, float* to) { std::copy(from.begin(), from.end(), to); };
  std::vector<Attribute> list = {
      {"POSITION", 3, [=](const SplatRow& row, float* to) { copy_of(row.position, to); }},
      {prefix + "ROTATION", 4,
       [](const SplatRow& row, float* to) {
         for (std::size_t k = 0; k < 4; ++k) to[k] = row.rotation[(k + 1) % 4];
       }},
      {prefix + "SCALE", 3,
       [](const SplatRow& row, float* to) {
         for (std::size_t a = 0; a < 3; ++a) to[a] = exp_of(row.log_scale[a]);
       }},
      {prefix + "OPACITY", 1, [](const SplatRow& row, float* to) { *to = sigmoid(row.logit_opacity); }},
      {prefix + "SH_DEGREE_0_COEF_0", 3, [=](const SplatRow& row, float* to) { copy_of(row.sh_dc, to); }}};
  std::size_t k = 0;
  for (int degree = 1; degree <= sh_degree; ++degree)
    for (int n = 0; n <= 2 * degree; ++n, ++k)
      list.push_back({prefix + "SH_DEGREE_" + std::to_string(degree) + "_COEF_" + std::to_string(n), 3,
                      [k](const SplatRow& row, float* to) { std::copy_n(&row.sh_rest[k * 3], 3, to); }});
  return list;
}

class GlbEncoder {
 public:
  explicit GlbEncoder(const SplatSelection& model) : model_(model), attributes_(attributes_of(model.cloud.sh_degree)) {
    std::size_t floats = 0;
    for (const Attribute& a : attributes_) floats += a.width;
    binary_bytes_ = floats * model.rows.size() * sizeof(float);
    if (binary_bytes_ > 0xf0000000u)
      throw Error(ErrorCode::kUsage, std::to_string(binary_bytes_) + " bytes, a .glb holds less than 4 GiB",
                  "write the model as PLY");
  }

  std::vector<std::uint8_t> encode() {
    std::string text = description().dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const bool is_empty = model_.rows.empty();
    const std::size_t total = 12 + 8 + text.size() + (is_empty ? 0 : 8 + binary_bytes_);
    for (const std::uint32_t word : {kMagic, kVersion2, std::uint32_t(total), std::uint32_t(text.size()), kJsonChunk})
      append(&word, sizeof word);
    append(text.data(), text.size());
    if (is_empty) return std::move(bytes_);
    for (const std::uint32_t word : {std::uint32_t(binary_bytes_), kBinaryChunk}) append(&word, sizeof word);
    bytes_.reserve(total);
    for (const Attribute& attribute : attributes_) {
      float values[4];
      for (const std::int64_t i : model_.rows) {
        attribute.fill(turned_row(i), values);
        append(values, attribute.width * sizeof(float));
      }
    }
    return std::move(bytes_);
  }

 private:
  SplatRow turned_row(std::int64_t i) const {
    SplatRow row = load_row(model_, i);
    reverse_axes(row, kLeftUpForward);
    return row;
  }

  void append(const void* from, std::size_t size) {
    const auto* first = static_cast<const std::uint8_t*>(from);
    bytes_.insert(bytes_.end(), first, first + size);
  }

  ordered_json description() const {
    ordered_json gltf = {{"asset", {{"version", "2.0"}, {"generator", std::string("ngs ") + kVersion}}}};
    gltf["extensionsUsed"] = ordered_json::array({kExtension});
    gltf["scene"] = 0;
    if (model_.rows.empty()) return gltf["scenes"] = ordered_json::array({ordered_json::object()}), gltf;
    ordered_json attributes;
    std::size_t offset = 0;
    for (std::size_t k = 0; k < attributes_.size(); ++k) {
      const std::size_t bytes = attributes_[k].width * model_.rows.size() * sizeof(float);
      const char* types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
      gltf["bufferViews"].push_back(
          {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}, {"target", kArrayBuffer}});
      gltf["accessors"].push_back({{"bufferView", k},
                                   {"componentType", kFloat},
                                   {"count", model_.rows.size()},
                                   {"type", types[attributes_[k].width]}});
      attributes[attributes_[k].name] = k;
      offset += bytes;
    }
    add_bounds(gltf["accessors"][0]);
    gltf["buffers"].push_back(ordered_json{{"byteLength", binary_bytes_}});
    const ordered_json splats = {{"kernel", "ellipse"},
                                 {"colorSpace", "srgb_rec709_display"},
                                 {"sortingMethod", "cameraDistance"},
                                 {"projection", "perspective"}};
    ordered_json primitive = {{"attributes", attributes}, {"mode", kPoints}};
    primitive["extensions"][kExtension] = splats;
    ordered_json mesh, scene;
    mesh["primitives"].push_back(primitive);
    scene["nodes"].push_back(0);
    gltf["meshes"].push_back(mesh);
    gltf["nodes"].push_back(ordered_json{{"mesh", 0}});
    gltf["scenes"].push_back(scene);
    return gltf;
  }

  /// glTF requires the bounding box of the positions.
  void add_bounds(ordered_json& accessor) const {
    std::array<float, 3> low = turned_row(model_.rows[0]).position, high = low;
    for (const std::int64_t i : model_.rows) {
      const std::array<float, 3> p = turned_row(i).position;
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], p[a]);
        high[a] = std::max(high[a], p[a]);
      }
    }
    accessor["min"] = low;
    accessor["max"] = high;
  }

  const SplatSelection& model_;
  std::vector<Attribute> attributes_;
  std::size_t binary_bytes_ = 0;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace

std::vector<std::uint8_t> encode_glb(const SplatSelection& model) { return GlbEncoder(model).encode(); }

}  // namespace ngs::io
