#pragma once
// The tiny scene as a capture of a stranger: COLMAP text, photos, masks and a splat, with other names or lengths.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

#include "ngs/io/image/image_file.h"
#include "support/process.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"

namespace ngs::test {

constexpr int kCaptureViews = 6;

/// Names of view i without an extension.
struct CaptureNames {
  std::function<std::string(int)> camera = [](int i) { return "v" + std::to_string(i); }, photo = camera, mask = camera;
  std::string camera_extension = ".png", photo_extension = ".png", mask_extension = ".png";
};

class Capture {
 public:
  explicit Capture(const CaptureNames& names = {}, std::string folder = "c") : folder_(std::move(folder)) {
    write_tiny_scene(dir.path() + "/tiny");
    std::string images = read_bytes(dir.path() + "/tiny/text/images.txt");
    for (int i = 0; i < kCaptureViews; ++i) {
      const std::string old_name = "v" + std::to_string(i) + ".png";
      images.replace(images.find(old_name), old_name.size(), names.camera(i) + names.camera_extension);
      move("tiny/images/" + old_name, "images/" + names.photo(i) + names.photo_extension);
      move("tiny/masks/" + old_name, "masks/" + names.mask(i) + names.mask_extension);
    }
    dir.write(folder_ + "/sparse/0/images.txt", images);
    for (const char* name : {"cameras.txt", "points3D.txt"})
      move(std::string("tiny/text/") + name, std::string("sparse/0/") + name);
    move("tiny/model.ply", "point_cloud.ply");
    std::filesystem::remove_all(dir.path() + "/tiny");
  }

  /// All lengths times `factor`.
  void scale(double factor) const {
    GaussianCloud cloud = tiny_scene().cloud;
    for (float& x : cloud.position) x = float(factor * double(x));
    for (float& s : cloud.log_scale) s = float(double(s) + std::log(factor));
    dir.write(folder_ + "/point_cloud.ply", strict_ply_bytes(cloud));
    std::istringstream lines(read_bytes(path("sparse/0/images.txt")));
    std::ostringstream out;
    out.precision(17);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string word;
      for (int k = 0; words >> word; ++k)
        k >= 5 && k < 8 ? out << ' ' << factor * std::stod(word) : out << (k > 0 ? " " : "") << word;
      out << '\n';
    }
    dir.write(folder_ + "/sparse/0/images.txt", out.str());
  }

  std::string path(const std::string& name) const { return dir.path() + "/" + folder_ + "/" + name; }
  const std::string& folder() const { return folder_; }

  /// Runs a tool in the folder that holds the capture.
  ProcessResult run(const Words& argv) const { return run_tool(argv, dir.path()); }
  ProcessResult import() const { return run({"ngs-scene", "import", "./" + folder_, "-o", "s.json", "-w"}); }
  /// The scene.json that import wrote.
  nlohmann::json scene() const { return nlohmann::json::parse(read_bytes(dir.path() + "/s.json")); }
  int views_with(const char* key) const {
    int count = 0;
    const nlohmann::json root = scene();
    for (const nlohmann::json& view : root["views"]) count += view.value(key, "") != "";
    return count;
  }

  TempDir dir;

 private:
  void move(const std::string& from, const std::string& to) const {
    std::filesystem::rename(dir.path() + "/" + from, dir.file(folder_ + "/" + to));
  }
  std::string folder_;
};

inline void move(const Capture& capture, const std::string& from, const std::string& to) {
  std::filesystem::create_directories(std::filesystem::path(capture.path(to)).parent_path());
  std::filesystem::rename(capture.path(from), capture.path(to));
}

/// Imports the capture, which must find all photos, masks and the splat.
inline void check_complete(const Capture& capture) {
  succeeded(capture.import());
  CHECK(capture.views_with("image") == kCaptureViews);
  CHECK(capture.views_with("mask") == kCaptureViews);
  CHECK(capture.scene().value("model", "") != "");
}

/// The masks of all views after a change of each picture.
template <class Change>
void change_masks(const Capture& capture, const Change& change) {
  for (int i = 0; i < kCaptureViews; ++i) {
    const std::string path = capture.path("masks/v" + std::to_string(i) + ".png");
    const io::RawMask mask = io::read_mask_raw(path, io::Palette::kMask);
    const ImageF photo = io::read_image_rgb(capture.path("images/v" + std::to_string(i) + ".png"));
    ImageU8 picture(mask.width_px, mask.height_px, 3);
    for (std::size_t p = 0; p < mask.data.size() / std::size_t(mask.channels); ++p)
      for (std::size_t c = 0; c < 3; ++c) {
        const bool is_object = mask.data[p * std::size_t(mask.channels)] > 127;
        picture.data[3 * p + c] = change(is_object, std::uint8_t(255 * photo.data[3 * p + c]), c);
      }
    std::filesystem::remove(path);
    io::write_png(path, picture);
  }
}

}  // namespace ngs::test
