#include <Eigen/Geometry>
#include <array>
#include <charconv>
#include <filesystem>
#include <map>

#include "ngs/core/error.h"
#include "ngs/io/capture/sparse_points.h"
#include "ngs/io/files/atomic_file.h"

namespace ngs::io {
namespace {

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
