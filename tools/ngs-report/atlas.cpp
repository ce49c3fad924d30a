#include <algorithm>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/eval/eval_stage.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/render/render_options.h"
#include "pictures.h"
#include "sections.h"
#include "shared/page/html.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kMaxViews = 32;
constexpr int kPictureWidthPx = 720;

const LabelColumns* labels_of(const io::GaussianPly& ply, const std::string& object) {
  for (const io::NamedLabels& named : ply.objects)
    if (named.object == object) return &named.columns;
  const LabelColumns& all = ply.labels;
  return all.label.empty() || all.views.empty() || all.boundary.empty() ? nullptr : &all;
}

/// Dimmed grey photo, with wrong pixels in the colour of their cause.
ImageU8 picture_of(const ErrorAtlas& atlas, const ImageF& photo) {
  ImageU8 out(photo.width_px, photo.height_px, 3);
  for (std::size_t p = 0; p < atlas.cause.size(); ++p) {
    const float* rgb = &photo.data[3 * p];
    const double grey = 0.6 * 255 * double(0.3f * rgb[0] + 0.6f * rgb[1] + 0.1f * rgb[2]);
    for (std::size_t c = 0; c < 3; ++c)
      out.data[3 * p + c] = atlas.cause[p] == ErrorCause::kNone ? std::uint8_t(std::clamp(grey, 0.0, 255.0))
                                                                : kErrorCauseNames[std::size_t(atlas.cause[p])].rgb[c];
  }
  return out;
}

struct Pixel {
  int x, y;
};

/// The last pixel with a cause in the block of `factor` x `factor` pixels at `first`, or `first` without a cause.
Pixel shown_pixel(const ErrorAtlas& atlas, const ImageU8& picture, Pixel first, int factor) {
  Pixel shown = first;
  for (int y = first.y; y < std::min(first.y + factor, picture.height_px); ++y)
    for (int x = first.x; x < std::min(first.x + factor, picture.width_px); ++x)
      if (atlas.cause[std::size_t(y) * std::size_t(picture.width_px) + std::size_t(x)] != ErrorCause::kNone)
        shown = {x, y};
  return shown;
}

/// Downsampled, preferring wrong pixels.
ImageU8 reduced(const ErrorAtlas& atlas, const ImageU8& picture) {
  const int factor = std::max(1, (picture.width_px + kPictureWidthPx - 1) / kPictureWidthPx);
  ImageU8 out((picture.width_px + factor - 1) / factor, (picture.height_px + factor - 1) / factor, 3);
  for (int y = 0; y < out.height_px; ++y)
    for (int x = 0; x < out.width_px; ++x) {
      const Pixel from = shown_pixel(atlas, picture, {x * factor, y * factor}, factor);
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = picture.at(from.x, from.y, c);
    }
  return out;
}

std::string legend_html() {
  std::string html = "<p class=note>";
  for (std::size_t c = 1; c < kErrorCauses; ++c) {
    const ErrorCauseName& name = kErrorCauseNames[c];
    html += "<span style=\"display:inline-block;width:.9em;height:.9em;background:rgb(" + std::to_string(name.rgb[0]) +
            "," + std::to_string(name.rgb[1]) + "," + std::to_string(name.rgb[2]) + ")\"></span> <b>" +
            std::string(name.name) + "</b> " + std::string(name.help) + " &nbsp; ";
  }
  return html + "</p>";
}

struct Found {
  ErrorAtlas atlas;
  ImageU8 picture;
};

class AtlasMaker {
 public:
  AtlasMaker(const Exec& exec, const Scene& scene, const io::GaussianPly& ply)
      : exec_(exec),
        scene_(scene),
        ply_(ply),
        splat_(prepared_for(exec, splat_options({}, ply.cloud, scene), ply.cloud)) {}

