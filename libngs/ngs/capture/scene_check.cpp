#include "ngs/capture/scene_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/backend/for_each.h"
#include "ngs/capture/mask_check.h"
#include "ngs/capture/uniform_masks.h"
#include "ngs/capture/view_shares.h"
#include "ngs/core/error.h"
#include "ngs/core/formatted.h"
#include "ngs/problem/view_list.h"
#include "ngs/render/render_options.h"
#include "ngs/scene/resize.h"

namespace ngs {
namespace {

constexpr double kLowestInside = 0.01;

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

/// A photo and its camera at the size of the comparison.
struct Shot {
  std::size_t view = 0;
  Camera camera;
  ImageF photo;
};

Shot take_shot(const Scene& scene, std::size_t view, int longest_px, const ImageF& photo) {
  const Camera& camera = scene.views[view].camera;
  const int factor = (std::max(camera.width_px, camera.height_px) + longest_px - 1) / longest_px;
  return {view, shrunk(camera, factor), shrunk(photo, factor)};
}

std::vector<Shot> take_shots(Monitor& monitor, const SceneCheckOptions& options, const Scene& scene,
                             const SceneLoaders& loaders) {
  const auto timed = monitor.scope("photos");
  const std::vector<std::size_t> with_photo = photo_views(scene);
  std::vector<Shot> shots;
  const std::vector<std::size_t> compared = evenly_spaced(std::size_t(options.check_views), with_photo.size());
  for (const std::size_t i : compared) {
    shots.push_back(take_shot(scene, with_photo[i], options.check_size_px, loaders.photo(with_photo[i])));
    monitor.progress(std::int64_t(shots.size()), std::int64_t(compared.size()));
  }
  return shots;
}

// The size at which the model was fitted is not known yet (filter_probe.h). The low-pass filter of 0.3 px² is right at
// that size. In a much smaller image only the pixel's own area, about 1/12 px², remains, and 0.3 px² would blur the
// model.
constexpr double kFilters[] = {0.3, 0.075};
// With a gain this far above min_fit_db the second filter is not tried.
constexpr double kEnoughAbove_db = 3;

std::string decibels(double value) {
  return formatted("%.1f dB", std::round(value * 10) / 10 + 0.0);  // no "-0.0"
}

constexpr const char* kGsplatRemedy = "with the rules of gsplat, whose near plane is nearer: --compat gsplat";
constexpr const char* kSmallWorldRemedy = "with near planes scaled to this small world: import it with --compat auto";
constexpr double kSomeTooNear = 0.01;  // share of the Gaussians above which other near planes are tried
constexpr double kManyTooNear = 0.1;   // the same without photos
constexpr double kNearPlaneGain_db = 0.5;
constexpr double kEqual_db = 0.1;  // renderers whose gains differ by less are equally good
// Minimum gain in each photo. Every repair worsens correct models. Gains on wrong models: order x y z w 5 dB (flower)
// and 7 dB (lego), exchanged bands 3 dB; 0.4 dB on photos so noisy that correct models have 4 dB.
constexpr double kRepairGain_db = 0.3;
constexpr double kPartial = 0.5;  // covered share of the photos below which the model may be cropped

/// Compares a model with photos of its scene.
class PhotoCheck {
 public:
  PhotoCheck(const Exec& exec, Monitor& monitor, const SceneCheckOptions& options, const GaussianCloud& cloud,
             const Scene& scene)
      : exec_(exec),
        monitor_(monitor),
        options_(options),
        cloud_(cloud),
        scene_(scene),
        splat_(prepared_for(exec, splat_options({}, cloud, scene), cloud)) {}

