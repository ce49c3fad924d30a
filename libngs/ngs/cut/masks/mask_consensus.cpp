#include "ngs/cut/masks/mask_consensus.h"

#include <algorithm>
#include <cmath>

#include "ngs/ops/image/connected_components.h"
#include "ngs/ops/image/mask_pair.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/ops/splat/evidence.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

MaskPlane plane_of(const std::vector<std::uint8_t>& mask, int width_px, int height_px) {
  return {mask.data(), width_px, height_px};
}

/// ObjectPlace::reach in RMS distances from the object's centre.
constexpr double kReach = 3;
/// Seen Gaussians that vote on an unseen one.
constexpr int kVoters = 8;
/// Share of the object above which the consensus is clear, so that thin parts are certain.
constexpr float kClear = 0.8f;
/// A pixel is in the middle of a thin part if its depth is at least this fraction of the largest depth nearby.
constexpr double kMiddle = 0.6;

bool occludes_object(const Consensus& c, std::size_t p) {
  return !label_is_foreground(c.object[p]) && label_is_foreground(c.alone[p]);
}

/// Unseen Gaussians get the side of their nearest seen ones if these agree.
void label_by_neighbours(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::size_t>& unseen,
                         std::vector<float>& channels) {
  std::vector<std::size_t> seen;
  std::vector<float> points, queries;
  const auto append = [&](std::vector<float>& to, std::size_t i) {
    to.insert(to.end(), &cloud.position[3 * i], &cloud.position[3 * i] + 3);
  };
  for (const std::size_t i : unseen) append(queries, i);
  for (std::size_t i = 0; i < channels.size() / 2; ++i)
    if (channels[2 * i + 1] > 0) {
      seen.push_back(i);
      append(points, i);
    }
  if (unseen.empty() || seen.empty()) return;
  const KnnGraph graph = nearest_points(exec, {points.data(), std::int64_t(seen.size())},
                                        {queries.data(), std::int64_t(unseen.size())}, kVoters);
  const auto voters = std::size_t(graph.neighbours);
  std::vector<float> side(unseen.size());
  for (std::size_t q = 0; q < unseen.size(); ++q) {
    std::size_t votes = 0;
    for (std::size_t k = 0; k < voters; ++k)
      votes += label_is_foreground(channels[2 * seen[graph.index[q * voters + k]]]);
    side[q] = votes == voters ? 1.f : votes == 0 ? 0.f : -1.f;
  }
  for (std::size_t q = 0; q < unseen.size(); ++q)
    if (side[q] >= 0) {
      channels[2 * unseen[q]] = side[q];
      channels[2 * unseen[q] + 1] = 1;
    }
}

/// [N, 2]: share of the object, and 1 if the Gaussian is known.
std::vector<float> shares(const Exec& exec, const LiftedModel& model) {
  const auto& [cloud, lifted, place, use_neighbours] = model;
  const auto n = std::size_t(cloud.size());
  std::vector<float> channels(2 * n);
  std::vector<std::size_t> unseen;
  for (std::size_t i = 0; i < n; ++i) {
    if (lifted.weight.value(i) > 0) {
      channels[2 * i] = float(lifted.prob(i, 0));
      channels[2 * i + 1] = 1;
    } else if (cloud.usable[i]) {
      const Vec3<double> d = world_position(cloud, i) - place.centre;
      if (dot(d, d) > place.reach * place.reach)
        channels[2 * i + 1] = 1;
      else
        unseen.push_back(i);
    }
  }
  if (use_neighbours) label_by_neighbours(exec, cloud, unseen, channels);
  return channels;
}

