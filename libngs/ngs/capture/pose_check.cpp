#include "ngs/capture/pose_check.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ngs/core/check.h"
#include "ngs/math/median.h"
#include "ngs/math/quat.h"
#include "ngs/math/sh.h"
#include "ngs/math/stable.h"
#include "ngs/math/world_unit.h"
#include "ngs/ops/splat/splat_options.h"

namespace ngs {
namespace {

struct ChannelSums {  // over pixels: photo p, render without background c, transmittance t = 1 - alpha
  double p = 0, pp = 0, t_residual = 0, tt = 0, residual2 = 0;
};

/// min over b of Σ (p - c - t b)² = Σ (p - c)² - (Σ t (p - c))² / Σ t², b kept in [0, 1].
double fitted_error(const ChannelSums& sums, double& background) {
  background = sums.tt > 0 ? std::clamp(sums.t_residual / sums.tt, 0.0, 1.0) : 0.0;
  return sums.residual2 - 2 * background * sums.t_residual + background * background * sums.tt;
}

double db(double mean_square) { return -10 * std::log10(std::max(mean_square, 1e-12)); }

}  // namespace

PhotoMatch match_rendered(const RenderedView& view, const ImageF& photo) {
  NGS_CHECK(photo.width_px == view.width_px && photo.height_px == view.height_px && photo.channels == 3,
            "the photo has the camera's size");
  PhotoMatch match;
  double error = 0, spread = 0;
  const double n = double(photo.pixels());
  for (int channel = 0; channel < 3; ++channel) {
    ChannelSums sums;
    for (std::int64_t i = 0; i < photo.pixels(); ++i) {
      const std::size_t at = std::size_t(i) * 3 + std::size_t(channel);
      const double p = photo.data[at], r = p - view.colour.data[at], t = 1.0 - view.alpha.data[std::size_t(i)];
      sums.p += p;
      sums.pp += p * p;
      sums.t_residual += t * r;
      sums.tt += t * t;
      sums.residual2 += r * r;
    }
    double background = 0;
    error += fitted_error(sums, background);
    spread += sums.pp - sums.p * sums.p / n;
    (channel == 0 ? match.background.x : channel == 1 ? match.background.y : match.background.z) = background;
  }
  for (const float a : view.alpha.data) match.covered += double(a) / n;
  match.psnr_db = db(error / (3 * n));
  match.constant_db = db(spread / (3 * n));
  return match;
}

PhotoMatch match_photo(const Exec& exec, const GaussianCloud& cloud, const PhotoView& view, const SplatOptions& splat) {
  return match_rendered(render(exec, cloud, view.camera, splat, {}), view.photo);
}

double recoloured_gain_db(const Exec& exec, const GaussianCloud& cloud, const PhotoView& view,
                          const SplatOptions& splat, const PhotoMatch& match) {
  const ImageF& photo = view.photo;
  const Vec3<double>& background = match.background;
  RenderRequest request;
  request.background = {float(background.x), float(background.y), float(background.z)};
  const ImageF picture = render(exec, cloud, view.camera, splat, request).colour;
  NGS_CHECK(photo.data.size() == picture.data.size(), "the photo has the camera's size");
  const double n = double(photo.pixels());
  double error = 0;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    double p = 0, q = 0, pp = 0, pq = 0, qq = 0;
    for (std::size_t i = channel; i < photo.data.size(); i += 3) {
      const double a = photo.data[i], b = picture.data[i];
      p += a;
      q += b;
      pp += a * a;
      pq += a * b;
      qq += b * b;
    }
    const double own = pp - p * p / n, together = pq - p * q / n, drawn = qq - q * q / n;
    error += together > 0 && drawn > 0 ? own - together * together / drawn : own;
  }
  return db(error / (3 * n)) - match.constant_db;
}

