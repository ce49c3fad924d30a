#pragma once
// Writes cameras in every format that ngs-scene reads. Independent of the readers: written from the formats' own
// descriptions.
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "ngs/core/rng.h"
#include "ngs/io/capture/transforms_json.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/scene.h"
#include "support/temp_dir.h"

namespace ngs::test {

/// Unit quaternion w x y z -> rotation, by the textbook formula.
inline Mat3<double> rotation_of(double w, double x, double y, double z) {
  const double n = std::sqrt(w * w + x * x + y * y + z * z);
  w /= n;
  x /= n;
  y /= n;
  z /= n;
  return {{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z),
           w * w - x * x + y * y - z * z, 2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x),
           w * w - x * x - y * y + z * z}};
}

struct PosedCamera {
  Camera camera;
  double q[4];  // w x y z of camera.rotation
};

/// Cameras with random poses. `centred`: restricted to formats without a principal point (centred, fx = fy).
inline std::vector<PosedCamera> random_cameras(int count, bool centred) {
  std::vector<PosedCamera> out;
  for (int i = 0; i < count; ++i) {
    const auto normal = [&](int k) { return rng_normal(7, RngStream::kTest, std::uint64_t(i * 16 + k)); };
    PosedCamera p;
    double n = 0;
    for (int k = 0; k < 4; ++k) {
      p.q[k] = normal(k);
      n += p.q[k] * p.q[k];
    }
    for (double& q : p.q) q /= std::sqrt(n);
    Camera& c = p.camera;
    c.name = std::string("view ").append(std::to_string(i)) + ".png";  // a blank in the name
    c.width_px = 640;
    c.height_px = 480;
    c.fx = 500 + 10 * normal(4);
    c.fy = centred ? c.fx : 510 + 10 * normal(5);
    c.cx = centred ? 320 : 320 + 5 * normal(6);
    c.cy = centred ? 240 : 240 + 5 * normal(7);
    c.rotation = rotation_of(p.q[0], p.q[1], p.q[2], p.q[3]);
    c.translation = {normal(8), normal(9), 5 + normal(10)};
    out.push_back(p);
  }
  return out;
}

class ByteWriter {
 public:
  template <class T>
  ByteWriter& put(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes.append(raw, sizeof(T));
    return *this;
  }
  std::string bytes;
};

struct ColmapFiles {
  std::string cameras, images;
};

inline ColmapFiles colmap_binary(const std::vector<PosedCamera>& views, int points_per_image = 2) {
  ByteWriter cameras, images;
  cameras.put(std::uint64_t(views.size()));
  images.put(std::uint64_t(views.size()));
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Camera& c = views[i].camera;
    cameras.put(std::int32_t(i + 1))
        .put(std::int32_t(1))
        .put(std::uint64_t(c.width_px))
        .put(std::uint64_t(c.height_px));
    cameras.put(c.fx).put(c.fy).put(c.cx).put(c.cy);
    images.put(std::int32_t(100 + i));
    for (const double q : views[i].q) images.put(q);
    images.put(c.translation.x).put(c.translation.y).put(c.translation.z).put(std::int32_t(i + 1));
    images.bytes += c.name + '\0';
    images.put(std::uint64_t(points_per_image));
    for (int p = 0; p < points_per_image; ++p) images.put(1.5).put(2.5).put(std::int64_t(-1));
  }
  return {cameras.bytes, images.bytes};
}

inline ColmapFiles colmap_text(const std::vector<PosedCamera>& views) {
  std::ostringstream cameras, images;
  cameras.precision(17);
  images.precision(17);
  cameras << "# Camera list\n";
  images << "# Image list\n";
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Camera& c = views[i].camera;
    cameras << i + 1 << " PINHOLE " << c.width_px << ' ' << c.height_px << ' ' << c.fx << ' ' << c.fy << ' ' << c.cx
            << ' ' << c.cy << '\n';
    images << i + 1;
    for (const double q : views[i].q) images << ' ' << q;
    images << ' ' << c.translation.x << ' ' << c.translation.y << ' ' << c.translation.z << ' ' << i + 1 << ' '
           << c.name << '\n';
    // every second image has no points: its second line is empty
    images << (i % 2 == 0 ? "1.5 2.5 -1 3 4 17" : "") << '\n';
  }
  return {cameras.str(), images.str()};
}