/// The largest value within `reach` (chessboard distance): a separable maximum filter.
std::vector<std::int32_t> largest_nearby(std::vector<std::int32_t> value, int width_px, int height_px, int reach) {
  std::vector<std::int32_t> out(value.size());
  for (const bool rows : {true, false}) {
    const int length = rows ? width_px : height_px, lines = rows ? height_px : width_px;
    const auto at = [&](int line, int i) {
      return rows ? std::size_t(line) * std::size_t(width_px) + std::size_t(i)
                  : std::size_t(i) * std::size_t(width_px) + std::size_t(line);
    };
    for (int line = 0; line < lines; ++line)
      for (int i = 0; i < length; ++i) {
        std::int32_t most = 0;
        for (int k = std::max(0, i - reach); k <= std::min(length - 1, i + reach); ++k)
          most = std::max(most, value[at(line, k)]);
        out[at(line, i)] = most;
      }
    value = out;
  }
  return out;
}

/// Pixels of `side` deeper than the band, and the middle of its thin parts if `clear(pixel)`.
std::vector<std::uint8_t> certain(const std::vector<std::uint8_t>& side, const Consensus& c, int band_px,
                                  const auto& clear) {
  const auto depth = chessboard_distance(plane_of(side, c.width_px, c.height_px), Outside::kUnknown);
  const auto deepest = largest_nearby(depth, c.width_px, c.height_px, band_px);
  std::vector<std::uint8_t> out(side.size());
  for (std::size_t p = 0; p < out.size(); ++p)
    out[p] = depth[p] > band_px || (depth[p] > 2 && depth[p] >= kMiddle * deepest[p] && clear(p));
  return out;
}

/// Pixels [x0, x1) x [y0, y1); may reach beyond the image.
struct PixelRange {
  int x0, y0, x1, y1;
};

/// Distance of every pixel of one side from the other side.
struct SideDepth {
  std::vector<std::int32_t> depth;
  int width_px, height_px;

  std::int32_t& at(int x, int y) { return depth[std::size_t(y) * std::size_t(width_px) + std::size_t(x)]; }
  PixelRange inside(PixelRange r) const {
    return {std::max(0, r.x0), std::max(0, r.y0), std::min(width_px, r.x1), std::min(height_px, r.y1)};
  }
  /// Finds the first of the deepest pixels; false if there is none.
  bool find_deepest(const PixelRange& among, PromptPoint& point) {
    const PixelRange r = inside(among);
    std::int32_t deepest = 0;
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x)
        if (at(x, y) > deepest) {
          deepest = at(x, y);
          point.x = x;
          point.y = y;
        }
    return deepest > 0;
  }
  void clear(const PixelRange& range) {
    const PixelRange r = inside(range);
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x) at(x, y) = 0;
  }
};

std::vector<std::uint8_t> marked(const std::vector<PixelHint>& hints, const auto& wanted) {
  std::vector<std::uint8_t> mask(hints.size());
  for (std::size_t p = 0; p < mask.size(); ++p) mask[p] = wanted(hints[p]);
  return mask;
}

}  // namespace

ViewSums lift_mask(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& splat,
                   const PixelMask& mask) {
  const ViewSums all = view_sums(exec, cloud, {camera, known_view(camera, mask)}, splat);
  ViewSums lifted{1, true, {}, {}};
  for (std::size_t v = 0; v < all.size(); ++v)
    if (all.weight(v) >= kMinMeanWeight * all.at(v)[1]) lifted.add(all.row[v], all.at(v));
  return lifted;
}

ObjectPlace object_place(const GaussianCloud& cloud, const WeightSums<>& lifted) {
  ObjectPlace place;
  const auto mean = [&](const auto& of) {
    decltype(of(std::size_t(0))) sum{};
    double total = 0;
    for (std::size_t i = 0; i < lifted.weight.size(); ++i) {
      if (!is_object(BoundaryRule(), lifted.prob(i, 0))) continue;
      const double weight = lifted.object_weight(i, 0);
      sum = sum + weight * of(i);
      total += weight;
    }
    return total > 0 ? (1 / total) * sum : sum;
  };
  place.centre = mean([&](std::size_t i) { return world_position(cloud, i); });
  place.reach = kReach * std::sqrt(mean([&](std::size_t i) {
                  const Vec3<double> d = world_position(cloud, i) - place.centre;
                  return dot(d, d);
                }));
  return place;
}

