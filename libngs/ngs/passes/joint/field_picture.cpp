#include "ngs/passes/joint/field_picture.h"

#include <algorithm>
#include <cmath>

#include "ngs/ops/field/knn.h"
#include "ngs/ops/field/sample_grid.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

/// One row of pixels [x0, x1) of the picture.
PixelGrid row_of(int x0, int x1, int y) {
  PixelGrid grid;
  grid.first_x = x0 + 0.5, grid.first_y = y + 0.5;
  grid.cols = x1 - x0, grid.rows = 1;
  return grid;
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// The rays of the pixels of a band, and which pixels these are.
struct BandRays {
  FieldRays rays;
  std::vector<std::size_t> pixel;  // [R]
};

void append_row(const Camera& camera, const PixelGrid& row, const DepthMap& map, const RayQueries& part,
                BandRays& out) {
  const std::vector<std::uint8_t> on = rays_on_surface(camera, part, map);
  for (int c = 0; c < row.cols; ++c)
    out.pixel.push_back(std::size_t(row.first_y) * std::size_t(camera.width_px) + std::size_t(row.x(c)));
  RayQueries& all = out.rays.rays;
  append(all.direction, part.direction), append(all.spacing, part.spacing);
  append(all.near, part.near), append(all.far, part.far), append(all.position, part.position);
  append(out.rays.on_surface, on);
}

BandRays band_rays(const Exec& exec, const FieldModel& model, const Camera& camera, const RenderedView& view,
                   const std::vector<std::uint8_t>& band) {
  const SampleOptions& sample = model.sample;
  const double mean = boundary_box(camera, model.boundary.positions(), sample.bbox_pad_px).mean_distance;
  const RayOptions options = ray_options(sample, mean);
  const DepthMap map{&view.depth, &view.alpha};
  BandRays out;
  out.rays.rays.samples = sample.depth_samples;
  const int w = view.width_px;
  for (int y = 0; y < view.height_px; ++y)
    for (int x = 0; x < w; ++x) {
      const auto in_band = [&](int at) { return at < w && band[std::size_t(y) * std::size_t(w) + std::size_t(at)]; };
      if (!in_band(x)) continue;
      const int begin = x;
      while (in_band(x)) ++x;
      const PixelGrid row = row_of(begin, x, y);
      append_row(camera, row, map,
                 ray_queries(exec, camera, row, options, sample.window == WindowCentre::kPixel ? map : DepthMap{}),
                 out);
    }
  return out;
}

}  // namespace

std::vector<std::uint8_t> contour_band(const ImageF& masks, double band_px) {
  const int w = masks.width_px, h = masks.height_px;
  const auto objects = std::size_t(masks.channels);
  std::vector<std::uint8_t> band(std::size_t(masks.pixels()), 0);
  for (std::size_t k = 0; k < objects; ++k) {
    std::vector<std::uint8_t> inside(band.size()), outside(band.size());
    for (std::size_t p = 0; p < band.size(); ++p)
      inside[p] = label_says_object(masks.data[p * objects + k]), outside[p] = !inside[p];
    for (const auto* side : {&inside, &outside}) {
      const std::vector<std::int32_t> far = chessboard_distance({side->data(), w, h}, Outside::kUnknown);
      for (std::size_t p = 0; p < band.size(); ++p) band[p] |= far[p] > 0 && double(far[p]) <= band_px;
    }
  }
  return band;
}

std::int64_t blend_field(const Exec& exec, FieldModel& model, const FieldBand& where, RenderedView& view) {
  if (model.boundary.origin != where.origin)
    throw Error(ErrorCode::kInconsistent, "the field is relative to another origin than the model",
                "take the field and the model of one run of ngs-joint");
  const Camera camera = relative_to(where.camera, where.origin);
  BandRays band = band_rays(exec, model, camera, view, contour_band(view.label, where.band_px));
  if (band.pixel.empty() || model.boundary.size() == 0) return 0;
  const Rows<const float, 3> boundary = model.boundary.positions();
  band.rays.graph = nearest_points(exec, boundary, band.rays.rays.positions(), model.field.shape().neighbours);
  const VolumeOutput& drawn = model.field.forward(exec, band.rays, boundary, {0, 0, 0});
  const auto objects = std::size_t(view.label.channels);
  const bool masks = model.field.shape().objects == view.label.channels;
  std::int64_t count = 0;
  for (std::size_t r = 0; r < band.pixel.size(); ++r) {
    if (!band.rays.on_surface[r]) continue;
    ++count;
    const std::size_t p = band.pixel[r];
    const float open = 1 - drawn.alpha[r];
    for (std::size_t c = 0; c < 3; ++c)
      view.colour.data[p * 3 + c] = drawn.colour[r * 3 + c] + open * view.colour.data[p * 3 + c];
    view.alpha.data[p] = drawn.alpha[r] + open * view.alpha.data[p];
    for (std::size_t k = 0; masks && k < objects; ++k)
      view.label.data[p * objects + k] = model.field.mask()[r * objects + k] + open * view.label.data[p * objects + k];
  }
  return count;
}

}  // namespace ngs
