#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/render/render_options.h"
#include "ngs/scene/mask_threshold.h"
#include "pictures.h"
#include "sections.h"
#include "shared/page/html.h"
#include "shared/page/mask_sheet.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;
constexpr int kFlipWidthPx = 800, kSidePx = 360, kMarkedWidthPx = 400;
using Colour = std::array<double, 3>;
constexpr Vec3<float> kPaperBehind{0.93f, 0.92f, 0.9f}, kNightBehind{0.114f, 0.133f, 0.153f};  // light and dark mode
constexpr Colour kPaper{kPaperBehind.x, kPaperBehind.y, kPaperBehind.z}, kOrange{1, 0.42, 0.17},
    kGrey{0.55, 0.58, 0.62};

/// `dark`: the image in dark mode; empty: the same.
std::string image_html(const char* state, const ImageF& image, const std::string& alt, const ImageF& dark = {}) {
  std::string img = "<img alt=\"" + escaped(alt) + "\" class=" + state + " width=" + std::to_string(image.width_px) +
                    " height=" + std::to_string(image.height_px) + " src=\"" + jpeg_source(to_bytes(image), 85) + "\">";
  if (dark.empty()) return img;
  return "<picture><source media=\"(prefers-color-scheme:dark)\" srcset=\"" + jpeg_source(to_bytes(dark), 85) + "\">" +
         img + "</picture>";
}

std::string link_to(const std::string& viewer) {
  if (viewer.empty()) return {};
  return "<p class=screen><a class=button href=\"" + viewer + "\">Turn the object in 3D</a></p>\n";
}

struct Flip {
  ImageF before, after;
  std::string view, before_name, after_name;
  ImageF after_dark = {};  // `after` in dark mode; empty: the same
};

/// Opens on `after`. The caption names the picture that is shown.
std::string flip_html(const Flip& flip) {
  const std::string start = "View " + flip.view + ": ";
  return std::string("<figure class=flip><label><input type=checkbox checked") + " aria-label=\"Show " +
         escaped(flip.after_name) + "\"><span class=stack>" +
         image_html("before", flip.before, start + flip.before_name) +
         image_html("after", flip.after, start + flip.after_name, flip.after_dark) + "</span></label><figcaption><b>" +
         escaped(flip.view) + "</b> <span class=of-before>" + escaped(flip.before_name) +
         "</span><span class=of-after>" + escaped(flip.after_name) + "</span></figcaption></figure>\n";
}

void mix(ImageF& image, std::size_t pixel, const Colour& colour, double share) {
  for (std::size_t c = 0; c < 3; ++c) {
    float& value = image.data[3 * pixel + c];
    value = float((1 - share) * double(value) + share * colour[c]);
  }
}

ImageF painted(ImageF photo, const Plane& mask, bool paint_object, const Colour& colour, double share) {
  for (std::size_t p = 0; p < mask.data.size(); ++p)
    if ((mask.data[p] != 0) == paint_object) mix(photo, p, colour, share);
  return photo;
}

struct SplatPicture {
  const char* file;
  Vec3<float> behind;
  int width_px, height_px;
};

/// Renders a splat of the run's folder from the camera of the view, over a colour; empty without that file.
ImageF splat_picture(const Exec& exec, const RunFolder& run, const ShownView& view, const SplatPicture& wanted) {
  const fs::path path = fs::path(run.path) / wanted.file;
  if (!view.scene_view || !fs::is_regular_file(path)) return {};
  const Camera& camera = run.scene->views[*view.scene_view].camera;
  const io::GaussianPly ply = io::read_gaussian_ply(path.generic_string());
  RenderRequest request{.label = {}, .background = wanted.behind};
  const double scale = double(wanted.width_px) / camera.width_px;
  return render(exec, ply.cloud, ngs::resized(camera, wanted.width_px, wanted.height_px),
                filter_at_scale(splat_options({}, ply.cloud, *run.scene), scale), request)
      .colour;
}

