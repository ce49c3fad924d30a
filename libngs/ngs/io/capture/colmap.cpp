#include "ngs/io/capture/colmap.h"

#include <Eigen/Geometry>
#include <array>
#include <charconv>
#include <filesystem>
#include <map>
#include <optional>

#include "ngs/core/error.h"
#include "ngs/io/capture/colmap_model.h"
#include "ngs/io/capture/pose.h"
#include "ngs/io/capture/sparse_points.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/byte_reader.h"
#include "ngs/io/files/folder_index.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

bool has_model(const fs::path& folder, const char* extension) {
  return is_regular_file((folder / "cameras").generic_string() + extension) &&
         is_regular_file((folder / "images").generic_string() + extension);
}

ColmapCameras read_cameras(ByteReader reader, const ColmapReading& reading) {
  constexpr std::size_t kSmallestCamera = 24 + 2 * 8;  // a panorama's
  ColmapCameras cameras;
  const std::uint64_t count = reader.read_count(kSmallestCamera);
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto id = reader.read<std::int32_t>();
    const auto model_id = reader.read<std::int32_t>();
    const auto width = reader.read<std::uint64_t>(), height = reader.read<std::uint64_t>();
    const std::string where = reader.object() + ": camera " + std::to_string(id);
    const ColmapModel* model = find_colmap_model_by_id(model_id);
    if (model == nullptr) refuse_colmap_model("number " + std::to_string(model_id), where, reading.folder);
    std::vector<double> parameters;
    for (int p = 0; p < model->parameters; ++p) parameters.push_back(reader.read<double>());
    if (!cameras.emplace(id, intrinsics_of({*model, width, height, parameters}, where, reading)).second)
      throw Error(ErrorCode::kBadInput, where + ": defined twice, expected once");
  }
  return cameras;
}

/// Text with numbers in their shortest exact decimal form.
class Text {
 public:
  Text& operator<<(std::string_view text) {
    text_ += text;
    return *this;
  }
  Text& operator<<(double value) { return number(value); }
  Text& operator<<(std::int64_t value) { return number(value); }
  const std::string& str() const { return text_; }
  void save(const std::string& path) const { write_file(path, text_); }

 private:
  template <class T>
  Text& number(T value) {
    char buffer[32];
    const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
    text_.append(buffer, error == std::errc() ? end : buffer);
    return *this;
  }
  std::string text_;
};

Eigen::Quaterniond quaternion(const Mat3<double>& m) {
  const Eigen::Matrix3d r = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(m.m);
  Eigen::Quaterniond q(r);
  q.normalize();
  return q.w() < 0 ? Eigen::Quaterniond(-q.w(), -q.x(), -q.y(), -q.z()) : q;
}

/// Writes cameras.txt; returns the camera id of every image.
std::vector<std::int64_t> write_cameras(const std::string& path, std::span<const Camera> cameras) {
  std::map<std::array<double, 6>, std::int64_t> known;
  std::vector<std::int64_t> ids;
  Text text;
  text << "# CAMERA_ID MODEL WIDTH HEIGHT fx fy cx cy\n";
  for (const Camera& c : cameras) {
    const std::array<double, 6> key{double(c.width_px), double(c.height_px), c.fx, c.fy, c.cx, c.cy};
    const auto [at, is_new] = known.try_emplace(key, std::int64_t(known.size()) + 1);
    ids.push_back(at->second);
    if (!is_new) continue;
    text << at->second << " PINHOLE " << std::int64_t(c.width_px) << " " << std::int64_t(c.height_px) << " " << c.fx
         << " " << c.fy << " " << c.cx << " " << c.cy << "\n";
  }
  text.save(path);
  return ids;
}

}  // namespace

std::string find_colmap_model(const std::string& folder) {
  for (const char* below : {"", "sparse/0", "sparse", "0", "colmap/sparse/0"}) {
    const fs::path candidate = *below == '\0' ? fs::path(folder) : fs::path(folder) / below;
    if (has_model(candidate, ".bin") || has_model(candidate, ".txt")) return candidate.generic_string();
  }
  for (const char* below : {"sparse", "colmap/sparse"})  // without a model 0
    for (const std::string& name : list_folders((fs::path(folder) / below).generic_string()))
      if (const fs::path candidate = fs::path(folder) / below / name;
          has_model(candidate, ".bin") || has_model(candidate, ".txt"))
        return candidate.generic_string();
  return {};
}

