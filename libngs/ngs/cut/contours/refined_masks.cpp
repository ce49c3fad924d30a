#include "ngs/cut/contours/refined_masks.h"

#include <algorithm>
#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/ops/image/mask_pair.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/problem/scene_measures.h"
#include "ngs/problem/view_list.h"
#include "ngs/render/render_stage.h"
#include "ngs/scene/mask_threshold.h"
#include "ngs/scene/resize.h"

namespace ngs {
namespace {

/// Resizes to [h, w] by means over the area of every coarse pixel. The ratio of the sizes may be fractional.
std::vector<float> reduce(const std::vector<float>& fine, int fw, int fh, int w, int h) {
  std::vector<float> rows(std::size_t(w) * std::size_t(fh)), out(std::size_t(w) * std::size_t(h));
  const auto along = [](int n, int coarse, const auto& from, const auto& to) {
    const double step = double(n) / coarse;
    for (int i = 0; i < coarse; ++i) {
      const double lo = i * step, hi = (i + 1) * step;
      double sum = 0;
      for (int j = int(lo); j < std::min(n, int(std::ceil(hi))); ++j)
        sum += from(j) * (std::min(hi, j + 1.0) - std::max(lo, double(j)));
      to(i, float(sum / step));
    }
  };
  for (int y = 0; y < fh; ++y)
    along(
        fw, w, [&](int x) { return double(fine[std::size_t(y) * std::size_t(fw) + std::size_t(x)]); },
        [&](int x, float v) { rows[std::size_t(y) * std::size_t(w) + std::size_t(x)] = v; });
  for (int x = 0; x < w; ++x)
    along(
        fh, h, [&](int y) { return double(rows[std::size_t(y) * std::size_t(w) + std::size_t(x)]); },
        [&](int y, float v) { out[std::size_t(y) * std::size_t(w) + std::size_t(x)] = v; });
  return out;
}

/// Boundary IoU of a mask at the camera's size with the view's own mask of one object, over the known pixels.
double agreement(const std::vector<float>& mask, const ViewMasks& own, int band_px) {
  std::vector<std::uint8_t> a(mask.size()), b(mask.size());
  for (std::size_t p = 0; p < mask.size(); ++p) {
    const bool known = own.known.empty() || own.known[p];
    a[p] = known && mask_is_foreground(mask[p]);
    b[p] = known && mask_is_foreground(own.target[0][p]);
  }
  Exec serial;
  const int w = own.width_px, h = own.height_px;
  return boundary_iou(serial, chessboard_distance({a.data(), w, h}), chessboard_distance({b.data(), w, h}), w, band_px);
}

/// The mask at another size, thresholded after bilinear interpolation.
std::vector<std::uint8_t> enlarged_mask(const std::vector<float>& coarse, int w, int h, int fw, int fh) {
  std::vector<std::uint8_t> out(std::size_t(fw) * std::size_t(fh));
  for (int y = 0; y < fh; ++y)
    for (int x = 0; x < fw; ++x) {
      const double u = std::clamp((x + 0.5) * w / fw - 0.5, 0.0, w - 1.0),
                   v = std::clamp((y + 0.5) * h / fh - 0.5, 0.0, h - 1.0);
      const int x0 = int(u), y0 = int(v), x1 = std::min(x0 + 1, w - 1), y1 = std::min(y0 + 1, h - 1);
      const auto at = [&](int a, int b) { return double(coarse[std::size_t(b) * std::size_t(w) + std::size_t(a)]); };
      const double top = at(x0, y0) + (u - x0) * (at(x1, y0) - at(x0, y0)),
                   bottom = at(x0, y1) + (u - x0) * (at(x1, y1) - at(x0, y1));
      out[std::size_t(y) * std::size_t(fw) + std::size_t(x)] = top + (v - y0) * (bottom - top) >= kHalfShare;
    }
  return out;
}

void add_differences(const std::vector<float>& own, const std::vector<float>& refined, RefinedView& out) {
  for (std::size_t p = 0; p < own.size(); ++p) {
    const bool own_mask = mask_is_foreground(own[p]), other_mask = mask_is_foreground(refined[p]);
    out.beyond_px2 += own_mask && !other_mask;
    out.short_px2 += other_mask && !own_mask;
  }
}

/// A crop about one object, at the camera's size and at the photo's.
struct ObjectCrop {
  PixelWindow coarse, fine;
};

/// A crop about the rendered mask [fine] and the view's own mask [coarse; may be empty], with the reach of the
/// refinement and a few pixels more. Outside the crop neither mask shows the object, so no sum changes. The crop is the
/// whole image if the size ratio is not 1, 2 or 4, because crop positions would need rounding.
ObjectCrop crop_about(const ForegroundBox& rendered, const std::vector<float>& own, const Camera& camera,
                      const ImageF& photo, double reach_px) {
  constexpr double kMargin_px = 8;
  const int w = camera.width_px, h = camera.height_px, scale = photo.width_px / w;
  const PixelWindow all{0, 0, w, h}, all_fine{0, 0, photo.width_px, photo.height_px};
  if ((scale != 1 && scale != 2 && scale != 4) || photo.width_px != scale * w || photo.height_px != scale * h)
    return {all, all_fine};
  ForegroundBox shown = own.empty() ? ForegroundBox{} : foreground_box(own, w, h);
  if (!rendered.empty())
    shown.add({rendered.x0 / scale, rendered.y0 / scale, (rendered.x1 - 1) / scale + 1, (rendered.y1 - 1) / scale + 1});
  const double margin_px = std::min(reach_px / scale + kMargin_px, double(w + h));
  const PixelWindow at = window_about(shown, int(std::ceil(margin_px)), w, h);
  return {at, {at.x0 * scale, at.y0 * scale, at.w * scale, at.h * scale}};
}

/// A cropped mask at the camera's size.
struct CroppedMask {
  PixelWindow at;
  std::vector<float> plane;  // [at.h, at.w]
};

ForegroundBox box_of(const CroppedMask& part) {
  const ForegroundBox box = foreground_box(part.plane, part.at.w, part.at.h);
  return {box.x0 + part.at.x0, box.y0 + part.at.y0, box.x1 + part.at.x0, box.y1 + part.at.y0};
}

/// The mask in a window, [win.h, win.w].
std::vector<float> plane_of(const CroppedMask& part, const PixelWindow& win) {
  std::vector<float> plane(std::size_t(win.w) * std::size_t(win.h));
  const int x0 = std::max(part.at.x0, win.x0), x1 = std::min(part.at.x0 + part.at.w, win.x0 + win.w);
  const int y0 = std::max(part.at.y0, win.y0), y1 = std::min(part.at.y0 + part.at.h, win.y0 + win.h);
  for (int y = y0; y < y1 && x0 < x1; ++y)
    std::copy_n(part.plane.begin() + std::ptrdiff_t(y - part.at.y0) * part.at.w + (x0 - part.at.x0), x1 - x0,
                plane.begin() + std::ptrdiff_t(y - win.y0) * win.w + (x0 - win.x0));
  return plane;
}

/// Refines the mask of one object of a view and adds the comparison to a RefinedView.
class ObjectRefinement {
 public:
  ObjectRefinement(const ContourRefineOptions& refine, const ImageF& photo, const Camera& camera, RefinedView& out)
      : refine_(refine), photo_(photo), camera_(camera), out_(out) {}