Consensus render_consensus(const Exec& exec, const LiftedModel& model, const Camera& camera,
                           const SplatOptions& splat) {
  const GaussianCloud& cloud = model.cloud;
  const auto n = std::size_t(cloud.size());
  const std::vector<float> channels = shares(exec, model);
  RenderRequest request{.colour = false, .label = {channels.data(), cloud.size(), 2}};
  const RenderedView view = render(exec, cloud, camera, splat, request);
  std::vector<std::uint8_t> is_object(n);
  for (std::size_t i = 0; i < n; ++i) is_object[i] = label_is_foreground(channels[2 * i]);
  RenderRequest alone{.colour = false, .label = {}, .include = is_object.data()};
  Consensus out{camera.width_px, camera.height_px, {}, {}, render(exec, cloud, camera, splat, alone).alpha.data,
                view.alpha.data};
  out.object.resize(view.alpha.data.size());
  out.known.resize(view.alpha.data.size());
  for (std::size_t p = 0; p < out.object.size(); ++p) {
    const float object = view.label.data[2 * p], seen = view.label.data[2 * p + 1], empty = 1 - view.alpha.data[p];
    out.known[p] = std::clamp(seen + empty, 0.f, 1.f);
    out.object[p] = seen + empty > 0 ? std::clamp(object / (seen + empty), 0.f, 1.f) : 0.f;
  }
  return out;
}

void empty_is_background(const std::vector<float>& alpha, ViewPrompt& prompt) {
  for (std::size_t p = 0; p < prompt.hint.size(); ++p)
    if (alpha[p] < kEmptyAlpha && prompt.hint[p] != PixelHint::kObject) prompt.hint[p] = PixelHint::kBackground;
}

void empty_is_background(const std::vector<float>& alpha, PixelMask& mask) {
  for (std::size_t p = 0; p < mask.size(); ++p)
    if (alpha[p] < kEmptyAlpha) mask[p] = 0;
}

void keep_strokes(const ViewPrompt& by_hand, ViewPrompt& prompt) {
  for (std::size_t p = 0; p < prompt.hint.size(); ++p)
    if (is_certain(by_hand.hint[p])) prompt.hint[p] = by_hand.hint[p];
}

ViewPrompt prompt_from(const Consensus& c, int band_px, const PixelMask& before) {
  std::vector<std::uint8_t> inside(c.object.size()), outside(c.object.size());
  for (std::size_t p = 0; p < inside.size(); ++p) {
    if (!is_set(c.known[p])) continue;  // on neither side
    inside[p] = label_is_foreground(c.object[p]);
    outside[p] = !inside[p] && !occludes_object(c, p);
  }
  const std::vector<std::uint8_t> sure_in =
      certain(inside, c, band_px, [&](std::size_t p) { return c.object[p] > kClear; });
  const std::vector<std::uint8_t> sure_out =
      certain(outside, c, band_px, [&](std::size_t p) { return c.object[p] < 1 - kClear; });
  ViewPrompt prompt{c.width_px, c.height_px, std::vector<PixelHint>(inside.size(), PixelHint::kLikelyBackground),
                    false};
  for (std::size_t p = 0; p < inside.size(); ++p) {
    const bool known = inside[p] || outside[p], was_object = !before.empty() && before[p] != 0;
    if (sure_in[p])
      prompt.hint[p] = PixelHint::kObject;
    else if (sure_out[p])
      prompt.hint[p] = PixelHint::kBackground;
    else if (inside[p] || (!known && was_object))
      prompt.hint[p] = PixelHint::kLikelyObject;
  }
  return prompt;
}

