#include "ngs/edit/fill/fill_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "ngs/backend/for_each.h"
#include "ngs/edit/fill/texture_repeats.h"

namespace ngs {
namespace {

constexpr std::int64_t kReach = 2;   // texels of a patch on each side of its centre
constexpr float kTrust = 4;          // weight of a predicted texel: its likeness to this power; of a known texel: 1
constexpr std::int64_t kCoarse = 6;  // distance in texels at which coarse texture is measured
constexpr double kMaxWork = 5e8;     // maximum number of texel comparisons; above it, source patches are subsampled

using Size = std::size_t;

/// RMS difference of a known texel from the mean of the two texels `distance` before and after it in its row or column.
/// 0 for a linear gradient.
double detail_at(const TextureGrid& grid, std::int64_t distance) {
  double squares = 0, all = 0;
  const auto add = [&](std::int64_t at, std::int64_t step) {
    const Size i = Size(at), before = Size(at - step), after = Size(at + step);
    if (grid.state[i] != Texel::kKnown || grid.state[before] != Texel::kKnown || grid.state[after] != Texel::kKnown)
      return;
    for (Size c = 0; c < 3; ++c) {
      const double mean = 0.5 * (double(grid.colour[3 * before + c]) + double(grid.colour[3 * after + c]));
      const double d = double(grid.colour[3 * i + c]) - mean;
      squares += d * d;
      ++all;
    }
  };
  for (std::int64_t y = 0; y < grid.rows; ++y)
    for (std::int64_t x = 0; x < grid.columns; ++x) {
      const std::int64_t at = y * grid.columns + x;
      if (x >= distance && x + distance < grid.columns) add(at, distance);
      if (y >= distance && y + distance < grid.rows) add(at, distance * grid.columns);
    }
  return all > 0 ? std::sqrt(squares / all) : 0;
}

/// The larger of the detail at fine and at coarse scale.
double detail_of(const TextureGrid& grid) { return std::max(detail_at(grid, 1), detail_at(grid, kCoarse)); }

/// Fills by whole patches.
class PatchFill {
 public:
  PatchFill(const Exec& exec, TextureGrid& grid, const Repeats& repeats)
      : exec_(exec), grid_(grid), repeats_(repeats), confidence_(grid.state.size()) {
    for (Size i = 0; i < confidence_.size(); ++i) confidence_[i] = grid.state[i] == Texel::kKnown;
    for (std::int64_t y = kReach; y < grid.rows - kReach; ++y)
      for (std::int64_t x = kReach; x < grid.columns - kReach; ++x) {
        bool whole = true;
        for_patch(y * grid.columns + x, [&](const Offset& o) { whole &= grid.state[o.texel] == Texel::kKnown; });
        if (whole) sources_.push_back(y * grid.columns + x);
      }
    thin_sources();
  }
  bool has_sources() const { return !sources_.empty(); }

  void run() {
    for (std::int64_t next = next_texel(); next >= 0; next = next_texel()) copy(best_source(next), next);
  }

 private:
  struct Offset {
    std::int64_t step, x, y;
    Size texel;
  };

  struct Wanted {
    std::int64_t step;
    float weight;
    const float* colour;
  };

  void thin_sources() {
    const auto unknown = double(std::ranges::count(grid_.state, Texel::kUnknown));
    const double work = unknown / 4 * 25 * double(sources_.size());
    const auto step = Size(std::max(1.0, std::ceil(work / kMaxWork)));
    if (step == 1) return;
    std::vector<std::int64_t> thinned;
    for (Size k = 0; k < sources_.size(); k += step) thinned.push_back(sources_[k]);
    sources_ = std::move(thinned);
  }

  /// Calls visit(offset) for the texels of the patch around `centre` that are in the grid.
  template <class Visit>
  void for_patch(std::int64_t centre, const Visit& visit) const {
    const std::int64_t x = centre % grid_.columns, y = centre / grid_.columns;
    for (std::int64_t dy = std::max(-kReach, -y); dy <= std::min(kReach, grid_.rows - 1 - y); ++dy)
      for (std::int64_t dx = std::max(-kReach, -x); dx <= std::min(kReach, grid_.columns - 1 - x); ++dx) {
        const std::int64_t step = dy * grid_.columns + dx;
        visit(Offset{step, dx, dy, Size(centre + step)});
      }
  }

  bool is(std::int64_t x, std::int64_t y, Texel state) const {
    return x >= 0 && y >= 0 && x < grid_.columns && y < grid_.rows && grid_.state[Size(y * grid_.columns + x)] == state;
  }

  /// The unknown texel at the rim with the highest priority; -1: none is left.
  std::int64_t next_texel() {
    std::int64_t best = -1;
    double highest = -1;
    for (std::int64_t y = 0; y < grid_.rows; ++y)
      for (std::int64_t x = 0; x < grid_.columns; ++x) {
        if (!is(x, y, Texel::kUnknown)) continue;
        const bool at_rim = is(x - 1, y, Texel::kKnown) || is(x + 1, y, Texel::kKnown) || is(x, y - 1, Texel::kKnown) ||
                            is(x, y + 1, Texel::kKnown);
        const double priority = at_rim ? priority_of(x, y) : 0;
        if (priority > highest) {
          highest = priority;
          best = y * grid_.columns + x;
        }
      }
    return best;
  }
  double priority_of(std::int64_t x, std::int64_t y) const {
    double sum = 0;
    for_patch(y * grid_.columns + x, [&](const Offset& o) { sum += confidence_[o.texel]; });
    return sum;
  }