  /// Records how well each photo is matched, and warns; throws if the median match is too low.
  void check(const std::vector<Shot>& shots, bool compat_is_default, SceneCheck& result) {
    compare(shots, result);
    std::vector<Camera> cameras;
    for (const Shot& shot : shots) cameras.push_back(shot.camera);
    const double too_near = share_too_near(cloud_, cameras, near_plane(splat_.compat) * splat_.world_unit);
    if (too_near > kSomeTooNear) try_near_planes(shots, cameras, compat_is_default, result);
    if (!(result.median_fit_db >= options_.min_fit_db)) refuse(shots, result);
    if (const ModelRepair* repair = repair_of_model(shots, result))
      result.warnings.push_back("the model explains the photos better if " + repair->mistake + ": " + repair->remedy);
    for (const Shot& shot : shots)
      if (const PhotoMatch& match = *result.views[shot.view].match; match.gain_db() < options_.min_fit_db)
        result.warnings.push_back("view " + scene_.views[shot.view].camera.name +
                                  ": the model explains its photo only " + decibels(match.gain_db()) +
                                  " better than a constant colour (" + decibels(match.psnr_db) + ")");
  }

 private:
  void compare(const std::vector<Shot>& shots, SceneCheck& result) {
    const auto timed = monitor_.scope("compare");
    std::vector<double> gains, psnrs;
    for (const Shot& shot : shots) {
      const PhotoMatch match = best_match({shot.camera, shot.photo});
      gains.push_back(match.gain_db());
      psnrs.push_back(match.psnr_db);
      result.views[shot.view].match = match;
      monitor_.progress(std::int64_t(psnrs.size()), std::int64_t(shots.size()));
    }
    result.median_fit_db = median(gains);
    result.median_psnr_db = median(psnrs);
  }

  /// A renderer that might have made the photos.
  struct Renderer {
    Compat compat = Compat::kInria;
    double world_unit = 1;
    double gain_db = 0;  // median

    bool is_small() const { return world_unit < 1; }
  };

  /// The renderers whose near planes are nearer than the scene's: 3DGS in a smaller world, gsplat, gsplat in that
  /// world.
  std::vector<Renderer> nearer_renderers(const std::vector<Shot>& shots, const std::vector<Camera>& cameras) const {
    const double unit = std::min(splat_.world_unit, model_world_unit(cloud_, cameras));
    std::vector<Renderer> tried;
    const double near_z = near_plane(splat_.compat) * splat_.world_unit;
    for (const Renderer& r : {Renderer{Compat::kInria, unit}, Renderer{Compat::kGsplat, splat_.world_unit},
                              Renderer{Compat::kGsplat, unit}})
      if (near_plane(r.compat) * r.world_unit < near_z && std::ranges::none_of(tried, [&](const Renderer& t) {
            return t.compat == r.compat && t.world_unit == r.world_unit;
          }))
        tried.push_back({r.compat, r.world_unit, gain_by(r, shots)});
    return tried;
  }

  /// Part of the model is nearer than the near plane: tests whether a nearer one matches the photos better.
  void try_near_planes(const std::vector<Shot>& shots, const std::vector<Camera>& cameras, bool compat_is_default,
                       SceneCheck& result) {
    tried_ = nearer_renderers(shots, cameras);
    const auto highest = std::ranges::max_element(tried_, {}, &Renderer::gain_db);
    const auto best = std::ranges::find_if(  // the first of equal ones: a scaled world keeps the rules of 3DGS
        tried_, [&](const Renderer& r) { return r.gain_db > highest->gain_db - kEqual_db; });
    if (best == tried_.end() || !(best->gain_db - result.median_fit_db > kNearPlaneGain_db)) return;
    const std::string better =
        "the model explains the photos " + decibels(best->gain_db - result.median_fit_db) + " better ";
    if (!compat_is_default) {
      result.warnings.push_back(better + (best->is_small() ? kSmallWorldRemedy : kGsplatRemedy));
      return;
    }
    result.compat = splat_.compat = best->compat;
    result.world_unit = splat_.world_unit = best->world_unit;
    const std::string rules = best->compat == Compat::kGsplat ? "gsplat" : "3DGS";
    result.warnings.push_back(better + (best->is_small()
                                            ? "with near planes scaled to this small world and the rules of " + rules +
                                                  ": they are used (--compat inria or gsplat: "
                                                  "near planes of 0.2 or 0.01)"
                                            : "with the rules of gsplat, whose near plane is nearer: they "
                                              "are used (--compat inria: those of 3DGS)"));
    compare(shots, result);
  }