double agreement(const Consensus& consensus, const PixelMask& mask) {
  MaskOverlap overlap;
  for (std::size_t p = 0; p < mask.size(); ++p)
    if (is_set(consensus.known[p]) && !occludes_object(consensus, p))
      overlap.add(label_is_foreground(consensus.object[p]), mask[p] != 0);
  return overlap.iou();
}

PixelMask keep_seeded_pieces(const ViewPrompt& prompt, PixelMask mask, double speck_share) {
  const auto seeded = [&](const std::vector<std::uint8_t>& of, PixelHint hint) {
    ConnectedComponents components = connected_components(plane_of(of, prompt.width_px, prompt.height_px));
    std::vector<std::uint8_t> has_seed(components.size.size());
    bool any = false;
    for (std::size_t p = 0; p < of.size(); ++p)
      if (prompt.hint[p] == hint) {
        any = true;
        has_seed[std::size_t(std::max(0, components.component[p]))] |= components.component[p] >= 0;
      }
    return std::tuple(std::move(components), std::move(has_seed), any);
  };
  if (std::find(mask.begin(), mask.end(), 1) == mask.end()) return mask;
  const auto [objects, object_seeds, has_object] = seeded(mask, PixelHint::kObject);
  for (std::size_t p = 0; p < mask.size(); ++p)
    if (mask[p] && has_object && !object_seeds[std::size_t(objects.component[p])]) mask[p] = 0;
  PixelMask rest(mask.size());
  for (std::size_t p = 0; p < mask.size(); ++p) rest[p] = !mask[p];
  if (std::find(rest.begin(), rest.end(), 1) == rest.end()) return mask;
  const double max_px = speck_share * double(std::count(mask.begin(), mask.end(), 1));
  const auto [holes, hole_seeds, has_background] = seeded(rest, PixelHint::kBackground);
  for (std::size_t p = 0; p < mask.size(); ++p)
    if (rest[p] && !hole_seeds[std::size_t(holes.component[p])] &&
        double(holes.size[std::size_t(holes.component[p])]) < max_px)
      mask[p] = 1;
  return mask;
}

std::vector<PromptPoint> prompt_points(const ViewPrompt& prompt, int max_points) {
  const std::array<int, 4> box = object_box(prompt);
  const int reach = std::max({1, (box[2] - box[0]) / 4, (box[3] - box[1]) / 4});
  std::vector<PromptPoint> points;
  for (const bool object : {true, false}) {
    const PixelHint side = object ? PixelHint::kObject : PixelHint::kBackground;
    SideDepth side_depth{chessboard_distance(plane_of(marked(prompt.hint, [&](PixelHint h) { return h == side; }),
                                                      prompt.width_px, prompt.height_px)),
                         prompt.width_px, prompt.height_px};
    const PixelRange near_object{box[0] - reach, box[1] - reach, box[2] + reach, box[3] + reach};
    const PixelRange everywhere{0, 0, prompt.width_px, prompt.height_px};
    for (int found = 0; found < max_points; ++found) {
      PromptPoint best{0, 0, object};
      if (!side_depth.find_deepest(object ? everywhere : near_object, best)) break;
      points.push_back(best);
      side_depth.clear({best.x - reach, best.y - reach, best.x + reach + 1, best.y + reach + 1});
    }
  }
  return points;
}

std::array<int, 4> object_box(const ViewPrompt& prompt) {
  std::array<int, 4> box{prompt.width_px, prompt.height_px, 0, 0};
  for (int y = 0; y < prompt.height_px; ++y)
    for (int x = 0; x < prompt.width_px; ++x) {
      if (!is_object(prompt.hint[std::size_t(y) * std::size_t(prompt.width_px) + std::size_t(x)])) continue;
      box = {std::min(box[0], x), std::min(box[1], y), std::max(box[2], x + 1), std::max(box[3], y + 1)};
    }
  return box[2] == 0 ? std::array<int, 4>{} : box;
}

}  // namespace ngs
