#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "ngs/io/capture/pose.h"
#include "ngs/io/files/byte_reader.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/formats/splat_table.h"
#include "ngs/math/elementary.h"
#include "ngs/math/quat.h"
#include "ngs/math/stable.h"

namespace ngs::io {
namespace {

using nlohmann::json;

constexpr const char* kSplatExtension = "KHR_gaussian_splatting";
constexpr const char* kExportPlain = "export the splat uncompressed, or as PLY, with the program that wrote it";
// What float rounds to 0 or 1 has no finite logarithm or logit.
constexpr float kLeastLength = std::numeric_limits<float>::min();
constexpr double kLeastOpacity = 0x1p-25;
constexpr std::size_t kMostPrimitives = 65536;
constexpr std::int64_t kMostIndex = std::numeric_limits<std::int32_t>::max();

struct GlbColumn {
  const std::uint8_t* first = nullptr;
  std::size_t stride = 0, count = 0;
  std::int64_t type = 0;  // glTF's number of the component type

  float value(std::size_t row, std::size_t component) const {
    const std::uint8_t* at = first + row * stride;
    const auto load = [&]<class T>(T number) {
      std::memcpy(&number, at + component * sizeof number, sizeof number);
      return number;
    };
    switch (type) {
      case 5120: return std::max(float(load(std::int8_t())) / 127, -1.f);
      case 5121: return float(load(std::uint8_t())) / 255;
      case 5122: return std::max(float(load(std::int16_t())) / 32767, -1.f);
      case 5123: return float(load(std::uint16_t())) / 65535;
      default: return load(float());
    }
  }
};

/// x' = scale · rotation x + translation.
struct Placement {
  Mat3<double> rotation{{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  double scale = 1;
  Vec3<double> translation{0, 0, 0};
};

struct GlbPrimitive {
  const json* object;
  Placement placement;
  std::string where;
};

class GlbReader {
 public:
  GlbReader(const std::string& name, Bytes bytes) : name_(name) {
    ByteReader reader(bytes, name);
    constexpr std::uint32_t kJson = 0x4e4f534a, kBinary = 0x004e4942;
    reader.skip(4);
    if (const auto version = reader.read<std::uint32_t>(); version != 2)
      bad("glTF version " + std::to_string(version) + ", expected 2");
    reader.skip(4);
    while (reader.left() >= 8) {
      const auto size = reader.read<std::uint32_t>(), kind = reader.read<std::uint32_t>();
      const Bytes chunk = bytes.subspan(bytes.size() - reader.left());
      reader.skip(size);
      if (kind == kJson && root_.is_null())
        root_ = parse_json({reinterpret_cast<const char*>(chunk.data()), size}, name);
      else if (kind == kBinary)
        binary_ = chunk.first(size);
    }
    if (!root_.is_object()) bad("no JSON chunk, expected a binary glTF");
  }

  DecodedSplat decode() {
    collect();
    if (primitives_.empty())
      bad("no Gaussian splats (" + std::string(kSplatExtension) + "), expected some",
          "it may hold a mesh: give the splat of the scene");
    std::size_t rows = 0;
    int degree = 0;
    for (const GlbPrimitive& primitive : primitives_) {
      rows += column(primitive, "POSITION", 3)->count;
      degree = std::max(degree, degree_of(primitive));
    }
    if (rows > binary_.size()) bad(std::to_string(rows) + " Gaussians, expected at most one per byte");
    decoded_.rows = splat_table(std::int64_t(rows), degree);
    std::int64_t at = 0;
    for (const GlbPrimitive& primitive : primitives_) add_rows(primitive, at);
    return std::move(decoded_);
  }

 private:
  [[noreturn]] void bad(const std::string& what, const std::string& remedy = {}) const {
    throw Error(ErrorCode::kBadInput, name_ + ": " + what, remedy);
  }

  JsonReader element(const char* list, std::int64_t index) const {
    const std::string where = name_ + ": " + list + "[" + std::to_string(index) + "]";
    const json& all = JsonReader(root_, name_).array(list);
    if (index < 0 || std::size_t(index) >= all.size())
      throw Error(ErrorCode::kBadInput, where + ": missing, expected one of " + std::to_string(all.size()));
    return {all[std::size_t(index)], where};
  }

  std::vector<std::int64_t> indices(const JsonReader& of, const std::string& key) const {
    std::vector<std::int64_t> found;
    for (const json& index : of.array(key)) {
      if (!index.is_number_integer()) of.fail(key, "whole numbers");
      found.push_back(index.get<std::int64_t>());
    }
    return found;
  }

  void collect() {
    const JsonReader root(root_, name_);
    if (!root.has("scenes")) {
      if (root.has("meshes"))
        for (std::size_t m = 0; m < root.array("meshes").size(); ++m) add_mesh(std::int64_t(m), {});
      return;
    }
    const std::int64_t scene = root.has("scene") ? root.integer("scene", 0, kMostIndex) : 0;
    const JsonReader chosen = element("scenes", scene);
    if (!chosen.has("nodes")) return;
    visited_.resize(root.has("nodes") ? root.array("nodes").size() : 0);
    for (const std::int64_t node : indices(chosen, "nodes")) add_node(node, {}, 0);
  }

  void add_node(std::int64_t index, const Placement& parent, int depth) {
    constexpr int kMaxDepth = 64;
    const JsonReader node = element("nodes", index);
    if (depth > kMaxDepth || visited_[std::size_t(index)])
      bad("nodes[" + std::to_string(index) + "]: reached twice or more than 64 levels deep, expected a tree");
    visited_[std::size_t(index)] = true;
    const Placement own = placement_of(node);
    const Placement placement{parent.rotation * own.rotation, parent.scale * own.scale,
                              parent.scale * (parent.rotation * own.translation) + parent.translation};
    if (node.has("mesh")) add_mesh(node.integer("mesh", 0, kMostIndex), placement);
    if (node.has("children"))
      for (const std::int64_t child : indices(node, "children")) add_node(child, placement, depth + 1);
  }

  static Placement placement_of(const JsonReader& node) {
    const auto numbers = [&](const std::string& key, std::vector<double> otherwise) {
      return node.has(key) ? node.matrix(key, otherwise.size(), 0) : otherwise;
    };
    Placement placement;
    Mat3<double> linear;
    if (node.has("matrix")) {
      const std::vector<double> m = node.matrix("matrix", 16, 0);  // column by column
      linear = {{m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]}};
      placement.translation = {m[12], m[13], m[14]};
    } else {
      const std::vector<double> q = numbers("rotation", {0, 0, 0, 1}), s = numbers("scale", {1, 1, 1});
      double unused = 0;
      linear = rotation_matrix(normalised(Vec4<double>{q[3], q[0], q[1], q[2]}, unused));
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) linear(r, c) *= s[std::size_t(c)];
      placement.translation = vec3(numbers("translation", {0, 0, 0}).data());
    }
    double volume = dot(vec3(linear.m), cross(vec3(linear.m + 3), vec3(linear.m + 6)));
    placement.scale = std::cbrt(volume);
    if (!(placement.scale > 1e-15) || !std::isfinite(placement.scale))
      node.fail("scale", "an even scale above 0, without a reflection");
    for (double& value : linear.m) value /= placement.scale;
    placement.rotation = checked_rotation(linear, node.where());
    return placement;
  }

