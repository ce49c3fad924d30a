#include "large_scenes/written_scene.h"

#include <cstdio>
#include <filesystem>
#include <map>

#include "ngs/io/capture/sparse_points.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/ply/gaussian_ply.h"

namespace ngs::bench {
namespace {

constexpr int kJpegQuality = 92;

void write_jpeg(const std::string& path, const ImageU8& rgb) {
  const std::vector<std::uint8_t> bytes = io::encode_jpeg(rgb, kJpegQuality);
  io::AtomicFile file(path);
  file.write(bytes.data(), bytes.size());
  file.commit();
}

}  // namespace

std::string view_name(std::size_t index) {
  char name[16];
  std::snprintf(name, sizeof name, "%05zu.jpg", index);
  return name;
}

void write_scene(const std::string& folder, const GaussianCloud& cloud, const std::vector<WrittenView>& views,
                 const std::function<LabelledPhoto(std::size_t picture)>& picture) {
  namespace fs = std::filesystem;
  for (const char* part : {"/images", "/masks_label", "/sparse/0"}) fs::create_directories(folder + part);
  io::write_strict_ply(folder + "/point_cloud.ply", cloud, {});
  std::vector<Camera> cameras;
  std::map<std::size_t, fs::path> drawn;  // picture -> stem of the first view with it
  for (const WrittenView& view : views) {
    cameras.push_back(view.camera);
    const fs::path stem = fs::path(view.camera.name).stem();
    const auto photo = [&](const fs::path& of) { return folder + "/images/" + of.string() + ".jpg"; };
    const auto label = [&](const fs::path& of) { return folder + "/masks_label/" + of.string() + ".png"; };
    const auto [at, is_new] = drawn.try_emplace(view.picture, stem);
    if (is_new) {
      const LabelledPhoto made = picture(view.picture);
      write_jpeg(photo(stem), made.rgb);
      io::write_png(label(stem), made.label);
    } else {
      fs::create_hard_link(photo(at->second), photo(stem));
      fs::create_hard_link(label(at->second), label(stem));
    }
  }
  io::write_colmap_text(folder + "/sparse/0", cameras, {});
}

}  // namespace ngs::bench