double covered_gain_db(const Exec& exec, const GaussianCloud& cloud, const PhotoView& view, const SplatOptions& splat) {
  constexpr float kCovered = 0.9f;
  const RenderedView shown = render(exec, cloud, view.camera, splat, {});
  double error = 0, spread = 0;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    double n = 0, p = 0, pp = 0;
    for (std::size_t i = 0; i < shown.alpha.data.size(); ++i) {
      if (!(shown.alpha.data[i] > kCovered)) continue;
      const double value = view.photo.data[3 * i + channel], difference = value - shown.colour.data[3 * i + channel];
      n += 1;
      p += value;
      pp += value * value;
      error += difference * difference;
    }
    if (n > 0) spread += pp - p * p / n;
  }
  return spread > 0 ? db(error) - db(spread) : 0;
}

namespace {

/// Calls use(z) for the camera z, world, of every usable Gaussian in front.
template <class Use>
void for_each_depth(const GaussianCloud& cloud, const Camera& camera, const Use& use) {
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
    if (const double z = camera.to_camera(world_position(cloud, i)).z; cloud.usable[i] && z > 0) use(z);
  }
}

}  // namespace

double share_too_near(const GaussianCloud& cloud, std::span<const Camera> cameras, double near_z) {
  std::vector<double> shares;
  for (const Camera& camera : cameras) {
    double in_front = 0, near = 0;
    for_each_depth(cloud, camera, [&](double z) {
      ++in_front;
      near += z <= near_z;
    });
    if (in_front > 0) shares.push_back(near / in_front);
  }
  return shares.empty() ? 0 : upper_median(std::move(shares));
}

double model_world_unit(const GaussianCloud& cloud, std::span<const Camera> cameras) {
  constexpr double kUsualDepth = 2.5;  // median camera z of an ordinary world: its near plane is 0.08 of that
  std::vector<double> depths;
  for (const Camera& camera : cameras) {
    std::vector<double> in_front;
    for_each_depth(cloud, camera, [&](double z) { in_front.push_back(z); });
    if (!in_front.empty()) depths.push_back(upper_median(std::move(in_front)));
  }
  return depths.empty() ? 1 : world_unit_from(upper_median(std::move(depths)) / kUsualDepth);
}

namespace {

Camera reordered_quaternion(Camera c) {  // read as w x y z, stored x y z w
  const Vec4<double> q = quaternion_of(c.rotation);
  c.rotation = rotation_matrix(Vec4<double>{q.w, q.x, q.y, q.z});
  return c;
}

Camera inverted(Camera c) {
  const Vec3<double> centre = c.centre();
  c.rotation = transpose(c.rotation);
  c.translation = centre;
  return c;
}

Camera flipped_axes(Camera c) {  // camera y and z
  for (int i = 3; i < 9; ++i) c.rotation.m[i] = -c.rotation.m[i];
  c.translation = {c.translation.x, -c.translation.y, -c.translation.z};
  return c;
}

Camera centre_as_translation(Camera c) {  // t contains the centre
  c.translation = -1.0 * (c.rotation * c.translation);
  return c;
}

Camera transposed_rotation(Camera c) {  // R is transposed, t is correct
  c.rotation = transpose(c.rotation);
  return c;
}

/// The camera of a photo that was rotated by 180 degrees or, if only x is negated, mirrored.
Camera negated_axes(Camera c, bool negates_y) {
  for (int i = 0; i < (negates_y ? 6 : 3); ++i) c.rotation.m[i] = -c.rotation.m[i];
  c.translation.x = -c.translation.x;
  c.cx = c.width_px - c.cx;
  if (!negates_y) return c;
  c.translation.y = -c.translation.y;
  c.cy = c.height_px - c.cy;
  return c;
}

/// Undoes poses whose world is larger than the model's by this factor.
template <int kNumerator, int kDenominator = 1>
Camera shrunk_world(Camera c) {
  c.translation = double(kDenominator) / kNumerator * c.translation;
  return c;
}

template <int kNumerator, int kDenominator = 1>
Camera with_focal_length(Camera c) {
  c.fx *= double(kNumerator) / kDenominator;
  c.fy *= double(kNumerator) / kDenominator;
  return c;
}

/// The model's world is the cameras' world with axes m: x_cameras = m x_model.
Camera in_world(Camera c, const Mat3<double>& m) {
  c.rotation = c.rotation * m;
  return c;
}

}  // namespace