  void add_mesh(std::int64_t index, const Placement& placement) {
    const JsonReader mesh = element("meshes", index);
    for (const json& object : mesh.array("primitives")) {
      const JsonReader primitive(object, mesh.where() + ".primitives");
      if (!primitive.has("extensions")) continue;
      const JsonReader extensions = primitive.object("extensions");
      if (!extensions.has(kSplatExtension)) continue;
      const JsonReader splats = extensions.object(kSplatExtension);
      if (splats.has("extensions"))
        for (const auto& [extension, unused] : splats.at("extensions").items())
          if (extension.find("compression") != extension.npos)
            bad("compressed splats, expected plain ones", kExportPlain);
      if (splats.text_or("colorSpace", "srgb_rec709_display") != "srgb_rec709_display")
        decoded_.notes.push_back("colours are linear (colorSpace): read as display colours, which are darker");
      primitives_.push_back({&object, placement, primitive.where()});
      if (primitives_.size() > kMostPrimitives) bad("more than 65536 splats, expected few");
    }
  }

  std::optional<GlbColumn> column(const GlbPrimitive& primitive, const std::string& name, std::size_t width) const {
    const JsonReader attributes = JsonReader(*primitive.object, primitive.where).object("attributes");
    if (!attributes.has(name)) return std::nullopt;
    const JsonReader accessor = element("accessors", attributes.integer(name, 0, kMostIndex));
    if (accessor.has("sparse") || !accessor.has("bufferView"))
      bad("a sparse accessor, expected plain ones", kExportPlain);
    const JsonReader view = element("bufferViews", accessor.integer("bufferView", 0, kMostIndex));
    if (view.has("extensions")) bad("a compressed buffer, expected plain ones", kExportPlain);
    if (view.integer("buffer", 0, kMostIndex) != 0) bad("several buffers, expected that of the file", kExportPlain);
    GlbColumn found;
    found.type = accessor.integer("componentType", 5120, 5126);
    const std::string type = width == 1 ? "SCALAR" : "VEC" + std::to_string(width);
    if (accessor.text("type") != type) accessor.fail("type", type);
    const bool is_float = found.type == 5126;
    if (found.type > 5123 && !is_float) accessor.fail("componentType", "a float, or a normalised byte or short");
    if (!is_float && !(accessor.has("normalized") && accessor.boolean("normalized")))
      accessor.fail("normalized", "true for whole numbers");
    const std::size_t bytes = width * (is_float ? 4 : found.type < 5122 ? 1 : 2);
    found.count = std::size_t(accessor.integer("count", 0, kMostIndex));
    found.stride = view.has("byteStride") ? std::size_t(view.integer("byteStride", 1, 252)) : bytes;
    const auto offset_in = [](const JsonReader& of) {
      return of.has("byteOffset") ? std::size_t(of.integer("byteOffset", 0, std::int64_t(1) << 32)) : 0;
    };
    const std::size_t begin = offset_in(view) + offset_in(accessor);
    const std::size_t length = found.count == 0 ? 0 : (found.count - 1) * found.stride + bytes;
    if (begin > binary_.size() || length > binary_.size() - begin)
      bad("attribute " + name + " ends after the file, expected a complete file", "copy or export it again");
    found.first = binary_.data() + begin;
    return found;
  }

