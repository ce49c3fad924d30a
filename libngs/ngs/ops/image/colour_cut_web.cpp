#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "ngs/ops/image/colour_cut.h"
#include "ngs/ops/image/colour_mixture_web.h"
#include "ngs/ops/image/grid_cut_web.h"

namespace ngs {
namespace {

constexpr double kContrast = 50, kCertain = 9 * kContrast;  // capacities, as in OpenCV

using Colours = std::vector<Rgb>;

struct Mixtures {
  ColourMixture background, object;

  ColourMixture& of(bool is_object) { return is_object ? object : background; }
};

/// Components of a side's colours.
std::vector<std::uint8_t> components_of(const ColourMixture& mixture, const Colours& colours) {
  std::vector<std::uint8_t> component(colours.size());
  for (std::size_t i = 0; i < colours.size(); ++i) component[i] = mixture.component_of(colours[i]);
  return component;
}

Mixtures learn(const SideColours& known, std::uint64_t seed) {
  ClusterRandom random(seed);
  Mixtures mixtures;
  for (const bool is_object : {false, true}) {
    const Colours& colours = is_object ? known.object : known.background;
    ColourMixture& mixture = mixtures.of(is_object);
    mixture.learn(colours, colour_clusters(colours, random));
    mixture.learn(colours, components_of(mixture, colours));
  }
  return mixtures;
}

std::size_t pixel_at(const HintedRegion& region, int x, int y) {
  return std::size_t(y) * std::size_t(region.width_px) + std::size_t(x);
}

double difference2(const Rgb& a, const Rgb& b) {
  int sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum;
}

constexpr std::size_t kLinked[] = {7, 6, 5, 4};  // steps to the neighbours before a pixel

/// work(x, y, step, squared difference of the colours) for every two neighbours.
template <class Work>
void for_each_link(const HintedRegion& region, const Work& work) {
  for (int y = 0; y < region.height_px; ++y)
    for (int x = 0; x < region.width_px; ++x)
      for (const std::size_t step : kLinked) {
        const int to_x = x + kGridSteps[step].x, to_y = y + kGridSteps[step].y;
        if (to_x < 0 || to_y < 0 || to_x >= region.width_px || to_y >= region.height_px) continue;
        const Rgb& other = region.colour[pixel_at(region, to_x, to_y)];
        work(x, y, step, difference2(region.colour[pixel_at(region, x, y)], other));
      }
}

/// 1 / (2 mean squared difference): the contrast at which a link has lost a factor of e^-½.
double sharpness_of(const HintedRegion& region) {
  double sum = 0;
  for_each_link(region, [&](int, int, std::size_t, double contrast2) { sum += contrast2; });
  if (sum <= std::numeric_limits<double>::epsilon()) return 0;
  const double links = 4.0 * region.width_px * region.height_px - 3.0 * region.width_px - 3.0 * region.height_px + 2;
  return 1 / (2 * sum / links);
}

/// Both sides learn from the pixels that are theirs now.
void learn_again(const HintedRegion& region, Mixtures& mixtures) {
  for (const bool side : {false, true}) {
    Colours colours;
    for (std::size_t p = 0; p < region.hint.size(); ++p)
      if (is_object(region.hint[p]) == side) colours.push_back(region.colour[p]);
    ColourMixture& mixture = mixtures.of(side);
    mixture.learn(colours, components_of(mixture, colours));
  }
}

void cut_once(HintedRegion& region, double sharpness, const Mixtures& mixtures) {
  GridCut grid(region.width_px, region.height_px);
  for_each_link(region, [&](int x, int y, std::size_t step, double contrast2) {
    const bool is_diagonal = kGridSteps[step].x != 0 && kGridSteps[step].y != 0;
    grid.link(x, y, step,
              (is_diagonal ? kContrast / double(std::numbers::sqrt2_v<float>) : kContrast) *
                  std::exp(-sharpness * contrast2));
  });
  const auto for_each_pixel = [&](const auto& work) {
    for (int y = 0; y < region.height_px; ++y)
      for (int x = 0; x < region.width_px; ++x) work(x, y, region.hint[pixel_at(region, x, y)]);
  };
  for_each_pixel([&](int x, int y, PixelHint hint) {
    const Rgb& colour = region.colour[pixel_at(region, x, y)];
    if (is_certain(hint))
      grid.set_terminal(x, y, hint == PixelHint::kObject ? kCertain : -kCertain);
    else
      grid.set_terminal(x, y,
                        std::log(mixtures.object.density(colour)) - std::log(mixtures.background.density(colour)));
  });
  grid.cut();
  for_each_pixel([&](int x, int y, PixelHint& hint) {
    if (!is_certain(hint)) hint = grid.is_source_side(x, y) ? PixelHint::kLikelyObject : PixelHint::kLikelyBackground;
  });
}

}  // namespace

void colour_cut(HintedRegion& region, const SideColours& known, int iterations, std::uint64_t seed) {
  Mixtures mixtures = learn(known, 0x9e3779b97f4a7c15ull ^ seed);
  const double sharpness = sharpness_of(region);
  for (int iteration = 0; iteration < std::max(1, iterations); ++iteration) {
    if (iteration > 0) learn_again(region, mixtures);
    cut_once(region, sharpness, mixtures);
  }
}

}  // namespace ngs