  SplatOptions with_filter(double filter_px2) const {
    SplatOptions out = splat_;
    out.blur_px2 = filter_px2;
    return out;
  }

  PhotoMatch best_match(const PhotoView& view) const {
    PhotoMatch best;
    for (const double filter : kFilters) {
      if (filter != kFilters[0] && best.gain_db() >= options_.min_fit_db + kEnoughAbove_db) break;
      const PhotoMatch match = match_photo(exec_, cloud_, view, with_filter(filter));
      if (filter == kFilters[0] || match.psnr_db > best.psnr_db) best = match;
    }
    return best;
  }

  /// `repair` is applied to the cameras; null: none.
  double median_gain(const std::vector<Shot>& shots, const std::function<Camera(Camera)>& repair) const {
    std::vector<double> gains;
    for (const Shot& shot : shots)
      gains.push_back(best_match({repair ? repair(shot.camera) : shot.camera, shot.photo}).gain_db());
    return median(gains);
  }

  double gain_by(const Renderer& renderer, const std::vector<Shot>& shots) const {
    PhotoCheck other = *this;
    other.splat_.compat = renderer.compat;
    other.splat_.world_unit = renderer.world_unit;
    return other.median_gain(shots, nullptr);
  }

  static std::vector<Shot> few_of(const std::vector<Shot>& shots) {
    constexpr std::size_t kShots = 3;
    std::vector<Shot> few;
    for (const std::size_t i : evenly_spaced(kShots, shots.size())) few.push_back(shots[i]);
    return few;
  }

  /// The repair that makes the model fit a few of the shots; null if none does.
  const PoseRepair* find_repair(const std::vector<Shot>& shots) {
    const auto timed = monitor_.scope("pose repairs");
    const std::vector<Shot> few = few_of(shots);
    const PoseRepair* best = nullptr;
    double best_gain = options_.min_fit_db;
    for (const PoseRepair& repair : pose_repairs()) {
      const double gain = median_gain(few, repair.apply);
      if (gain > best_gain) {
        best = &repair;
        best_gain = gain;
      }
    }
    return best;
  }

  /// The repair of the model after which it fits, and better in each of a few shots; null: none.
  const ModelRepair* repair_of_model(const std::vector<Shot>& shots, const SceneCheck& result) const {
    const auto timed = monitor_.scope("model repairs");
    const ModelRepair* best = nullptr;
    const bool is_fit = result.median_fit_db >= options_.min_fit_db;
    double best_gain = kRepairGain_db;
    for (const ModelRepair& repair : model_repairs()) {
      GaussianCloud mended = cloud_;
      if ((repair.if_unfit && is_fit) || !repair.apply(mended)) continue;
      classify(mended);
      PhotoCheck other(exec_, monitor_, options_, mended, scene_);
      other.splat_ = splat_;
      double least = std::numeric_limits<double>::infinity();
      for (const Shot& shot : few_of(shots))
        if (least > best_gain)
          least =
              std::min(least, other.best_match({shot.camera, shot.photo}).gain_db() -
                                  std::max(result.views[shot.view].match->gain_db(), options_.min_fit_db - best_gain));
      if (least > best_gain) {
        best = &repair;
        best_gain = least;
      }
    }
    return best;
  }