  std::optional<GlbColumn> coefficient(const GlbPrimitive& primitive, int degree, int n) const {
    return column(primitive,
                  std::string(kSplatExtension) + ":SH_DEGREE_" + std::to_string(degree) + "_COEF_" + std::to_string(n),
                  3);
  }

  int degree_of(const GlbPrimitive& primitive) const {
    int degree = 0;
    while (degree < 3 && coefficient(primitive, degree + 1, 0)) ++degree;
    return degree;
  }

  GlbColumn required(const std::optional<GlbColumn>& found, const GlbPrimitive& primitive,
                     const std::string& what) const {
    if (found && found->count == column(primitive, "POSITION", 3)->count) return *found;
    bad("attribute " + what + (found ? " has another count" : " is missing") + ", expected one value per position");
  }

  void add_rows(const GlbPrimitive& primitive, std::int64_t& at) {
    const GlbColumn position = *column(primitive, "POSITION", 3);
    const auto own = [&](const std::string& what, std::size_t width) {
      return required(column(primitive, std::string(kSplatExtension) + ":" + what, width), primitive, what);
    };
    const GlbColumn rotation = own("ROTATION", 4), scale = own("SCALE", 3), opacity = own("OPACITY", 1);
    std::vector<GlbColumn> sh;
    for (int degree = 0; degree <= degree_of(primitive); ++degree)
      for (int n = 0; n <= 2 * degree; ++n)
        sh.push_back(required(coefficient(primitive, degree, n), primitive, "SH_DEGREE_" + std::to_string(degree)));
    const Placement& placement = primitive.placement;
    const RowRotation turn(placement.rotation);
    const bool is_turned = placement.rotation(0, 0) + placement.rotation(1, 1) + placement.rotation(2, 2) < 3;
    for (std::size_t i = 0; i < position.count; ++i) {
      SplatRow row;
      for (std::size_t a = 0; a < 3; ++a) {
        row.position[a] = float(placement.scale) * position.value(i, a);
        const float length = float(placement.scale) * scale.value(i, a);
        row.log_scale[a] = log_of(length >= 0 && length < kLeastLength ? kLeastLength : length);
        row.sh_dc[a] = sh[0].value(i, a);
        for (std::size_t k = 1; k < sh.size(); ++k) row.sh_rest[(k - 1) * 3 + a] = sh[k].value(i, a);
      }
      for (std::size_t k = 0; k < 4; ++k) row.rotation[k] = rotation.value(i, (k + 3) % 4);
      row.logit_opacity = float(logit(std::clamp(double(opacity.value(i, 0)), kLeastOpacity, 1 - kLeastOpacity)));
      if (is_turned) turn.apply(row);
      row.position[0] += float(placement.translation.x);
      row.position[1] += float(placement.translation.y);
      row.position[2] += float(placement.translation.z);
      reverse_axes(row, kLeftUpForward);
      store_row(decoded_.rows, at++, row);
    }
  }

  std::string name_;
  json root_;
  Bytes binary_;
  std::vector<bool> visited_;  // [nodes]
  std::vector<GlbPrimitive> primitives_;
  DecodedSplat decoded_;
};

}  // namespace

DecodedSplat decode_glb(const std::string& name, Bytes bytes) { return GlbReader(name, bytes).decode(); }

}  // namespace ngs::io