  /// The source patch most similar to the target's known and predicted texels; ties go to the first.
  std::int64_t best_source(std::int64_t target) const {
    std::vector<Wanted> wanted;
    for_patch(target, [&](const Offset& o) {
      const bool known = grid_.state[o.texel] == Texel::kKnown;
      const float weight = known ? 1.f : std::pow(repeats_.likeness[o.texel], kTrust);
      if (weight > 0 && grid_.state[o.texel] != Texel::kNone)
        wanted.push_back({o.step, weight, known ? &grid_.colour[3 * o.texel] : &repeats_.colour[3 * o.texel]});
    });
    constexpr Size kChunk = 512;
    struct Found {
      double difference = std::numeric_limits<double>::infinity();
      std::int64_t source = -1;
    };
    std::vector<Found> found((sources_.size() + kChunk - 1) / kChunk);
    for_each_index(exec_, std::int64_t(found.size()), [&](std::int64_t chunk) {
      Found best;
      for (Size k = Size(chunk) * kChunk; k < std::min(sources_.size(), (Size(chunk) + 1) * kChunk); ++k) {
        const double difference = difference_of(sources_[k], wanted, best.difference);
        if (difference < best.difference) best = {difference, sources_[k]};
      }
      found[Size(chunk)] = best;
    });
    Found best{std::numeric_limits<double>::infinity(), sources_.front()};
    for (const Found& f : found)
      if (f.difference < best.difference) best = f;
    return best.source;
  }

  double difference_of(std::int64_t source, const std::vector<Wanted>& wanted, double most) const {
    double sum = 0;
    for (Size k = 0; k < wanted.size() && sum < most; ++k) {
      const float* a = wanted[k].colour;
      const float* b = &grid_.colour[3 * Size(source + wanted[k].step)];
      const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
      sum += double(wanted[k].weight * (x * x + y * y + z * z));
    }
    return sum;
  }

  void copy(std::int64_t source, std::int64_t target) {
    double sum = 0, count = 0;
    for_patch(target, [&](const Offset& o) {
      sum += confidence_[o.texel];
      ++count;
    });
    for_patch(target, [&](const Offset& o) {
      if (grid_.state[o.texel] != Texel::kUnknown) return;
      std::copy_n(&grid_.colour[3 * Size(source + o.step)], 3, &grid_.colour[3 * o.texel]);
      grid_.state[o.texel] = Texel::kKnown;
      confidence_[o.texel] = sum / count;
    });
  }

  const Exec& exec_;
  TextureGrid& grid_;
  const Repeats& repeats_;
  std::vector<double> confidence_;
  std::vector<std::int64_t> sources_;
};

}  // namespace

void fill_smoothly(TextureGrid& grid) {
  constexpr int kMaxSweeps = 2000;
  constexpr double kRelaxation = 1.9, kSettled = 1e-5;
  std::vector<Size> unknown;
  std::array<double, 3> mean{};
  double count = 0;
  for (Size i = 0; i < grid.state.size(); ++i) {
    if (grid.state[i] == Texel::kUnknown) unknown.push_back(i);
    if (grid.state[i] != Texel::kKnown) continue;
    for (Size c = 0; c < 3; ++c) mean[c] += double(grid.colour[3 * i + c]);
    ++count;
  }
  if (count == 0) return;
  for (const Size i : unknown)
    for (Size c = 0; c < 3; ++c) grid.colour[3 * i + c] = float(mean[c] / count);
  double change = 1;
  for (int sweep = 0; sweep < kMaxSweeps && change > kSettled; ++sweep) {
    change = 0;
    for (const Size i : unknown) {
      std::array<Size, 4> side{};
      Size sides = 0;
      const std::int64_t x = std::int64_t(i) % grid.columns, y = std::int64_t(i) / grid.columns;
      const auto add = [&](bool inside, std::int64_t step) {
        if (inside && grid.state[Size(std::int64_t(i) + step)] != Texel::kNone)
          side[sides++] = Size(std::int64_t(i) + step);
      };
      add(x > 0, -1);
      add(x + 1 < grid.columns, 1);
      add(y > 0, -grid.columns);
      add(y + 1 < grid.rows, grid.columns);
      if (sides == 0) continue;
      for (Size c = 0; c < 3; ++c) {
        double sum = 0;
        for (Size k = 0; k < sides; ++k) sum += double(grid.colour[3 * side[k] + c]);
        const double before = double(grid.colour[3 * i + c]);
        const double after = before + kRelaxation * (sum / double(sides) - before);
        grid.colour[3 * i + c] = float(after);
        change = std::max(change, std::abs(after - before));
      }
    }
  }
  for (const Size i : unknown) grid.state[i] = Texel::kKnown;
}

TextureFill fill_texture(const Exec& exec, TextureGrid& grid, double detail) {
  if (std::ranges::find(grid.state, Texel::kUnknown) == grid.state.end() ||
      std::ranges::find(grid.state, Texel::kKnown) == grid.state.end())
    return TextureFill::kNothing;
  if (detail_of(grid) > detail) {
    const Repeats repeats = find_repeats(exec, grid);
    PatchFill patches(exec, grid, repeats);
    if (patches.has_sources()) return patches.run(), TextureFill::kPatches;
  }
  fill_smoothly(grid);
  return TextureFill::kSmooth;
}

}  // namespace ngs