  /// Photos of other views, or with other channels, that the model explains; empty: none.
  std::string repair_of_photos(const std::vector<Shot>& shots) const {
    const std::ptrdiff_t count = std::ssize(scene_.views);
    for (const std::ptrdiff_t step : {1, -1}) {
      std::vector<Shot> moved;
      for (const Shot& shot : shots) {
        const Camera& other = scene_.views[std::size_t((std::ptrdiff_t(shot.view) + step + count) % count)].camera;
        const int factor = std::max(1, other.width_px / shot.photo.width_px);
        if (other.width_px / factor == shot.photo.width_px && other.height_px / factor == shot.photo.height_px)
          moved.push_back({shot.view, shrunk(other, factor), shot.photo});
      }
      if (!moved.empty() && median_gain(moved, nullptr) >= options_.min_fit_db)
        return std::string("the photos are those of the ") + (step > 0 ? "next" : "previous") +
               " views: their names are shifted by one against the cameras, rename them";
    }
    std::vector<Shot> exchanged = shots;
    for (Shot& shot : exchanged)
      for (std::size_t i = 0; i < shot.photo.data.size(); i += 3) std::swap(shot.photo.data[i], shot.photo.data[i + 2]);
    if (median_gain(exchanged, nullptr) < options_.min_fit_db) return {};
    return "it fits if red and blue of the photos are exchanged: save them again as RGB";
  }

  /// The median gain after a gain and an offset per channel. `views` contains the matches of the shots.
  double median_recoloured_gain(const std::vector<Shot>& shots, const std::vector<ViewCheck>& views) const {
    std::vector<double> gains;
    for (const Shot& shot : shots) {
      double best = 0;  // a gain of zero
      for (const double filter : kFilters)
        best = std::max(best, recoloured_gain_db(exec_, cloud_, {shot.camera, shot.photo}, with_filter(filter),
                                                 *views[shot.view].match));
      gains.push_back(best);
    }
    return median(gains);
  }

  /// Median over the shots, in the pixels that the model covers.
  double covered_gain(const std::vector<Shot>& shots) const {
    std::vector<double> gains;
    for (const Shot& shot : shots) gains.push_back(covered_gain_db(exec_, cloud_, {shot.camera, shot.photo}, splat_));
    return median(gains);
  }

  /// Hint for a model that does not fit the photos.
  std::string remedy(const std::vector<Shot>& shots, const SceneCheck& result) {
    constexpr double kPlain_db = 60;  // of a constant colour; photos have 10 to 30
    const std::vector<ViewCheck>& views = result.views;
    std::string fits;
    for (const bool small : {false, true})
      if (std::ranges::any_of(
              tried_, [&](const Renderer& r) { return r.is_small() == small && r.gain_db >= options_.min_fit_db; }))
        fits += std::string(fits.empty() ? "it fits " : ", or ") + (small ? kSmallWorldRemedy : kGsplatRemedy);
    if (!fits.empty()) return fits;
    if (result.median_psnr_db - result.median_fit_db > kPlain_db)
      return "the photos have one colour each: give those that the cameras and the model were made from";
    if (std::string other = repair_of_photos(shots); !other.empty()) return other;
    const SceneCheckOptions::WorldFile world = options_.world_transform();
    if (world.apply && median_gain(shots, world.apply) >= options_.min_fit_db)
      return "it fits if the cameras are brought to the model's world: import with --world-transform " + world.word;
    if (const PoseRepair* repair = find_repair(shots)) return "it fits if " + repair->mistake + ": " + repair->remedy;
    if (const ModelRepair* repair = repair_of_model(shots, result))
      return "it fits if " + repair->mistake + ": " + repair->remedy;
    if (const double recoloured_db = median_recoloured_gain(shots, views); recoloured_db >= options_.min_fit_db)
      return "the poses fit, the colours do not: with a gain and an offset per channel it is " +
             decibels(recoloured_db) +
             " above it; give the photos that the model was trained on, or import these with --min-fit-db -100";
    const double covered = views[shots[0].view].match->covered;
    if (covered < kPartial && covered_gain(shots) >= options_.min_fit_db)
      return "it covers only " + percent(covered) +
             " of the photos and fits them there: if it is a part of the scene, " +
             "as after a cut in an editor, import it with --min-fit-db -100";
    return "the model is of another scene or other poses, or its world was moved or scaled after training; "
           "import the cameras it was trained with (a splat exported by nerfstudio: with --world-transform " +
           world.word + ", and --original-world if transforms.json has an applied_transform)";
  }

