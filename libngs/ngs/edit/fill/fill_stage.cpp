#include "ngs/edit/fill/fill_stage.h"

#include <array>
#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/edit/fill/debris.h"
#include "ngs/edit/fill/texture_sources.h"
#include "ngs/math/median.h"
#include "ngs/math/quat.h"

namespace ngs {
namespace {

using orbit::Vec;

constexpr double kDetail = 0.07;       // sh_dc: 0.02 of the colour range
constexpr double kWidth = 0.7;         // standard deviation of a filled Gaussian, cells
constexpr double kThickness = 0.1;     // along the normal, cells
constexpr float kLogitOpacity = 3.9f;  // 0.98: neighbours overlap, so that a cell is covered by 0.97 and more
constexpr double kBelow = 0.05;        // cells: filled Gaussians are composited behind those of the rim

/// Axes of the surface at a point: two along it, and its normal.
std::array<Vec, 3> axes_at(const FillSurface& surface, Vec2<double> at, double side) {
  const Vec along_u = surface.point(at.x + side, at.y, 0) - surface.point(at.x - side, at.y, 0);
  const Vec along_v = surface.point(at.x, at.y + side, 0) - surface.point(at.x, at.y - side, 0);
  const Vec x = unit(along_u), z = unit(cross(along_u, along_v));
  return {x, cross(z, x), z};
}

/// Mean of the SH bands above degree 0 over the solid Gaussians of a surface.
std::vector<float> mean_bands(const GaussianCloud& cloud, const Rim& rim, const FillSurface& surface) {
  const std::size_t values = 3 * std::size_t(cloud.rest_count());
  std::vector<double> sum(values);
  double count = 0;
  for (const std::uint32_t k : rim.solid) {
    if (std::abs(surface.height(rim.background.position[k])) > surface.tolerance) continue;
    const float* bands = cloud.sh_rest.data() + std::size_t(rim.background.row[k]) * values;
    for (std::size_t v = 0; v < values; ++v) sum[v] += double(bands[v]);
    ++count;
  }
  std::vector<float> mean(values);
  for (std::size_t v = 0; v < values; ++v) mean[v] = count > 0 ? float(sum[v] / count) : 0.f;
  return mean;
}

/// Appends a flat Gaussian for every cell of the hole. Returns their number.
std::int64_t append_hole_gaussians(const FillSurface& surface, const HoleCells& cells, const TextureGrid& texture,
                                   const std::vector<float>& bands, GaussianCloud& filled) {
  std::int64_t rows = 0;
  for (std::size_t i = 0; i < cells.state.size(); ++i) {
    if (cells.state[i] != HoleCell::kHole || texture.state[i] != Texel::kKnown) continue;
    const Vec2<double> at = cells.centre(std::int64_t(i));
    const Vec p = surface.point(at.x, at.y, -kBelow * cells.side);
    const std::array<Vec, 3> axes = axes_at(surface, at, cells.side);
    for (const double x : {p.x, p.y, p.z}) filled.position.push_back(float(x));
    const auto& [x_axis, y_axis, z_axis] = axes;
    for (const float q : stored_quaternion(
             {{x_axis.x, y_axis.x, z_axis.x, x_axis.y, y_axis.y, z_axis.y, x_axis.z, y_axis.z, z_axis.z}}))
      filled.rotation.push_back(q);
    for (const double size : {kWidth, kWidth, kThickness})
      filled.log_scale.push_back(float(std::log(size * cells.side)));
    filled.logit_opacity.push_back(kLogitOpacity);
    filled.usable.push_back(1);
    filled.sh_dc.insert(filled.sh_dc.end(), &texture.colour[3 * i], &texture.colour[3 * i] + 3);
    filled.sh_rest.insert(filled.sh_rest.end(), bands.begin(), bands.end());
    ++rows;
  }
  return rows;
}

/// Marks Gaussians near the surface that lie almost entirely in the hole: they show the object or its contact shadow,
/// or no view constrains them. Opaque Gaussians above the surface are kept, because they belong to other things.
void add_hidden(const GaussianCloud& cloud, const Rim& rim, const FillSurface& surface, const HoleCells& cells,
                std::vector<std::uint8_t>& debris) {
  constexpr double kInHole = 0.8, kAbove = 0.15;  // minimum share in the hole; maximum height, diagonals
  constexpr double kSolid = 0.5;                  // opacity
  for (std::size_t i = 0; i < debris.size(); ++i) {
    const double height = surface.height(rim.background.position[i]);
    if (debris[i] || height < -2 * surface.tolerance || height > kAbove * rim.diagonal) continue;
    if (height > 2 * surface.tolerance && rim.background.opacity[i] > kSolid) continue;
    debris[i] = share_in_hole(cloud, surface, cells, rim.background.row[i]) >= kInHole;
  }
}

/// Replaces the Gaussians of a surface in the object's shadows by relit copies. Rows that are removed stay removed.
void relight(const Exec& exec, const HoleScene& scene, const FillSurface& surface, const Shadows& shadows,
             HoleFill& out) {
  if (shadows.cast.shadow_factor >= 1 && shadows.contact.shadow_factor.empty()) return;
  const GaussianCloud& cloud = scene.cloud;
  const std::size_t bands = 3 * std::size_t(cloud.rest_count());
  std::vector<double> factor(out.removed.size(), 1);
  for_each_index(exec, cloud.size(), [&](std::int64_t row) {
    const auto i = std::size_t(row);
    const Vec p{cloud.position[3 * i], cloud.position[3 * i + 1], cloud.position[3 * i + 2]};
    if (scene.object[i] || out.removed[i] || !cloud.usable[i] || std::abs(surface.height(p)) > surface.tolerance)
      return;
    const std::int64_t cell = shadows.cells.cell_of(surface.coordinates(p));
    factor[i] = shadows.cast.at(scene.occluder, p - surface.height(p) * surface.normal) *
                shadows.contact.at(cell, &cloud.sh_dc[3 * i]);
  });
  for (std::size_t i = 0; i < factor.size(); ++i) {
    if (factor[i] >= 1) continue;
    const std::size_t to = std::size_t(out.filled.size());
    out.removed[i] = 1;
    ++out.relit_rows;
    const auto append = [i](auto& rows, const auto& from, std::size_t width) {
      rows.insert(rows.end(), from.begin() + std::ptrdiff_t(i * width), from.begin() + std::ptrdiff_t((i + 1) * width));
    };
    append(out.filled.position, cloud.position, 3);
    append(out.filled.rotation, cloud.rotation, 4);
    append(out.filled.log_scale, cloud.log_scale, 3);
    append(out.filled.logit_opacity, cloud.logit_opacity, 1);
    append(out.filled.sh_dc, cloud.sh_dc, 3);
    append(out.filled.sh_rest, cloud.sh_rest, bands);
    append(out.filled.usable, cloud.usable, 1);
    for (std::size_t a = 0; a < 3; ++a) out.filled.sh_dc[3 * to + a] = relit(out.filled.sh_dc[3 * to + a], factor[i]);
    for (std::size_t b = 0; b < bands; ++b) out.filled.sh_rest[bands * to + b] /= float(factor[i]);
  }
}

std::string nothing_to_fill(const Rim& rim, const HoleFill& out) {
  if (rim.object.count() == 0) return "the object has no visible Gaussian";
  if (out.surfaces.empty()) return "the background has no surface at the object's rim";
  for (const FilledSurface& s : out.surfaces)
    if (s.continued > 0) return "the background continues below the object";
  for (const FilledSurface& s : out.surfaces)
    if (s.one_sided > 0) return "the background's surface ends at the object: its rim is missing on one side";
  return "the background has no hole there";
}

}  // namespace

HoleFill fill_hole(const Exec& exec, Monitor& monitor, const FillOptions& options, const FillInput& input,
                   std::uint64_t seed) {
  const GaussianCloud& cloud = input.cloud;
  NGS_CHECK(input.object.size() == std::size_t(cloud.size()), "one entry per Gaussian");
  HoleFill out;
  out.removed.assign(input.object.size(), 0);
  out.filled.origin = cloud.origin;
  out.filled.sh_degree = cloud.sh_degree;
  out.filled.antialiased = cloud.antialiased;
  const auto timed = monitor.scope("fill");
  const Rim rim = find_rim(exec, cloud, input.object);
  const std::vector<FillSurface> surfaces = find_fill_surfaces(exec, cloud, rim, options.fill, seed);
  const Occluder occluder(rim);
  std::vector<std::uint8_t> debris = find_debris(exec, cloud, rim, occluder, surfaces);
  std::vector<std::uint8_t> hidden = debris;
  std::vector<Shadows> shadows(surfaces.size());
  const HoleScene scene{cloud, input.object, rim, occluder, surfaces, debris};
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    const FillSurface& surface = surfaces[s];
    const HoleCells& cells = shadows[s].cells = find_hole_cells(exec, scene, s);
    const bool stands = cells.hole + cells.continued > 0;  // else nothing is to be filled or relit
    if (stands) shadows[s].cast = find_cast_shadow(exec, scene, s, cells);
    FilledSurface found{surface.relief.empty(), surface.normal,  surface.rim_points, surface.residual,
                        surface.spacing,        cells.side,      cells.hole,         cells.one_sided,
                        cells.continued,        cells.footprint, shadows[s].cast};
    TextureGrid texture;
    if (stands) {
      texture = texture_sources(exec, scene, s, shadows[s]);
      found.texture = fill_texture(exec, texture, kDetail);
    }
    if (found.texture != TextureFill::kNothing) {
      found.rows = append_hole_gaussians(surface, cells, texture, mean_bands(cloud, rim, surface), out.filled);
      add_hidden(cloud, rim, surface, cells, hidden);
    }
    out.surfaces.push_back(found);
  }
  for (std::size_t i = 0; out.filled.size() > 0 && i < hidden.size(); ++i)
    if (hidden[i]) {
      out.removed[rim.background.row[i]] = 1;
      ++out.removed_rows;
    }
  for (std::size_t s = 0; s < surfaces.size(); ++s) relight(exec, scene, surfaces[s], shadows[s], out);
  if (out.filled.size() == out.relit_rows) out.nothing = nothing_to_fill(rim, out);
  return out;
}

}  // namespace ngs