std::vector<Flip> flips_of(const Exec& exec, const RunFolder& run, const ShownView& view) {
  const ImageF full = io::read_image_rgb(view.photo, view.behind);
  const int width = std::min(kFlipWidthPx, full.width_px);
  const int height = std::max(1, int(std::lround(double(full.height_px) * width / full.width_px)));
  const ImageF photo = io::resize_area(full, width, height);
  const auto plane = [&](const std::string& path, std::uint32_t id) {
    return fitted(read_plane(path, id), width, height);
  };
  const Plane result = plane(view.predicted, view.predicted_id);
  const bool several = !view.object.empty();
  const std::string photo_name = run.scene && run.scene->renders ? "the splat" : "the photo";
  const std::string object = several ? view.object : "the object";
  std::vector<Flip> flips;
  ImageF cut = splat_picture(exec, run, view, {"object.ply", kPaperBehind, width, height});
  const bool is_splat = !cut.empty();
  if (!is_splat) cut = painted(photo, result, false, kPaper, 1);
  const std::string name = !is_splat ? object + " alone" : several ? "the objects, cut out" : "the object, cut out";
  ImageF dark = is_splat ? splat_picture(exec, run, view, {"object.ply", kNightBehind, width, height}) : ImageF();
  flips.push_back({photo, std::move(cut), view.view, photo_name, name, std::move(dark)});
  const auto behind = run.scene && run.scene->background ? background_of(*run.scene) : Vec3<float>{0.5f, 0.5f, 0.5f};
  if (ImageF left = splat_picture(exec, run, view, {"background.ply", behind, width, height}); !left.empty())
    flips.push_back({photo, std::move(left), view.view, photo_name,
                     several ? "the splat without the objects" : "the splat without the object"});
  if (const Plane input = plane(view.input, view.input_id); !input.empty())
    flips.push_back({painted(photo, input, true, {1, 1, 1}, 0.55), painted(photo, result, true, kOrange, 0.55),
                     view.view, (several ? "the input mask of " + object : "the input mask") + " (white)",
                     "the mask of the result (orange)"});
  return flips;
}

/// Density of Gaussians on a grid, projected along one axis.
ImageF side_picture(const io::GaussianPly& ply, const LabelColumns& labels, int axis,
                    const std::array<std::array<double, 2>, 3>& range) {
  const int across = axis == 0 ? 1 : 0, down = axis == 2 ? 1 : 2;
  const auto cells = std::size_t(kSidePx) * std::size_t(kSidePx);
  std::vector<double> object(cells), boundary(cells);
  const auto cell = [&](std::size_t row, int along) {
    const auto& r = range[std::size_t(along)];
    return std::floor((double(ply.cloud.position[3 * row + std::size_t(along)]) - r[0]) / (r[1] - r[0]) * kSidePx);
  };
  for (std::size_t i = 0; i < labels.label.size(); ++i) {
    const double x = cell(i, across), y = cell(i, down);
    if (!(x >= 0 && y >= 0 && x < kSidePx && y < kSidePx)) continue;
    const std::size_t at = std::size_t(y) * kSidePx + std::size_t(x);
    if (is_set(labels.boundary[i]))
      boundary[at] += 1;
    else if (label_is_foreground(labels.label[i]))
      object[at] += 1;
  }
  ImageF picture(kSidePx, kSidePx, 3, 0.08f);
  for (int y = 0; y < kSidePx; ++y)
    for (int x = 0; x < kSidePx; ++x) {
      const std::size_t at = std::size_t(y) * kSidePx + std::size_t(x);
      const auto dot = [&](double count,
                           const Colour& colour) {  // 2 x 2 px, so that single Gaussians are visible
        for (const int step : {0, 1, kSidePx, kSidePx + 1})
          if (count > 0 && x + 1 < kSidePx && y + 1 < kSidePx)
            mix(picture, at + std::size_t(step), colour, 1 - std::exp2(-count));
      };
      dot(object[at], kGrey);
      dot(boundary[at], kOrange);
    }
  return picture;
}

/// Range to show along each axis: boundary Gaussians without the outermost 2 % on either side, widened by 30 %, the
/// same length for all three axes. Zero length: no boundary Gaussians.
std::array<std::array<double, 2>, 3> range_of(const io::GaussianPly& ply, const LabelColumns& labels) {
  std::array<std::array<double, 2>, 3> range{};
  double longest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<float> along;
    for (std::size_t i = 0; i < labels.boundary.size(); ++i)
      if (is_set(labels.boundary[i]) && std::isfinite(ply.cloud.position[3 * i + axis]))
        along.push_back(ply.cloud.position[3 * i + axis]);
    if (along.size() < 2) return {};
    std::sort(along.begin(), along.end());
    const std::size_t n = along.size(), outer = std::min((n + 49) / 50, (n - 1) / 2);
    range[axis] = {along[outer], along[n - 1 - outer]};
    longest = std::max(longest, range[axis][1] - range[axis][0]);
  }
  for (auto& r : range) r = {(r[0] + r[1]) / 2 - 0.65 * longest, (r[0] + r[1]) / 2 + 0.65 * longest};
  return range;
}

}  // namespace