  [[noreturn]] void refuse(const std::vector<Shot>& shots, const SceneCheck& result) {
    throw Error(ErrorCode::kInconsistent,
                "cameras and model: rendered views match the photos " + decibels(result.median_psnr_db) + ", " +
                    decibels(result.median_fit_db) + " above a constant colour (" + percent(result.median_inside) +
                    " of the Gaussians in view), expected at least " + decibels(options_.min_fit_db) + " above it",
                remedy(shots, result));
  }

  const Exec& exec_;
  Monitor& monitor_;
  const SceneCheckOptions& options_;
  const GaussianCloud& cloud_;
  const Scene& scene_;
  SplatOptions splat_;           // the scene's options for its model
  std::vector<Renderer> tried_;  // empty unless part of the model is nearer than the near plane
};

/// Without photos only distances show that the near plane would remove the model.
void scale_near_plane(const SceneCheckInputs& in, SceneCheck& result) {
  std::vector<Camera> cameras;
  for (const std::size_t v : evenly_spaced(16, in.scene.views.size())) cameras.push_back(in.scene.views[v].camera);
  const double near_z = near_plane(in.scene.compat) * in.scene.world_unit;
  const double too_near = share_too_near(*in.cloud, cameras, near_z);
  const double unit = model_world_unit(*in.cloud, cameras);
  if (!(too_near > kManyTooNear) || !(unit < in.scene.world_unit)) return;
  result.world_unit = unit;
  result.warnings.push_back(percent(too_near) +
                            " of the model is nearer to the cameras than the near plane: near planes are scaled to "
                            "this small world (--compat inria or gsplat: near planes of 0.2 or 0.01)");
}

void check_inside_only(const SceneCheck& result) {
  if (result.median_inside >= kLowestInside) return;
  throw Error(ErrorCode::kInconsistent,
              "cameras and model: " + percent(result.median_inside) +
                  " of the Gaussians lie inside the median view, expected at least 1 %",
              "poses are world-to-camera with x right, y down, z forward; with photos (--images DIR) the likely "
              "mistake is detected");
}

void check_cloud(const Exec& exec, Monitor& monitor, const SceneCheckOptions& options, const SceneCheckInputs& in,
                 SceneCheck& result) {
  const GaussianCloud& cloud = *in.cloud;
  const Scene& scene = in.scene;
  const std::vector<std::int64_t> sample = sample_usable(cloud);
  if (sample.empty())
    throw Error(ErrorCode::kNothingFound, scene.model_path + ": no usable Gaussian, expected at least one finite row");
  result.sampled_gaussians = std::int64_t(sample.size());
  {
    const auto timed = monitor.scope("project");
    for_each_task(exec, std::int64_t(scene.views.size()), [&](std::int64_t i) {
      const ViewShares shares = view_shares(cloud, scene.views[std::size_t(i)].camera, sample);
      result.views[std::size_t(i)].in_front = shares.in_front;
      result.views[std::size_t(i)].inside = shares.inside;
    });
  }
  std::vector<double> inside;
  for (const ViewCheck& view : result.views) inside.push_back(view.inside);
  result.median_inside = median(inside);
  const std::vector<Shot> shots = take_shots(monitor, options, scene, in.loaders);
  if (shots.empty()) {
    check_inside_only(result);
    if (in.compat_is_default) scale_near_plane(in, result);
  } else {
    PhotoCheck(exec, monitor, options, cloud, scene).check(shots, in.compat_is_default, result);
  }
}

}  // namespace

SceneCheck check_scene(const Exec& exec, Monitor& monitor, const SceneCheckOptions& options,
                       const SceneCheckInputs& in) {
  SceneCheck result;
  result.compat = in.scene.compat;
  result.world_unit = in.scene.world_unit;
  result.views.resize(in.scene.views.size());
  if (in.cloud != nullptr) check_cloud(exec, monitor, options, in, result);
  check_masks(monitor, {in.scene, in.loaders, options.check_polarity}, result);
  find_uniform_masks(exec, monitor, {in.cloud, in.scene, in.loaders}, result);
  return result;
}

}  // namespace ngs