/// Camera -> world, columns negated by `y` and `z` (OpenGL axes: -1, -1).
inline nlohmann::json camera_to_world(const Camera& c, double y, double z) {
  const Mat3<double> axes = transpose(c.rotation);
  const Vec3<double> centre = c.centre();
  const double centres[3] = {centre.x, centre.y, centre.z};
  nlohmann::json rows = nlohmann::json::array();
  for (int r = 0; r < 3; ++r) rows.push_back({axes(r, 0), y * axes(r, 1), z * axes(r, 2), centres[r]});
  rows.push_back({0, 0, 0, 1});
  return rows;
}

inline nlohmann::json transforms_json(const std::vector<PosedCamera>& views) {
  nlohmann::json root{
      {"camera_model", "OPENCV"}, {"k1", 0.0}, {"w", 640}, {"h", 480.0}, {"frames", nlohmann::json::array()}};
  for (const PosedCamera& view : views)
    root["frames"].push_back({{"file_path", "./images/" + view.camera.name},
                              {"fl_x", view.camera.fx},
                              {"fl_y", view.camera.fy},
                              {"cx", view.camera.cx},
                              {"cy", view.camera.cy},
                              {"transform_matrix", camera_to_world(view.camera, -1, -1)}});
  return root;
}

inline nlohmann::json cameras_json(const std::vector<PosedCamera>& views) {
  nlohmann::json root = nlohmann::json::array();
  for (const PosedCamera& view : views) {
    const nlohmann::json c2w = camera_to_world(view.camera, 1, 1);
    nlohmann::json rotation = nlohmann::json::array(), position = nlohmann::json::array();
    for (int r = 0; r < 3; ++r) {
      rotation.push_back({c2w[std::size_t(r)][0], c2w[std::size_t(r)][1], c2w[std::size_t(r)][2]});
      position.push_back(c2w[std::size_t(r)][3]);
    }
    root.push_back({{"id", root.size()},
                    {"img_name", view.camera.name},
                    {"width", 640},
                    {"height", 480},
                    {"position", position},
                    {"rotation", rotation},
                    {"fx", view.camera.fx},
                    {"fy", view.camera.fy}});
  }
  return root;
}

inline std::string npy_header(const std::string& type, bool fortran, const std::string& shape) {
  std::string dict =
      "{'descr': '" + type + "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': " + shape + ", }";
  dict.append(64 - (10 + dict.size() + 1) % 64, ' ');
  dict += '\n';
  return std::string("\x93NUMPY\x01\x00", 8) + char(dict.size() & 255) + char(dict.size() >> 8) + dict;
}

/// poses_bounds.npy: axes (down, right, backward), centre, (height, width, focal), bounds.
inline std::string llff_npy(const std::vector<PosedCamera>& views) {
  ByteWriter out;
  out.bytes = npy_header("<f8", false, std::string("(").append(std::to_string(views.size())) + ", 17)");
  for (const PosedCamera& view : views) {
    const Mat3<double> axes = transpose(view.camera.rotation);
    const Vec3<double> o = view.camera.centre();
    const double centre[3] = {o.x, o.y, o.z}, hwf[3] = {480, 640, view.camera.fx};
    for (int r = 0; r < 3; ++r) out.put(axes(r, 1)).put(axes(r, 0)).put(-axes(r, 2)).put(centre[r]).put(hwf[r]);
    out.put(0.5).put(9.0);
  }
  return out.bytes;
}

/// Views of which only the names matter.
inline std::vector<SceneView> views_named(const std::vector<std::string>& names) {
  std::vector<SceneView> views(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) views[i].camera.name = names[i];
  return views;
}

/// Cameras of these names for pictures of this size, as COLMAP text in `folder`.
inline void write_cameras(const TempDir& dir, const std::string& folder, const std::vector<std::string>& names,
                          int width_px = 64, int height_px = 48) {
  std::vector<PosedCamera> views = random_cameras(int(names.size()), false);
  for (std::size_t i = 0; i < views.size(); ++i) {
    views[i].camera.name = names[i];
    views[i].camera.width_px = width_px;
    views[i].camera.height_px = height_px;
  }
  const ColmapFiles files = colmap_text(views);
  dir.write((std::filesystem::path(folder) / "cameras.txt").string(), files.cameras);
  dir.write((std::filesystem::path(folder) / "images.txt").string(), files.images);
}

/// A transforms.json in /data, where no image is.
inline io::TransformsSource no_images(bool original_world = false) {
  return {"/data",
          "transforms.json",
          original_world,
          {[](const std::string&) { return false; }, [](const std::string&) { return io::ImageSize{}; }}};
}

}  // namespace ngs::test
