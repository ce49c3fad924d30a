#include "support/tiny_scene.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "ngs/io/image/image_file.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/ops/splat/splat.h"

namespace ngs::test {
namespace {

constexpr int kBall = 150, kWallColumns = 16, kWallRows = 14, kViews = 6;

using Json = nlohmann::json;
using Point = Vec3<double>;

void set_gaussian(TinyScene& scene, std::int64_t i, Point at, double scale, Point rgb, double logit_opacity) {
  GaussianCloud& cloud = scene.cloud;
  const auto row = std::size_t(i);
  const double position[3] = {at.x, at.y, at.z}, colour[3] = {rgb.x, rgb.y, rgb.z};
  for (std::size_t c = 0; c < 3; ++c) {
    cloud.position[row * 3 + c] = float(position[c]);
    cloud.log_scale[row * 3 + c] = float(std::log(scale * (1 + 0.2 * double((row + c) % 3))));
    cloud.sh_dc[row * 3 + c] = float((colour[c] - 0.5) / 0.28209479177387814);
    cloud.sh_rest[row * 9 + c] = float(0.02 * std::sin(double(row)));  // slight view dependence
  }
  const double angle = 0.3 * double(row);
  cloud.rotation[row * 4] = float(std::cos(angle));
  cloud.rotation[row * 4 + 1 + row % 3] = float(std::sin(angle));
  cloud.logit_opacity[row] = float(logit_opacity);
}

Camera camera_at(int view) {
  const double yaw = (view - 2.5) * 0.16, pitch = 0.1 * ((view % 3) - 1);
  const Point forward{std::sin(yaw) * std::cos(pitch), std::sin(pitch), std::cos(yaw) * std::cos(pitch)};
  const Point side = cross(Point{0, 1, 0}, forward);
  const Point right = (1 / std::sqrt(dot(side, side))) * side, down = cross(forward, right);
  Camera camera{"v" + std::to_string(view) + ".png", 48, 36, 45, 45.5, 24.3, 17.6};
  camera.rotation = {{right.x, right.y, right.z, down.x, down.y, down.z, forward.x, forward.y, forward.z}};
  camera.translation = {0, 0, 3};
  return camera;
}

void write_images(const TinyScene& scene, const std::string& folder) {
  for (const char* name : {"images", "masks", "labels"}) std::filesystem::create_directories(folder + "/" + name);
  for (const Camera& camera : scene.cameras) {
    RenderRequest request{.label = {scene.is_object.data(), scene.cloud.size(), 1}};
    const RenderedView view = render(Exec{}, scene.cloud, camera, {}, request);
    ImageU8 photo(camera.width_px, camera.height_px, 3), mask(camera.width_px, camera.height_px, 1), label = mask;
    for (std::size_t i = 0; i < photo.data.size(); ++i)
      photo.data[i] = std::uint8_t(std::lround(255 * std::min(1.f, std::max(0.f, view.colour.data[i]))));
    for (std::size_t i = 0; i < mask.data.size(); ++i) {
      mask.data[i] = view.label.data[i] > 0.5f ? 255 : 0;
      label.data[i] = view.label.data[i] > 0.5f ? 7 : 0;
    }
    io::write_png(folder + "/images/" + camera.name, photo);
    io::write_png(folder + "/masks/" + camera.name, mask);
    io::write_png(folder + "/labels/" + camera.name, label);
  }
}

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void write_text(const std::string& path, const std::string& bytes) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
}

struct Quaternion {
  double w, x, y, z;
};
Quaternion quaternion(const Mat3<double>& r) {  // w > 0: the cameras turn by less than half a turn
  const double w = 0.5 * std::sqrt(1 + r.m[0] + r.m[4] + r.m[8]);
  return {w, (r.m[7] - r.m[5]) / (4 * w), (r.m[2] - r.m[6]) / (4 * w), (r.m[3] - r.m[1]) / (4 * w)};
}

void write_colmap(const TinyScene& scene, const std::string& folder) {
  const Camera& first = scene.cameras.front();
  std::string cameras, images, points;
  std::ostringstream cameras_txt, images_txt;
  cameras_txt.precision(17);
  images_txt.precision(17);
  put(cameras, std::uint64_t(1));
  put(cameras, std::int32_t(1));
  put(cameras, std::int32_t(1));  // PINHOLE
  put(cameras, std::uint64_t(first.width_px));
  put(cameras, std::uint64_t(first.height_px));
  for (const double value : {first.fx, first.fy, first.cx, first.cy}) put(cameras, value);
  cameras_txt << "1 PINHOLE " << first.width_px << ' ' << first.height_px << ' ' << first.fx << ' ' << first.fy << ' '
              << first.cx << ' ' << first.cy << '\n';
  put(images, std::uint64_t(scene.cameras.size()));
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    const Camera& camera = scene.cameras[i];
    const Quaternion q = quaternion(camera.rotation);
    put(images, std::int32_t(i + 1));
    images_txt << i + 1;
    for (const double value : {q.w, q.x, q.y, q.z, camera.translation.x, camera.translation.y, camera.translation.z})
      put(images, value), images_txt << ' ' << value;
    put(images, std::int32_t(1));
    images += camera.name;
    images.push_back('\0');
    put(images, std::uint64_t(0));
    images_txt << " 1 " << camera.name << "\n\n";
  }
  put(points, std::uint64_t(0));
  write_text(folder + "/sparse/0/cameras.bin", cameras);
  write_text(folder + "/sparse/0/images.bin", images);
  write_text(folder + "/sparse/0/points3D.bin", points);
  write_text(folder + "/text/cameras.txt", cameras_txt.str());
  write_text(folder + "/text/images.txt", images_txt.str());
  write_text(folder + "/text/points3D.txt", "");
}