  /// Refines the mask of object k. `label` [fine, K]: rendered masks; `shown`: box of object k in it; `own` [coarse]:
  /// the view's own mask of object k, if available. The agreement with it counts 1 / K of the view's.
  CroppedMask refined(const ImageF& label, std::size_t k, const ForegroundBox& shown, const ViewMasks& own) {
    const double objects = label.channels;
    const auto [at, fine] = crop_about(shown, own.available ? own.target[0] : std::vector<float>(), camera_, photo_,
                                       std::max(refine_.reach_px, refine_.band_px));
    if (fine.w == 0) {
      if (own.available) {
        out_.rendered_biou += 1 / objects;
        out_.refined_biou += 1 / objects;
      }
      return {};
    }
    std::vector<std::uint8_t> mask;
    mask.reserve(std::size_t(fine.w) * std::size_t(fine.h));
    for (int y = fine.y0; y < fine.y0 + fine.h; ++y)
      for (int x = fine.x0; x < fine.x0 + fine.w; ++x) mask.push_back(label_is_foreground(label.at(x, y, int(k))));
    ImageF photo(fine.w, fine.h, 0);
    photo.data = cropped(photo_.data, photo_.width_px, photo_.channels, fine);
    photo.channels = photo_.channels;
    std::vector<float> soft = refine_contour(refine_, {mask.data(), fine.w, fine.h}, photo);
    for (float& x : soft) x = label_is_foreground(x) ? 1.f : 0.f;
    std::vector<float> target = reduce(soft, fine.w, fine.h, at.w, at.h);
    if (own.available) compare(mask, soft, target, {cropped(own, at), photo, objects});
    return {at, std::move(target)};
  }