const std::vector<PoseRepair>& pose_repairs() {
  static constexpr const char *kScale = "bring both to one scale, such as with --world-transform",
                              *kFocal = "write that of the size to which cameras and photos are calibrated";
  static const std::vector<PoseRepair> repairs{
      {"quaternions are stored as x y z w", "write them as w x y z", reordered_quaternion},
      {"poses are camera-to-world", "invert them: COLMAP's poses are world-to-camera", inverted},
      {"camera axes are OpenGL's (y up, z backward)", "negate the camera's y and z axes", flipped_axes},
      {"poses are camera-to-world with OpenGL axes", "invert them and negate the camera's y and z axes",
       [](Camera c) { return flipped_axes(inverted(std::move(c))); }},
      {"poses are camera-to-world with OpenGL axes that were flipped after inverting", "flip the axes before inverting",
       [](Camera c) { return inverted(flipped_axes(std::move(c))); }},
      {"quaternions are stored as x y z w and poses are camera-to-world", "write them as w x y z and invert the poses",
       [](Camera c) { return inverted(reordered_quaternion(std::move(c))); }},
      {"the translation is the camera's centre", "store t = -R centre", centre_as_translation},
      {"rotations are transposed", "transpose them, keep the translations", transposed_rotation},
      {"the model is rotated by 180 degrees about x", "rotate it back, or import with --world-transform",
       [](Camera c) {
         return in_world(std::move(c), {{1, 0, 0, 0, -1, 0, 0, 0, -1}});
       }},
      {"the model is rotated by 180 degrees about z", "rotate it back, or import with --world-transform",
       [](Camera c) {
         return in_world(std::move(c), {{-1, 0, 0, 0, -1, 0, 0, 0, 1}});
       }},
      {"the model is in nerfstudio's world (x y z -> y x -z)", "import transforms.json, or use --world-transform",
       [](Camera c) {
         return in_world(std::move(c), {{0, 1, 0, 1, 0, 0, 0, 0, -1}});
       }},
      {"the model's z points up where the cameras' y points down", "rotate it back, or import with --world-transform",
       [](Camera c) {
         return in_world(std::move(c), {{1, 0, 0, 0, 0, -1, 0, 1, 0}});
       }},
      {"the cameras' world is 1000 times the model's, as millimetres", kScale, shrunk_world<1000>},
      {"the cameras' world is 100 times the model's, as centimetres", kScale, shrunk_world<100>},
      {"the cameras' world is 10 times the model's", kScale, shrunk_world<10>},
      {"the model's world is 1000 times the cameras', as millimetres", kScale, shrunk_world<1, 1000>},
      {"the model's world is 100 times the cameras', as centimetres", kScale, shrunk_world<1, 100>},
      {"the model's world is 10 times the cameras'", kScale, shrunk_world<1, 10>},
      {"the cameras' world is twice the model's", kScale, shrunk_world<2>},
      {"the model's world is twice the cameras'", kScale, shrunk_world<1, 2>},
      {"the focal length is twice the right one", kFocal, with_focal_length<1, 2>},
      {"the focal length is half of the right one", kFocal, with_focal_length<2>},
      {"the principal point is wrong", "write half of the photo's width and height",
       [](Camera c) {
         c.cx = c.width_px / 2.0;
         c.cy = c.height_px / 2.0;
         return c;
       }},
      {"the photos are turned by 180 degrees", "turn them back: mogrify -rotate 180 (ngs ignores EXIF orientation)",
       [](Camera c) { return negated_axes(std::move(c), true); }},
      {"the photos are mirrored", "mirror them back: mogrify -flop",
       [](Camera c) { return negated_axes(std::move(c), false); }}};
  return repairs;
}