void write_json_poses(const TinyScene& scene, const std::string& folder) {
  const Camera& first = scene.cameras.front();
  Json transforms = {{"w", first.width_px}, {"h", first.height_px}, {"fl_x", first.fx},       {"fl_y", first.fy},
                     {"cx", first.cx},      {"cy", first.cy},       {"frames", Json::array()}};
  Json inria = Json::array();
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    const Camera& camera = scene.cameras[i];
    const double* r = camera.rotation.m;
    const Point c = camera.centre();
    // camera to world; transforms.json has OpenGL axes (y up, z backward)
    transforms["frames"].push_back(
        {{"file_path", "images/" + camera.name},
         {"transform_matrix",
          {{r[0], -r[3], -r[6], c.x}, {r[1], -r[4], -r[7], c.y}, {r[2], -r[5], -r[8], c.z}, {0, 0, 0, 1}}}});
    inria.push_back({{"id", i},
                     {"img_name", "v" + std::to_string(i)},
                     {"width", camera.width_px},
                     {"height", camera.height_px},
                     {"position", {c.x, c.y, c.z}},
                     {"rotation", {{r[0], r[3], r[6]}, {r[1], r[4], r[7]}, {r[2], r[5], r[8]}}},
                     {"fx", camera.fx},
                     {"fy", camera.fy}});
  }
  write_text(folder + "/transforms.json", transforms.dump(1));
  write_text(folder + "/cameras.json", inria.dump(1));
}

}  // namespace

void add_unseen(GaussianCloud& cloud) {
  const std::int64_t before = cloud.size();
  cloud.resize(before + 3000, cloud.sh_degree);
  for (std::int64_t i = before; i < cloud.size(); ++i) {
    const auto row = std::size_t(i), k = std::size_t(i - before);
    const double at[3] = {0.1 * double(k % 10) - 0.5, 0.1 * double(k / 10 % 10) - 0.5, -4 - 0.1 * double(k / 100)};
    for (std::size_t a = 0; a < 3; ++a) {
      cloud.position[3 * row + a] = float(at[a]);
      cloud.log_scale[3 * row + a] = -3;
    }
    cloud.rotation[4 * row] = 1;
    cloud.logit_opacity[row] = 3;
  }
  classify(cloud);
}

TinyScene tiny_scene() {
  TinyScene scene;
  const int wall = kWallColumns * kWallRows;
  scene.cloud.resize(kBall + wall, 1);
  scene.is_object.assign(std::size_t(kBall + wall), 0.f);
  for (int i = 0; i < kBall; ++i) {  // a Fibonacci sphere
    const double y = 1 - 2 * (i + 0.5) / kBall, phi = 2.399963229728653 * i, r = std::sqrt(1 - y * y);
    set_gaussian(scene, i, {0.5 * r * std::cos(phi), 0.5 * y, 0.5 * r * std::sin(phi)}, 0.07,
                 {0.8, 0.2 + 0.2 * y, 0.15}, 3);
    scene.is_object[std::size_t(i)] = 1;
  }
  for (int i = 0; i < wall; ++i) {
    const double x = (i % kWallColumns - 7.5) * 0.28, y = (i / kWallColumns - 6.5) * 0.26;
    set_gaussian(scene, kBall + i, {x, y, 0.9}, 0.14, {0.3 + 0.1 * std::sin(5 * x), 0.5, 0.6 + 0.1 * std::cos(4 * y)},
                 2.5);
  }
  for (int view = 0; view < kViews; ++view) scene.cameras.push_back(camera_at(view));
  return scene;
}

std::string strict_ply_bytes(const GaussianCloud& cloud) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(cloud.size()) + "\n";
  std::vector<std::string> names = {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"};
  for (int i = 0; i < 3 * cloud.rest_count(); ++i) names.push_back("f_rest_" + std::to_string(i));
  for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"})
    names.push_back(name);
  for (const std::string& name : names) bytes += "property float " + name + "\n";
  bytes += "end_header\n";
  const auto rest = std::size_t(cloud.rest_count());
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
    for (std::size_t c = 0; c < 3; ++c) put(bytes, cloud.position[i * 3 + c]);
    for (int c = 0; c < 3; ++c) put(bytes, 0.f);
    for (std::size_t c = 0; c < 3; ++c) put(bytes, cloud.sh_dc[i * 3 + c]);
    for (std::size_t c = 0; c < 3; ++c)  // channel-major in the file
      for (std::size_t k = 0; k < rest; ++k) put(bytes, cloud.sh_rest[(i * rest + k) * 3 + c]);
    put(bytes, cloud.logit_opacity[i]);
    for (std::size_t c = 0; c < 3; ++c) put(bytes, cloud.log_scale[i * 3 + c]);
    for (std::size_t c = 0; c < 4; ++c) put(bytes, cloud.rotation[i * 4 + c]);
  }
  return bytes;
}

void write_tiny_scene(const std::string& folder) {
  const TinyScene tiny = tiny_scene();
  write_text(folder + "/model.ply", strict_ply_bytes(tiny.cloud));
  write_images(tiny, folder);
  write_colmap(tiny, folder);
  write_json_poses(tiny, folder);
  Scene scene;
  scene.model_path = folder + "/model.ply";
  scene.objects = {{"ball", 0}};
  for (const Camera& camera : tiny.cameras)
    scene.views.push_back({camera, folder + "/images/" + camera.name, folder + "/masks/" + camera.name});
  scene.views.back().split = Split::kHeldOut;
  io::write_scene_json(folder + "/scene.json", scene);
}

}  // namespace ngs::test