namespace {

/// Whether the mask of the result ends before the borders of the picture. False for a file that cannot be read.
bool shows_whole(const ShownView& view) {
  try {
    const Plane mask = read_plane(view.predicted, view.predicted_id);
    const auto w = std::size_t(mask.width_px), h = std::size_t(mask.height_px);
    std::size_t at_borders = 0;
    for (std::size_t p = 0; p < mask.data.size(); ++p)
      at_borders += mask.data[p] != 0 && (p < w || p >= w * (h - 1) || p % w == 0 || p % w == w - 1);
    return at_borders == 0 && std::ranges::count(mask.data, 0) < std::ssize(mask.data);
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

const ShownView* median_view(const RunFolder& run) {
  constexpr std::size_t kMost = 12;  // views that are looked at, on each side of the middle
  std::vector<const ShownView*> able;
  for (const ShownView& view : run.views)
    if (!view.photo.empty() && !view.predicted.empty()) able.push_back(&view);
  const std::size_t middle = able.size() / 2;
  for (std::size_t step = 0; step <= std::min(kMost, middle); ++step)
    for (const std::size_t at : {middle + step, middle - step})
      if (at < able.size() && shows_whole(*able[at])) return able[at];
  return able.empty() ? nullptr : able[middle];
}

std::string overview_section(const Exec& exec, RunFolder& run, Pictures& pictures, const std::string& viewer) {
  const ShownView* view = median_view(run);
  if (view == nullptr) return link_to(viewer);
  std::string html;
  try {
    for (const Flip& flip : flips_of(exec, run, *view)) {
      const std::string figure = flip_html(flip);
      if (pictures.spend(figure.size())) html += figure;
    }
  } catch (const Error& e) {
    run.problems.push_back(e.what());
  }
  if (html.empty()) return link_to(viewer);
  const char* which = view->scores.is_null() ? "The middle view of the list" : "The view with the median boundary IoU";
  return "<section id=\"overview\">" + link_to(viewer) + "<div class=\"sheet opening\">" + html +
         "</div><p class=note><span class=screen>Click or tap a picture to flip it. </span>" + which +
         ", or the next one that shows the whole object.</p></section>\n";
}

std::string marked_section(RunFolder& run, Pictures& pictures) {
  const fs::path folder = fs::path(run.path) / "marked";
  std::error_code unreadable;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, unreadable), end; !unreadable && entry != end; entry.increment(unreadable))
    if (entry->path().extension() == ".png") files.push_back(entry->path());
  std::ranges::sort(files);
  std::string html;
  for (const fs::path& file : files) {
    try {
      const ImageF full = io::read_image_rgb(file.generic_string(), {0, 0, 0});
      const int width = std::min(kMarkedWidthPx, full.width_px);
      const int height = std::max(1, int(std::lround(double(full.height_px) * width / full.width_px)));
      const std::string name = file.filename().string();
      const std::string figure =
          "<figure><span class=stack>" +
          image_html("marked", io::resize_area(full, width, height), "View " + name + " with the strokes") +
          "</span><figcaption><b>" + escaped(name) + "</b></figcaption></figure>\n";
      if (pictures.spend(figure.size())) html += figure;
    } catch (const Error& e) {
      run.problems.push_back(e.what());
    }
  }
  if (html.empty()) return html;
  return section("marked", "Your strokes",
                 "<p class=note>Green: object. Red: background.</p><div class=\"sheet crops\">" + html + "</div>");
}

std::string boundary_section(RunFolder& run, Pictures& pictures) {
  const fs::path path = fs::path(run.path) / "labelled.ply";
  if (!fs::is_regular_file(path)) return {};
  std::string html;
  std::int64_t boundary = 0, object = 0;
  bool several = false;
  try {
    const io::GaussianPly ply = io::read_gaussian_ply(path.generic_string(), {io::HigherBands::kCheckOnly});
    const LabelColumns& labels = ply.labels;  // union over several objects
    several = ply.objects.size() > 1;
    if (labels.label.empty() || labels.boundary.empty()) return {};
    const auto range = range_of(ply, labels);
    if (!(range[0][1] > range[0][0])) return {};
    boundary = std::ranges::count_if(labels.boundary, is_set);
    object = std::ranges::count_if(labels.label, label_is_foreground);
    for (const int axis : {0, 1, 2}) {
      const std::string name = "along " + std::string(1, char('x' + axis));
      const std::string figure = "<figure><span class=stack>" +
                                 image_html("side", side_picture(ply, labels, axis, range),
                                            "View of the boundary set " + name +
                                                ": boundary Gaussians orange, other Gaussians of the object grey") +
                                 "</span><figcaption>" + name + "</figcaption></figure>\n";
      if (pictures.spend(figure.size())) html += figure;
    }
  } catch (const Error& e) {
    run.problems.push_back(e.what());
  }
  if (html.empty()) return html;
  return section("boundary", "The boundary set from three sides",
                 "<p class=note>Orange: the " + with_separators(boundary) +
                     " Gaussians whose masks disagree (Eq. 3). Grey: the other of the " + with_separators(object) +
                     " Gaussians of the object" + (several ? "s" : "") + ". World axes.</p><div class=sheet>" + html +
                     "</div>");
}

std::string repeat_section(const RunFolder& run) {
  std::string html;
  for (const ToolReport& tool : run.reports)
    if (!tool.command.empty()) html += escaped(tool.command) + "\n";
  if (html.empty()) return html;
  return section(
      "repeat", "Commands to repeat the run",
      "<p class=note>Run in the folder of the run; replaces the outputs.</p><pre class=scroll>" + html + "</pre>");
}

}  // namespace ngs::cli