 private:
  struct Own {
    ViewMasks masks;
    const ImageF& photo;
    double objects;
  };

  void compare(const std::vector<std::uint8_t>& rendered, const std::vector<float>& refined,
               const std::vector<float>& target, const Own& own) {
    const int w = own.masks.width_px, h = own.masks.height_px, fw = own.photo.width_px, fh = own.photo.height_px;
    const int band_px = band_width_px(0.005, camera_.width_px, camera_.height_px);
    out_.own_contrast += contour_contrast(enlarged_mask(own.masks.target[0], w, h, fw, fh), own.photo);
    out_.refined_contrast += contour_contrast({refined.begin(), refined.end()}, own.photo);
    out_.rendered_contrast += contour_contrast(rendered, own.photo);
    out_.rendered_biou +=
        agreement(reduce({rendered.begin(), rendered.end()}, fw, fh, w, h), own.masks, band_px) / own.objects;
    out_.refined_biou += agreement(target, own.masks, band_px) / own.objects;
    add_differences(own.masks.target[0], target, out_);
  }

  const ContourRefineOptions& refine_;
  const ImageF& photo_;
  const Camera& camera_;
  RefinedView& out_;
};

RefinedView refine_view(const RefineSetup& setup, const PreparedModel& model, std::size_t v, bool compare) {
  const Problem& input = setup.problem;
  const Camera& camera = input.scene.views[v].camera;
  ImageF photo = input.load_fine_photo(v);
  if (photo.empty()) return {};
  const int w = camera.width_px, h = camera.height_px;
  RefinedView out;
  out.detail = double(photo.width_px) / w;
  ContourRefineOptions refine = setup.refine;
  if (out.detail < setup.detail) {
    photo = enlarged(photo, setup.detail * w, setup.detail * h);
    refine.band_px *= setup.detail / out.detail;
    refine.reach_px *= setup.detail / out.detail;
  }
  const int fw = photo.width_px, fh = photo.height_px;
  const ImageF label =
      model.labels.masks(model.exec, resized(camera, fw, fh), filter_at_scale(model.splat, double(fw) / w));
  ViewMasks own = compare ? input.load_masks(v) : ViewMasks{};
  const std::size_t objects = model.labels.objects();
  out.compared = own.available;
  ObjectRefinement refinement(refine, photo, camera, out);
  const std::vector<ForegroundBox> boxes = foreground_boxes(label);
  std::vector<CroppedMask> targets(objects);
  ForegroundBox shown;
  for (std::size_t k = 0; k < objects; ++k) {
    ViewMasks one{own.width_px, own.height_px, {}, own.known, own.available};
    if (own.available) one.target.push_back(std::move(own.target[k]));
    targets[k] = refinement.refined(label, k, boxes[k], one);
    shown.add(box_of(targets[k]));
  }
  out.window = window_about(shown, int(std::lround(setup.margin_px)), w, h);
  ViewMasks masks{out.window.w, out.window.h, {}, {}, out.window.w > 0};
  for (const CroppedMask& target : targets) masks.target.push_back(plane_of(target, out.window));
  out.masks = RleMasks(std::move(masks));
  return out;
}

}  // namespace

double contour_contrast(const std::vector<std::uint8_t>& mask, const ImageF& photo) {
  const int w = photo.width_px, h = photo.height_px;
  double sum = 0, count = 0;
  const auto add = [&](int x, int y, int dx, int dy) {
    const auto in = [&](int a, int b) { return mask[std::size_t(b) * std::size_t(w) + std::size_t(a)] != 0; };
    if (in(x, y) == in(x + dx, y + dy)) return;
    double difference = 0;
    for (int c = 0; c < photo.channels; ++c)
      difference += std::abs(double(photo.at(x - dx, y - dy, c)) - double(photo.at(x + 2 * dx, y + 2 * dy, c)));
    sum += difference;
    ++count;
  };
  for (int y = 1; y < h - 2; ++y)
    for (int x = 1; x < w - 2; ++x) {
      add(x, y, 1, 0);
      add(x, y, 0, 1);
    }
  return count > 0 ? sum / count : 0;
}

std::vector<RefinedView> refine_views(const Exec& exec, const RefineSetup& setup, const LabelledModel& model,
                                      const std::vector<std::size_t>& views, const std::vector<std::size_t>& compared) {
  const std::size_t count = setup.problem.scene.views.size();
  std::vector<RefinedView> refined(count);
  std::vector<std::uint8_t> compare(count, 0);
  for (const std::size_t v : compared) compare[v] = 1;
  const PreparedModel prepared(exec, setup.problem.splat, model);
  for_each_task(exec, std::int64_t(views.size()), [&](std::int64_t i) {
    if (stop_requested(setup.problem.monitor)) return;
    const std::size_t v = views[std::size_t(i)];
    refined[v] = refine_view(setup, prepared, v, compare[v] != 0);
  });
  return refined;
}

ViewMasks uncropped_masks(const RefinedView& refined, int w, int h) {
  const PixelWindow& win = refined.window;
  const ViewMasks parts = refined.masks.unpacked();
  ViewMasks masks{w, h, {}, {}, parts.available};
  for (const std::vector<float>& part : parts.target) {
    std::vector<float>& target = masks.target.emplace_back(std::size_t(w) * std::size_t(h));
    for (int y = 0; y < win.h; ++y)
      std::copy_n(part.begin() + std::ptrdiff_t(y) * win.w, win.w,
                  target.begin() + (std::ptrdiff_t(win.y0 + y) * w + win.x0));
  }
  return masks;
}

bool could_enlarge(const std::vector<RefinedView>& refined, int detail) {
  return std::any_of(refined.begin(), refined.end(),
                     [&](const RefinedView& view) { return view.compared && view.detail < detail; });
}

std::vector<double> gains_over(const std::vector<RefinedView>& refined, const std::vector<RefinedView>& other) {
  std::vector<double> gains;
  for (std::size_t v = 0; v < refined.size(); ++v)
    if (refined[v].compared && other[v].compared) gains.push_back(refined[v].refined_biou - other[v].refined_biou);
  return gains;
}

bool masks_misaligned(const std::vector<RefinedView>& refined) {
  double own = 0, all = 0;
  for (const RefinedView& view : refined) {
    own += view.own_contrast;
    all += view.refined_contrast;
  }
  return own < kOffEdges * all;
}

bool masks_err_to_one_side(const std::vector<RefinedView>& refined) {
  double beyond = 0, lacking = 0;
  for (const RefinedView& view : refined) {
    beyond += view.beyond_px2;
    lacking += view.short_px2;
  }
  return std::abs(beyond - lacking) > kOneSided * (beyond + lacking);
}

double mask_agreement_gain(const std::vector<RefinedView>& refined) {
  if (masks_misaligned(refined) && masks_err_to_one_side(refined)) return 0;
  std::vector<double> gains;
  for (const RefinedView& view : refined)
    if (view.compared) gains.push_back(view.refined_biou - view.rendered_biou);
  return normal_score(gain_in_standard_errors(gains), gains.size());
}

}  // namespace ngs
