#include "support/ball_scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "ngs/core/rng.h"
#include "ngs/io/image/image_file.h"
#include "ngs/ops/splat/splat.h"
#include "support/tiny_scene.h"

namespace ngs::test {
namespace {

constexpr int kSize = 2;  // factor over the tiny photos, so that the outline has enough pixels

/// The rows of the ball, and the first `more` rows of the wall.
GaussianCloud ball_of(const TinyScene& tiny, std::size_t more) {
  GaussianCloud cloud = tiny.cloud;
  const auto rows = std::size_t(std::count(tiny.is_object.begin(), tiny.is_object.end(), 1.f)) + more;
  GaussianCloud ball;
  ball.resize(std::int64_t(rows), 1);
  std::copy_n(cloud.position.begin(), 3 * rows, ball.position.begin());
  std::copy_n(cloud.log_scale.begin(), 3 * rows, ball.log_scale.begin());
  std::copy_n(cloud.rotation.begin(), 4 * rows, ball.rotation.begin());
  std::copy_n(cloud.logit_opacity.begin(), rows, ball.logit_opacity.begin());
  std::copy_n(cloud.sh_dc.begin(), 3 * rows, ball.sh_dc.begin());
  std::copy_n(cloud.sh_rest.begin(), 9 * rows, ball.sh_rest.begin());
  return ball;
}

void write_text(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

std::uint8_t level(float value) { return std::uint8_t(std::lround(255 * std::clamp(value, 0.f, 1.f))); }

}  // namespace

void write_ball_scene(const std::string& folder, Vec3<float> behind) {
  const TinyScene tiny = tiny_scene();
  write_tiny_scene(folder);
  const GaussianCloud ball = ball_of(tiny, 0);
  for (const Camera& small : tiny.cameras) {
    const Camera camera = resized(small, kSize * small.width_px, kSize * small.height_px);
    RenderRequest request;
    request.background = behind;
    const RenderedView view = render({}, ball, camera, {}, request);
    ImageU8 photo(camera.width_px, camera.height_px, 3), mask(camera.width_px, camera.height_px, 1);
    for (std::size_t i = 0; i < photo.data.size(); ++i) photo.data[i] = level(view.colour.data[i]);
    for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = view.alpha.data[i] > 0.5f ? 255 : 0;
    io::write_png(folder + "/images/" + camera.name, photo);
    io::write_png(folder + "/masks/" + camera.name, mask);
  }
  GaussianCloud model = ball;
  for (std::size_t i = 0; i < model.log_scale.size(); ++i)
    model.log_scale[i] += float(0.8 * (rng_uniform(9, RngStream::kTest, i) - 0.3));
  write_text(folder + "/model.ply", strict_ply_bytes(model));
  std::filesystem::remove(folder + "/scene.json");
}

void write_cut_out_ball_scene(const std::string& folder, Vec3<float> behind) {
  const TinyScene tiny = tiny_scene();
  write_tiny_scene(folder);
  const GaussianCloud ball = ball_of(tiny, 0);
  for (const Camera& camera : tiny.cameras) {
    const RenderedView alone = render({}, ball, camera, {}, {}), room = render({}, tiny.cloud, camera, {}, {});
    ImageU8 photo(camera.width_px, camera.height_px, 4);
    for (std::size_t p = 0; p < alone.alpha.data.size(); ++p) {
      const bool object = alone.alpha.data[p] > 0.5f;
      for (std::size_t c = 0; c < 3; ++c) photo.data[4 * p + c] = level(room.colour.data[3 * p + c]);
      photo.data[4 * p + 3] = object ? 255 : 0;
    }
    io::write_png(folder + "/images/" + camera.name, photo);
  }
  GaussianCloud model = ball_of(tiny, 40);  // the blobs take the place of the wall's first rows
  const float colour[3] = {behind.x, behind.y, behind.z};
  for (std::size_t i = std::size_t(ball.size()); i < std::size_t(model.size()); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      model.sh_dc[3 * i + c] = (colour[c] - 0.5f) / 0.28209479f;
      std::fill_n(model.sh_rest.begin() + std::ptrdiff_t(9 * i), 9, 0.f);
    }
  write_text(folder + "/model.ply", strict_ply_bytes(model));
  std::filesystem::remove(folder + "/scene.json");
}

}  // namespace ngs::test