Capture parse_colmap_binary(Bytes cameras, Bytes images, const std::string& object, Distortion distortion) {
  const ColmapCameras intrinsics = read_cameras(ByteReader(cameras, object + "/cameras.bin"), {object, distortion});
  constexpr std::size_t kSmallestImage = 4 + 7 * 8 + 4 + 1 + 8, kPointBytes = 24;
  ByteReader reader(images, object + "/images.bin");
  Capture capture;
  capture.format = "COLMAP binary";
  const std::uint64_t count = reader.read_count(kSmallestImage);
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto id = reader.read<std::int32_t>();
    double pose[7];
    for (double& value : pose) value = reader.read<double>();
    const auto camera_id = reader.read<std::int32_t>();
    const std::string name = reader.read_name();
    reader.skip(reader.read_count(kPointBytes) * kPointBytes);
    const std::string where = reader.object() + ": image " + std::to_string(id) + " (" + name + ")";
    const auto found = intrinsics.find(camera_id);
    if (found == intrinsics.end())
      throw Error(ErrorCode::kBadInput,
                  where + ": camera " + std::to_string(camera_id) + ", expected one of cameras.bin");
    SceneView& view = capture.views.emplace_back();
    set_intrinsics(found->second, name, capture, view);
    view.camera.rotation = rotation_from_quaternion(pose, where);
    view.camera.translation = vec3(pose + 4);
  }
  finish_capture(capture, reader.object());
  return capture;
}

Capture read_colmap(const std::string& model_folder, Distortion distortion, const PhotoCount& photos) {
  const auto read = [&](bool binary) {
    const std::string extension = binary ? ".bin" : ".txt";
    const MappedFile cameras = map_regular_file(model_folder + "/cameras" + extension);
    const MappedFile images = map_regular_file(model_folder + "/images" + extension);
    return binary ? parse_colmap_binary(cameras.bytes(), images.bytes(), model_folder, distortion)
                  : parse_colmap_text(cameras.text(), images.text(), model_folder, distortion);
  };
  const bool has_binary = has_model(model_folder, ".bin");
  if (!has_binary || !has_model(model_folder, ".txt")) return read(has_binary);
  std::optional<Capture> capture, text;
  std::string reason = "more of its images exist";
  try {
    capture = read(true);
  } catch (const Error& e) {
    reason = e.what();
  }
  try {
    text = read(false);
  } catch (const Error&) {
    if (!capture) return read(true);
  }
  const bool takes_text = !capture || (text && photos && photos(*text) > photos(*capture));
  if (takes_text) capture = std::move(text);
  capture->notes.push_back(model_folder + ": holds a binary and a text model, the " +
                           (takes_text ? "text one is used (" + reason + ")" : "binary one is used"));
  return std::move(*capture);
}

void write_colmap_text(const std::string& folder, std::span<const Camera> cameras,
                       std::span<const SparsePoint> points) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error(ErrorCode::kEnvironment, folder + ": " + error.message() + ", expected a folder to write to");
  const std::vector<std::int64_t> camera_ids = write_cameras(folder + "/cameras.txt", cameras);

  std::vector<Text> seen(cameras.size());
  std::vector<std::int64_t> seen_count(cameras.size(), 0);
  Text points_text;
  points_text << "# POINT3D_ID X Y Z R G B ERROR TRACK[] as (IMAGE_ID, POINT2D_IDX)\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SparsePoint& p = points[i];
    const auto id = std::int64_t(i) + 1;
    points_text << id << " " << p.position.x << " " << p.position.y << " " << p.position.z;
    for (const std::uint8_t c : p.rgb) points_text << " " << std::int64_t(c);
    points_text << " 0.5";
    for (const SparsePoint::Observation& o : p.track) {
      const auto view = std::size_t(o.view);
      points_text << " " << std::int64_t(o.view) + 1 << " " << seen_count[view]++;
      seen[view] << (seen_count[view] > 1 ? " " : "") << o.x << " " << o.y << " " << id;
    }
    points_text << "\n";
  }
  points_text.save(folder + "/points3D.txt");

  Text images;
  images << "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, then POINTS2D[] as (X, Y, POINT3D_ID)\n";
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Eigen::Quaterniond q = quaternion(cameras[i].rotation);
    const Vec3<double> t = cameras[i].translation;
    images << std::int64_t(i) + 1 << " " << q.w() << " " << q.x() << " " << q.y() << " " << q.z() << " " << t.x << " "
           << t.y << " " << t.z << " " << camera_ids[i] << " " << cameras[i].name << "\n"
           << seen[i].str() << "\n";
  }
  images.save(folder + "/images.txt");
}

}  // namespace ngs::io