  /// False if the view has no truth, no camera or no labels.
  bool make(const ShownView& view, Found& found) const {
    const LabelColumns* labels = labels_of(ply_, view.object);
    if (labels == nullptr || !view.scene_view) return false;
    const Camera& working = scene_.views[*view.scene_view].camera;
    const Plane labelled = read_truth(view);
    if (labelled.empty()) return false;
    const int w = labelled.width_px, h = labelled.height_px;
    const Plane predicted = fitted(read_plane(view.predicted, view.predicted_id), w, h);
    const Plane input = fitted(read_plane(view.input, view.input_id), w, h);
    if (predicted.empty()) return false;
    const Plane truth = closest_truth(labelled, predicted);
    const Camera camera = resized(working, w, h);
    const SplatOptions splat = filter_at_scale(splat_, double(w) / working.width_px);
    found.atlas = error_atlas(exec_, {ply_.cloud, *labels, camera, splat, predicted.view(), truth.view(),
                                      input.empty() ? MaskPlane{nullptr, w, h} : input.view()});
    ImageF photo = view.photo.empty() ? ImageF(w, h, 3, 0.5f) : io::read_image_rgb(view.photo, view.behind);
    found.picture = picture_of(found.atlas, io::resize_nearest(photo, w, h));
    return true;
  }

 private:
  const Exec& exec_;
  const Scene& scene_;
  const io::GaussianPly& ply_;
  SplatOptions splat_;
};

/// View names of a rig may contain folders; slashes in object names are replaced.
void write_picture(const std::string& folder, const ShownView& view, const ImageU8& picture) {
  std::string object = view.object;
  std::replace(object.begin(), object.end(), '/', '_');
  const fs::path file = fs::path(folder) / (view.view + (object.empty() ? "" : " " + object) + ".png");
  fs::create_directories(file.parent_path());
  io::write_png(file.generic_string(), picture);
}

std::string figure_of(const std::string& name, const Found& found) {
  const ImageU8 small = reduced(found.atlas, found.picture);
  return "<figure><div class=stack><img alt=\"View " + escaped(name) +
         " with its wrong pixels by cause\" width=" + std::to_string(small.width_px) +
         " height=" + std::to_string(small.height_px) + " src=\"data:image/jpeg;base64," +
         base64(io::encode_jpeg(small, 90)) + "\"></div><figcaption><b>" + escaped(name) + "</b> " +
         with_separators(found.atlas.wrong()) + " wrong pixels</figcaption></figure>\n";
}

}  // namespace

std::string errors_section(const Exec& exec, RunFolder& run, Pictures& pictures, const std::string& folder) {
  const std::string model = (fs::path(run.path) / "labelled.ply").generic_string();
  if (!run.scene || !fs::is_regular_file(model)) return {};
  Table table{.caption = "Wrong pixels of each view by cause, worst views first", .head = {"view", "wrong"}};
  bool all_views = true;
  for (std::size_t c = 1; c < kErrorCauses; ++c) table.head.emplace_back(kErrorCauseNames[c].name);
  std::string figures;
  std::array<std::int64_t, kErrorCauses> sum{};
  const auto add_row = [&](const std::string& name, const std::array<std::int64_t, kErrorCauses>& pixels) {
    std::int64_t wrong = 0;
    for (std::size_t c = 1; c < kErrorCauses; ++c) wrong += pixels[c];
    std::vector<std::string> row{escaped(name), with_separators(wrong)};
    for (std::size_t c = 1; c < kErrorCauses; ++c) row.push_back(with_separators(pixels[c]));
    table.rows.push_back(std::move(row));
  };
  int shown = 0;
  try {
    const io::GaussianPly ply = io::read_gaussian_ply(model);
    const AtlasMaker maker(exec, *run.scene, ply);
    for (const ShownView& view : run.views) {
      if (folder.empty() && table.rows.size() == kMaxViews) {  // each view costs renderings
        all_views = false;
        break;
      }
      Found found;
      if (!maker.make(view, found)) continue;
      const std::string name = view.object.empty() ? view.view : view.view + " " + view.object;
      add_row(name, found.atlas.pixels);
      for (std::size_t c = 0; c < kErrorCauses; ++c) sum[c] += found.atlas.pixels[c];
      if (!folder.empty()) write_picture(folder, view, found.picture);
      if (shown >= pictures.zoomed_views()) continue;
      const std::string figure = figure_of(name, found);
      if (pictures.spend(figure.size())) {
        figures += figure;
        ++shown;
      }
    }
  } catch (const Error& e) {
    run.problems.push_back(e.what());
  }
  if (table.rows.empty()) return {};
  if (!all_views)
    table.caption =
        "Wrong pixels of the " + std::to_string(kMaxViews) + " worst views by cause; --atlas lists every view";
  add_row(all_views ? "all" : "all of these", sum);
  return section("errors", "Where the errors come from",
                 legend_html() + "<div class=sheet>" + figures + "</div>" + table.html());
}

}  // namespace ngs::cli
