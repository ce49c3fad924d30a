#include "pictures.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/error.h"
#include "ngs/eval/eval_stage.h"
#include "ngs/io/image/image_file.h"
#include "ngs/ops/image/image_bytes.h"
#include "shared/page/html.h"
#include "shared/page/mask_sheet.h"

namespace ngs::cli {
namespace {

constexpr int kGivenWidthPx = 180;  // of input masks: small, since there are many

/// 0 outside the plane.
Plane cropped(const Plane& plane, const PixelWindow& win) {
  Plane out{win.w, win.h, {}, {}};
  if (plane.empty()) return out;
  for (int y = win.y0; y < win.y0 + win.h; ++y)
    for (int x = win.x0; x < win.x0 + win.w; ++x) {
      const bool inside = x >= 0 && y >= 0 && x < plane.width_px && y < plane.height_px;
      out.data.push_back(inside ? plane.data[std::size_t(y) * std::size_t(plane.width_px) + std::size_t(x)] : 0);
    }
  return out;
}

struct Layers {
  Plane input, truth, predicted;
};

std::string picture_html(const ImageF& picture, const Layers& layers, const PixelWindow& view_box,
                         const std::string& alt) {
  const auto outline = [](const char* kind, const Plane& plane) {
    return Outline{kind, plane.empty() ? MaskPlane{} : plane.view()};
  };
  return outlined_picture(
      to_bytes(picture),
      {outline("input", layers.input), outline("truth", layers.truth), outline("predicted", layers.predicted)},
      view_box, alt);
}

/// The photo, or a grey image of the masks' size.
ImageF photo_of(const ShownView& view, const Plane& reference) {
  if (!view.photo.empty()) return io::read_image_rgb(view.photo, view.behind);
  return ImageF(reference.width_px, reference.height_px, 3, 0.5f);
}

ImageF resized(const ImageF& image, int width_px, int height_px) {
  return width_px <= image.width_px ? io::resize_area(image, width_px, height_px)
                                    : io::resize_nearest(image, width_px, height_px);
}

std::string name_of(const ShownView& view) { return view.object.empty() ? view.view : view.view + ", " + view.object; }

std::string caption_of(const ShownView& view) {
  std::string text = "<b>" + escaped(name_of(view)) + "</b>";
  if (view.scores.is_null()) return text;
  text += " IoU " + decimal(number_at(view.scores, {"iou"}), 3) + ", boundary IoU " +
          decimal(number_at(view.scores, {"biou"}), 3);
  for (const char* flag : {"both_empty", "one_empty"})
    if (value_at(view.scores, {flag}) == Json(true))
      text += flag[0] == 'b' ? " <em>both masks are empty</em>" : " <em>one mask is empty</em>";
  return text;
}

Layers read_layers(const ShownView& view) {
  // If the input mask replaces the truth, draw it once.
  return {view.truth_is_input ? Plane{} : read_plane(view.input, view.input_id), read_truth(view),
          read_plane(view.predicted, view.predicted_id)};
}

Layers fitted(const Layers& layers, int width_px, int height_px) {
  return {fitted(layers.input, width_px, height_px), fitted(layers.truth, width_px, height_px),
          fitted(layers.predicted, width_px, height_px)};
}

const Plane& reference_of(const Layers& layers) {
  return !layers.truth.empty() ? layers.truth : !layers.predicted.empty() ? layers.predicted : layers.input;
}

/// The window of the given side with the most wrong pixels; among equals the middle one, which centres a small error.
PixelWindow worst_window(const Plane& predicted, const Plane& truth, int side_px) {
  const int w = truth.width_px, h = truth.height_px;
  const int side_x = std::min(side_px, w), side_y = std::min(side_px, h);
  std::vector<std::int64_t> sum(std::size_t(w + 1) * std::size_t(h + 1), 0);  // summed-area table of wrong pixels
  const auto at = [&](int x, int y) -> std::int64_t& {
    return sum[std::size_t(y) * std::size_t(w + 1) + std::size_t(x)];
  };
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(w) + std::size_t(x);
      at(x + 1, y + 1) = at(x, y + 1) + at(x + 1, y) - at(x, y) + ((predicted.data[i] != 0) != (truth.data[i] != 0));
    }
  const auto wrong_in = [&](int x, int y) {
    return at(x + side_x, y + side_y) - at(x, y + side_y) - at(x + side_x, y) + at(x, y);
  };
  PixelWindow best{0, 0, side_x, side_y};
  int left = 0, right = 0, bottom = 0;  // extent of equal windows; best is the topmost
  std::int64_t most = -1;
  for (int y = 0; y + side_y <= h; ++y)
    for (int x = 0; x + side_x <= w; ++x) {
      const std::int64_t wrong = wrong_in(x, y);
      if (wrong > most) {
        most = wrong;
        best.x0 = left = right = x;
        best.y0 = y;
      }
      if (wrong == most) {
        left = std::min(left, x);
        right = std::max(right, x);
        bottom = y;
      }
    }
  const PixelWindow middle{(left + right) / 2, (best.y0 + bottom) / 2, side_x, side_y};
  return wrong_in(middle.x0, middle.y0) == most ? middle : best;
}

ImageF cropped(const ImageF& image, const PixelWindow& win) {
  ImageF out(win.w, win.h, image.channels);
  out.data = ngs::cropped(image.data, image.width_px, image.channels, win);
  return out;
}

std::string sheet_figure(const ShownView& view, int width_px) {
  Layers layers = read_layers(view);
  const ImageF photo = photo_of(view, reference_of(layers));
  if (photo.empty()) return {};
  const int w = std::min(width_px, photo.width_px);
  const int h = std::max(1, int(std::lround(double(photo.height_px) * w / photo.width_px)));
  const std::string alt = "View " + name_of(view) + " with the outline of the predicted mask" +
                          (view.truth.empty() || view.truth_is_input ? "" : ", of the true mask") +
                          (view.input.empty() ? "" : ", of the input mask");
  return "<figure>" + picture_html(resized(photo, w, h), fitted(layers, w, h), {0, 0, w, h}, alt) + "<figcaption>" +
         caption_of(view) + "</figcaption></figure>\n";
}

std::string crop_figure(const ShownView& view, int side_px) {
  Layers layers = read_layers(view);
  if (layers.truth.empty() || layers.predicted.empty()) return {};
  const int w = layers.truth.width_px, h = layers.truth.height_px;
  layers = fitted(layers, w, h);
  const PixelWindow window = worst_window(layers.predicted, closest_truth(layers.truth, layers.predicted), side_px);
  // One more pixel on each side, so that no outline follows the border of the crop.
  const PixelWindow wider{window.x0 - 1, window.y0 - 1, window.w + 2, window.h + 2};
  const Layers parts{cropped(layers.input, wider), cropped(layers.truth, wider), cropped(layers.predicted, wider)};
  const ImageF photo = resized(photo_of(view, layers.truth), w, h);
  const std::string place = std::to_string(window.x0) + ", " + std::to_string(window.y0);
  const std::string alt = "Crop of view " + name_of(view) + " at pixel " + place + " where prediction and " +
                          (view.truth_is_input ? "input mask" : "truth") + " differ most";
  return "<figure class=crop>" + picture_html(cropped(photo, window), parts, {1, 1, window.w, window.h}, alt) +
         "<figcaption><b>" + escaped(name_of(view)) + "</b> " + std::to_string(window.w) + "×" +
         std::to_string(window.h) + " px at (" + place + ")</figcaption></figure>\n";
}

}  // namespace

