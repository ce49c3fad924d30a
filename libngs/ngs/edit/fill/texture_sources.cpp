#include "ngs/edit/fill/texture_sources.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "ngs/backend/for_each.h"
#include "ngs/math/sh.h"

namespace ngs {
namespace {

constexpr std::size_t kSectors = 8;
constexpr double kBin = 0.3;       // sh_dc: colours of neighbouring bins, 0.08 to 0.17 of the range apart, are alike
constexpr double kMinPart = 0.01;  // minimum share of a sector's known cells to contain a colour
using Bin = std::array<int, 3>;
using SectorCounts = std::array<int, kSectors>;

Bin bin_of(const TextureGrid& grid, std::size_t cell) {
  Bin bin;
  for (std::size_t a = 0; a < 3; ++a)
    bin[a] = int(std::floor(std::clamp(double(grid.colour[3 * cell + a]), -100.0, 100.0) / kBin));
  return bin;
}

/// The cells of each sector with a colour like that of a bin.
SectorCounts counts_like(const std::map<Bin, SectorCounts>& bins, const Bin& bin) {
  SectorCounts sum{};
  for (int k = 0; k < 27; ++k) {
    const auto near = bins.find({bin[0] + k % 3 - 1, bin[1] + k / 3 % 3 - 1, bin[2] + k / 9 - 1});
    for (std::size_t s = 0; near != bins.end() && s < kSectors; ++s) sum[s] += near->second[s];
  }
  return sum;
}

/// Excludes colours that occur in too few sectors around `middle` from the texture.
void exclude_local_colours(const HoleCells& cells, Vec2<double> middle, TextureGrid& grid) {
  std::map<Bin, SectorCounts> bins;
  SectorCounts known{};
  for (std::size_t cell = 0; cell < grid.state.size(); ++cell) {
    if (grid.state[cell] != Texel::kKnown) continue;
    const Vec2<double> at = cells.centre(std::int64_t(cell));
    const double turn = std::atan2(at.y - middle.y, at.x - middle.x) / (2 * std::numbers::pi) + 0.5;
    const std::size_t sector = std::min(kSectors - 1, std::size_t(turn * kSectors));
    ++bins[bin_of(grid, cell)][sector];
    ++known[sector];
  }
  const auto sectors = std::size_t(std::ranges::count_if(known, [](int n) { return n > 0; }));
  std::map<Bin, bool> is_local;
  for (const auto& [bin, unused] : bins) {
    const SectorCounts like = counts_like(bins, bin);
    std::size_t with = 0;
    for (std::size_t s = 0; s < kSectors; ++s) with += like[s] > 0 && like[s] >= kMinPart * known[s];
    is_local[bin] = with < 3 * sectors / kSectors;
  }
  for (std::size_t cell = 0; cell < grid.state.size(); ++cell)
    if (grid.state[cell] == Texel::kKnown && is_local[bin_of(grid, cell)]) grid.state[cell] = Texel::kNone;
}

}  // namespace

float relit(float sh_dc, double factor) { return float(dc_of_colour(colour_of_dc(double(sh_dc)) / factor)); }

TextureGrid texture_sources(const Exec& exec, const HoleScene& scene, std::size_t index, Shadows& shadows) {
  const HoleCells& cells = shadows.cells;
  const FillSurface& surface = scene.surfaces[index];
  TextureGrid grid{cells.columns, cells.rows, std::vector<Texel>(cells.state.size(), Texel::kNone), cells.colour};
  for_each_index(exec, std::int64_t(cells.state.size()), [&](std::int64_t i) {
    const auto cell = std::size_t(i);
    if (cells.state[cell] == HoleCell::kHole) grid.state[cell] = Texel::kUnknown;
    if (cells.state[cell] != HoleCell::kCovered) return;
    grid.state[cell] = Texel::kKnown;
    const Vec2<double> at = cells.centre(i);
    const double factor = shadows.cast.at(scene.occluder, surface.point(at.x, at.y, 0));
    for (std::size_t a = 0; factor < 1 && a < 3; ++a)
      grid.colour[3 * cell + a] = relit(grid.colour[3 * cell + a], factor);
  });
  std::vector<orbit::Vec> places;
  for (std::size_t i = 0; i < cells.state.size(); ++i) {
    const Vec2<double> at = cells.centre(std::int64_t(i));
    places.push_back(surface.point(at.x, at.y, 0));
  }
  const std::vector<double> distance = distance_to_object(exec, scene.rim, places);
  shadows.contact = find_contact_shadow(exec, grid, distance, cells.side, scene.rim.diagonal);
  for (std::size_t i = 0; i < distance.size(); ++i) {
    const double factor = shadows.contact.at(std::int64_t(i), &grid.colour[3 * i]);
    for (std::size_t a = 0; a < 3; ++a) grid.colour[3 * i + a] = relit(grid.colour[3 * i + a], factor);
  }
  orbit::Vec middle{0, 0, 0};
  const double share = 1 / std::max(1.0, double(scene.rim.object.count()));
  for (const orbit::Vec& p : scene.rim.object.position) middle = middle + share * p;
  exclude_local_colours(cells, surface.coordinates(middle), grid);
  return grid;
}

}  // namespace ngs