namespace {

/// A command that renames columns of a PLY, so that they are read correctly.
std::string renamed(const std::vector<std::pair<const char*, const char*>>& columns) {
  std::string script;
  for (const auto& [from, to] : columns) script += std::string("s/ ") + from + "/ " + to + "/;";
  return "name them so: LC_ALL=C sed '1,/end_header/{" + script + "}' IN.ply > OUT.ply";
}

bool order_as_wxyz(GaussianCloud& cloud) {
  for (std::size_t i = 0; i < cloud.rotation.size(); i += 4)
    std::rotate(&cloud.rotation[i], &cloud.rotation[i] + 3, &cloud.rotation[i] + 4);
  return true;
}

bool invert_rotations(GaussianCloud& cloud) {
  for (std::size_t i = 0; i < cloud.rotation.size(); i += 4) cloud.rotation[i] = -cloud.rotation[i];
  return true;
}

bool take_colours(GaussianCloud& cloud) {
  for (float& c : cloud.sh_dc) c = dc_of_colour(c);
  return true;
}

bool take_opacities(GaussianCloud& cloud) {
  if (!std::ranges::all_of(cloud.logit_opacity, [](float v) { return v >= 0 && v <= 1; })) return false;
  for (float& v : cloud.logit_opacity) v = float(logit(double(v)));
  return true;
}

template <int kFactorOf1000, int kHalves = 0>
bool rescale(GaussianCloud& cloud) {
  for (float& s : cloud.log_scale) s = s * float(kFactorOf1000) / 1000 - float(kHalves) * 0.6931472f;
  return true;
}

bool negate_opacities(GaussianCloud& cloud) {
  for (float& v : cloud.logit_opacity) v = -v;
  return true;
}

/// Reorders SH coefficients that are stored as [band, colour] but were read as [colour, band].
bool order_by_colour(GaussianCloud& cloud) {
  const std::size_t bands = std::size_t(cloud.rest_count()), row = 3 * bands;
  for (std::size_t at = 0; at < cloud.sh_rest.size(); at += row) {
    const std::vector<float> from(&cloud.sh_rest[at], &cloud.sh_rest[at] + row);
    for (std::size_t k = 0; k < row; ++k) cloud.sh_rest[at + k] = from[k % bands * 3 + k / bands];
  }
  return bands > 0;
}

}  // namespace

const std::vector<ModelRepair>& model_repairs() {
  static constexpr const char* kNaturalLogarithms = "write natural logarithms of standard deviations";
  static const std::vector<ModelRepair> repairs{
      {"rot_0 to rot_3 of the splat hold x y z w",
       renamed({{"rot_0", "rot_x"}, {"rot_1", "rot_y"}, {"rot_2", "rot_z"}, {"rot_3", "rot_w"}}), order_as_wxyz},
      {"rot_0 to rot_3 of the splat are the inverse rotations", "negate rot_0", invert_rotations},
      {"f_dc_0 to f_dc_2 of the splat are colours, not coefficients of SH",
       renamed({{"f_dc_0", "red"}, {"f_dc_1", "green"}, {"f_dc_2", "blue"}}), take_colours},
      {"f_rest_* of the splat are red, green and blue of each band in turn", "write all of red, then green, then blue",
       order_by_colour},
      {"opacity of the splat is in 0..1, not a logit", "write log(opacity / (1 - opacity))", take_opacities},
      {"opacity of the splat has the wrong sign, as of transmittances", "negate it", negate_opacities, true},
      {"scale_* of the splat are logarithms to base 2", kNaturalLogarithms, rescale<693>, true},
      {"scale_* of the splat are logarithms to base 10", kNaturalLogarithms, rescale<2303>, true},
      {"scale_* of the splat are logarithms of variances", kNaturalLogarithms, rescale<500>, true},
      {"scale_* of the splat are logarithms of diameters", kNaturalLogarithms, rescale<1000, 1>, true}};
  return repairs;
}

}  // namespace ngs