bool Pictures::spend(std::size_t bytes) {
  if (double(spent_bytes_ + bytes) > options_.budget_mib * 1048576.0) return false;
  spent_bytes_ += bytes;
  return true;
}

std::string Pictures::sheet(RunFolder& run) {
  std::string html;
  std::size_t shown = 0;
  for (const ShownView& view : run.views) {
    std::string figure;
    try {
      figure = sheet_figure(view, options_.sheet_width_px);
    } catch (const Error& e) {
      run.problems.push_back(e.what());
    }
    if (!spend(figure.size())) break;
    html += figure;
    ++shown;
  }
  if (shown < run.views.size())
    html += "<p class=note>" + with_separators(std::int64_t(run.views.size() - shown)) +
            " better views are left out to keep the page small.</p>";
  return html;
}

std::string Pictures::given_masks(RunFolder& run) {
  if (!run.scene) return {};
  const double left_mib = options_.budget_mib - double(spent_bytes_) / 1048576.0;
  const MaskSheet sheet = mask_sheet(*run.scene, {kGivenWidthPx, std::max(0.0, left_mib)});
  run.problems.insert(run.problems.end(), sheet.problems.begin(), sheet.problems.end());
  spent_bytes_ += sheet.html.size();
  return sheet.html;
}

std::string Pictures::crops(RunFolder& run) {
  std::string html;
  int shown = 0;
  for (const ShownView& view : run.views) {
    if (shown == options_.zoomed_views) break;
    std::string figure;
    try {
      figure = crop_figure(view, options_.crop_side_px);
    } catch (const Error& e) {
      run.problems.push_back(e.what());
    }
    if (figure.empty() || !spend(figure.size())) continue;
    html += figure;
    ++shown;
  }
  return html;
}

Plane read_plane(const std::string& path, std::uint32_t id) {
  if (path.empty() || path.ends_with(".exr")) return {};
  const io::RawMask raw = io::read_mask_raw(path, id == 0 ? io::Palette::kMask : io::Palette::kIndices);
  const MaskSamples samples = raw.samples();
  Plane plane{raw.width_px, raw.height_px, {}, {}};
  if (id == 0 || (id != 255 && is_black_and_white(samples))) {
    plane.data = binarised(samples, kMaskThreshold);
    return plane;
  }
  plane.data.reserve(raw.data.size());
  for (std::uint32_t label : label_ids(samples)) plane.data.push_back(label == id);
  return plane;
}

Plane read_truth(const ShownView& view) {
  Plane truth = read_plane(view.truth, view.truth_id);
  if (truth.empty() || view.truth_id == 0 || view.void_id < 0) return truth;
  const io::RawMask raw = io::read_mask_raw(view.truth, io::Palette::kIndices);
  for (std::uint32_t label : label_ids(raw.samples())) truth.is_void.push_back(std::int64_t(label) == view.void_id);
  return truth;
}

Plane closest_truth(Plane truth, const Plane& predicted) {
  for (std::size_t i = 0; i < truth.is_void.size(); ++i)
    if (truth.is_void[i]) truth.data[i] = predicted.data[i];
  return truth;
}

Plane fitted(const Plane& plane, int width_px, int height_px) {
  if (plane.empty() || (plane.width_px == width_px && plane.height_px == height_px)) return plane;
  const auto resized = [&](const std::vector<std::uint8_t>& data) {
    return resized_nearest(data.data(), plane.width_px, plane.height_px, width_px, height_px);
  };
  return {width_px, height_px, resized(plane.data), plane.is_void.empty() ? plane.is_void : resized(plane.is_void)};
}

}  // namespace ngs::cli
