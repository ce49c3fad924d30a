#include "ngs/make/synth/mask_noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "ngs/backend/for_each.h"
#include "ngs/core/error.h"
#include "ngs/core/parse_number.h"
#include "ngs/core/rng.h"
#include "ngs/make/synth/contour_snap.h"

namespace ngs::synth {
namespace {

/// Independent draws for one view and purpose.
struct Draws {
  std::uint64_t seed;
  Draws(std::uint64_t run_seed, int view, std::uint64_t purpose)
      : seed(rng_bits(run_seed, RngStream::kMaskNoise, std::uint64_t(view) * 16 + purpose)) {}
  double uniform(std::uint64_t i) const { return rng_uniform(seed, RngStream::kMaskNoise, i); }
  double normal(std::uint64_t i) const { return rng_normal(seed, RngStream::kMaskNoise, i); }
};
enum Purpose : std::uint64_t { kSwap, kDrop, kJitter, kBlob, kAssignment, kMerge, kSplit, kShuffle, kBackground };

std::vector<std::uint16_t> ids_in(const ImageU16& labels) {
  std::vector<std::uint8_t> seen(65536, 0);
  for (const std::uint16_t id : labels.data) seen[id] = 1;
  std::vector<std::uint16_t> ids;
  for (std::size_t id = 1; id < seen.size(); ++id)
    if (seen[id]) ids.push_back(std::uint16_t(id));
  return ids;
}

void swap_and_drop(ImageU16& labels, const MaskNoise& noise, int view, std::uint64_t seed) {
  const std::vector<std::uint16_t> ids = ids_in(labels);
  std::vector<std::uint16_t> renamed(65536);
  for (std::size_t i = 0; i < renamed.size(); ++i) renamed[i] = std::uint16_t(i);
  const Draws swaps(seed, view, kSwap), drops(seed, view, kDrop);
  for (std::size_t i = 0; ids.size() > 1 && i < ids.size(); ++i) {
    if (swaps.uniform(2 * ids[i]) >= noise.swap) continue;
    const std::size_t step = 1 + std::size_t(swaps.uniform(2 * ids[i] + 1) * double(ids.size() - 1));
    std::swap(renamed[ids[i]], renamed[ids[(i + step) % ids.size()]]);
  }
  for (const std::uint16_t id : ids)
    if (drops.uniform(id) < noise.drop)
      for (std::uint16_t& name : renamed)
        if (name == id) name = 0;
  for (std::uint16_t& id : labels.data) id = renamed[id];
}

/// Pairs of different ids > 0 in pixels that touch, both ways, sorted.
std::vector<std::pair<std::uint16_t, std::uint16_t>> neighbours_in(const ImageU16& labels) {
  std::set<std::pair<std::uint16_t, std::uint16_t>> pairs;
  const auto note = [&](std::uint16_t a, std::uint16_t b) {
    if (a == b || a == 0 || b == 0) return;
    pairs.insert({a, b});
    pairs.insert({b, a});
  };
  for (int y = 0; y < labels.height_px; ++y)
    for (int x = 0; x < labels.width_px; ++x) {
      if (x > 0) note(labels.at(x - 1, y), labels.at(x, y));
      if (y > 0) note(labels.at(x, y - 1), labels.at(x, y));
    }
  return {pairs.begin(), pairs.end()};
}

void merge_neighbours(ImageU16& labels, double probability, const Draws& draws) {
  const auto pairs = neighbours_in(labels);
  std::vector<std::uint16_t> name(65536);
  std::iota(name.begin(), name.end(), std::uint16_t(0));
  for (auto first = pairs.begin(); first != pairs.end();) {
    const std::uint16_t id = first->first;
    const auto last = std::find_if(first, pairs.end(), [&](const auto& pair) { return pair.first != id; });
    if (draws.uniform(2 * id) < probability) {
      const auto k = std::size_t(draws.uniform(2 * id + 1) * double(last - first));
      const std::uint16_t from = name[first[std::ptrdiff_t(k)].second];
      std::replace(name.begin(), name.end(), from, name[id]);
    }
    first = last;
  }
  for (std::uint16_t& id : labels.data) id = name[id];
}

/// Cuts masks in two by a line through their centroid.
void split_masks(ImageU16& labels, double probability, const Draws& draws) {
  const std::vector<std::uint16_t> ids = ids_in(labels);
  struct Cut {
    double x = 0, y = 0, pixels = 0, angle = 0;
    std::uint16_t other = 0;  // 0: whole
  };
  std::vector<Cut> cuts(65536);
  int next = ids.empty() ? 0 : ids.back();
  for (const std::uint16_t id : ids)
    if (draws.uniform(2 * id) < probability && next < 65535) {
      cuts[id].other = std::uint16_t(++next);
      cuts[id].angle = 2 * std::numbers::pi * draws.uniform(2 * id + 1);
    }
  const auto for_each_pixel = [&](auto&& visit) {
    for (int y = 0; y < labels.height_px; ++y)
      for (int x = 0; x < labels.width_px; ++x)
        if (labels.at(x, y) != 0) visit(x, y, labels.at(x, y));
  };
  for_each_pixel([&](int x, int y, std::uint16_t id) {
    Cut& cut = cuts[id];
    cut.x += x;
    cut.y += y;
    ++cut.pixels;
  });
  for_each_pixel([&](int x, int y, std::uint16_t& id) {
    const Cut& cut = cuts[id];
    const double across =
        (x - cut.x / cut.pixels) * std::cos(cut.angle) + (y - cut.y / cut.pixels) * std::sin(cut.angle);
    if (cut.other != 0 && across > 0) id = cut.other;
  });
}

/// Adds surfaces of room and furniture, where the labels are 0.
void add_background(ImageU16& labels, const ImageU16& surfaces, double probability, const Draws& draws) {
  for (std::size_t p = 0; p < labels.data.size(); ++p)
    if (labels.data[p] == 0 && draws.uniform(surfaces.data[p]) < probability) labels.data[p] = surfaces.data[p];
}

void shuffle_ids(ImageU16& labels, const Draws& draws) {
  std::vector<std::uint16_t> ids = ids_in(labels), name(65536);
  for (std::size_t i = ids.size(); i > 1; --i) std::swap(ids[i - 1], ids[std::size_t(draws.uniform(i) * double(i))]);
  for (std::size_t i = 0; i < ids.size(); ++i) name[ids[i]] = std::uint16_t(i + 1);
  for (std::uint16_t& id : labels.data) id = name[id];
}

/// Smooth random field of unit variance: normal numbers on a lattice, interpolated and divided by the root of the
/// squared weights' sum.
double smooth_normal(const Draws& draws, std::uint64_t channel, double x, double y) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto ease = [](double t) { return t * t * (3 - 2 * t); };
  const double u = ease(x - fx), v = ease(y - fy);
  double sum = 0, squares = 0;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const double w = (i ? u : 1 - u) * (j ? v : 1 - v);
      const auto node = (std::uint64_t(fx) + std::uint64_t(i)) | ((std::uint64_t(fy) + std::uint64_t(j)) << 20);
      sum += w * draws.normal(node | channel << 40);
      squares += w * w;
    }
  return sum / std::sqrt(squares);
}

void jitter(const Exec& exec, ImageU16& labels, double sigma_px, int view, std::uint64_t seed) {
  const ImageU16 exact = labels;
  const Draws draws(seed, view, kJitter);
  const double wavelength_px = 8 + 4 * sigma_px;  // long compared with the displacement, so that contours do not fold
  for_each_index(exec, labels.height_px, [&](std::int64_t row) {
    const int y = int(row);
    for (int x = 0; x < labels.width_px; ++x) {
      const double u = x / wavelength_px, v = y / wavelength_px;
      const int sx = int(std::lround(x + sigma_px * smooth_normal(draws, 0, u, v)));
      const int sy = int(std::lround(y + sigma_px * smooth_normal(draws, 1, u, v)));
      labels.at(x, y) = exact.at(std::clamp(sx, 0, labels.width_px - 1), std::clamp(sy, 0, labels.height_px - 1));
    }
  });
}

/// An offset within a disc; disc() lists them nearest first.
struct Offset {
  int dx, dy, distance2;
};
std::vector<Offset> disc(double radius_px) {
  std::vector<Offset> offsets;
  const int reach = int(std::floor(radius_px));
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx)
      if (dx * dx + dy * dy <= radius_px * radius_px && (dx || dy)) offsets.push_back({dx, dy, dx * dx + dy * dy});
  std::stable_sort(offsets.begin(), offsets.end(), [](Offset a, Offset b) { return a.distance2 < b.distance2; });
  return offsets;
}

/// Replaces the id of a pixel if rule(own id, neighbour id) is true for a neighbour in the disc around it: id 0 becomes
/// that of the nearest such neighbour, any other id becomes 0.
template <class Rule>
void morph(const Exec& exec, ImageU16& labels, double radius_px, const Rule& rule) {
  const ImageU16 before = labels;
  const std::vector<Offset> offsets = disc(radius_px);
  for_each_index(exec, labels.height_px, [&](std::int64_t row) {
    const int y = int(row);
    for (int x = 0; x < labels.width_px; ++x)
      for (const Offset o : offsets) {
        const int nx = x + o.dx, ny = y + o.dy;
        if (nx < 0 || ny < 0 || nx >= labels.width_px || ny >= labels.height_px) continue;
        if (!rule(before.at(x, y), before.at(nx, ny))) continue;
        labels.at(x, y) = before.at(x, y) == 0 ? before.at(nx, ny) : std::uint16_t(0);
        break;
      }
  });
}

struct Point {
  int x, y;
};
std::vector<Point> contour_of(const ImageU16& labels, std::uint16_t id, double& area_px) {
  std::vector<Point> contour;
  area_px = 0;
  for (int y = 0; y < labels.height_px; ++y)
    for (int x = 0; x < labels.width_px; ++x) {
      if (labels.at(x, y) != id) continue;
      ++area_px;
      const bool inner = x > 0 && y > 0 && x + 1 < labels.width_px && y + 1 < labels.height_px;
      if (inner && (labels.at(x - 1, y) != id || labels.at(x + 1, y) != id || labels.at(x, y - 1) != id ||
                    labels.at(x, y + 1) != id))
        contour.push_back({x, y});
    }
  return contour;
}

void add_blobs(ImageU16& labels, double probability, int view, std::uint64_t seed) {
  const Draws draws(seed, view, kBlob);
  for (const std::uint16_t id : ids_in(labels)) {
    const auto draw = [&](std::uint64_t k) { return draws.uniform(8ull * id + k); };
    if (draw(0) >= probability) continue;
    double area_px = 0;
    const std::vector<Point> contour = contour_of(labels, id, area_px);
    if (contour.empty()) continue;
    const Point centre = contour[std::min(contour.size() - 1, std::size_t(draw(1) * double(contour.size())))];
    const double size = std::max(2.0, std::sqrt(area_px / std::numbers::pi));  // radius of a disc of that area
    const double a = size * (0.2 + 0.25 * draw(2)), b = a * (0.4 + 0.6 * draw(3)), angle = std::numbers::pi * draw(4);
    const double c = std::cos(angle), s = std::sin(angle);
    const bool adds = draw(5) < 0.5;
    for (int y = 0; y < labels.height_px; ++y)
      for (int x = 0; x < labels.width_px; ++x) {
        const double dx = x - centre.x, dy = y - centre.y, u = (c * dx + s * dy) / a, v = (c * dy - s * dx) / b;
        if (u * u + v * v > 1) continue;
        if (adds && labels.at(x, y) == 0) labels.at(x, y) = id;
        if (!adds && labels.at(x, y) == id) labels.at(x, y) = 0;
      }
  }
}

[[noreturn]] void fail(const std::string& spec, NoiseOf of) {
  const std::string more = of == NoiseOf::kLabelMaps    ? "swap:P "
                           : of == NoiseOf::kEverything ? "swap:P, merge:P, split:P, background:P "
                                                        : "";
  throw Error(ErrorCode::kUsage,
              "mask noise: \"" + spec +
                  "\", expected erode:PX, dilate:PX, jitter:PX (0..200), snap:PX (0..50), drop:P, " + more +
                  "or blob:P (0..1)",
              "several are joined by commas: --mask-noise jitter:1,drop:0.1");
}

void parse_one(const std::string& spec, NoiseOf of, MaskNoise& noise) {
  const std::size_t colon = spec.find(':');
  if (colon == std::string::npos) fail(spec, of);
  const std::string kind = spec.substr(0, colon), number = spec.substr(colon + 1);
  double value = 0;
  if (!parse_number(number, value) || !(value >= 0)) fail(spec, of);
  const auto set = [&](double& field, double most) {
    if (value > most) fail(spec, of);
    field = value;
  };
  if (kind == "erode")
    set(noise.erode_px, 200);
  else if (kind == "dilate")
    set(noise.dilate_px, 200);
  else if (kind == "jitter")
    set(noise.jitter_px, 200);
  else if (kind == "drop")
    set(noise.drop, 1);
  else if (kind == "snap")
    set(noise.snap_px, 50);
  else if (kind == "swap" && of != NoiseOf::kOneObject)
    set(noise.swap, 1);
  else if (kind == "merge" && of == NoiseOf::kEverything)
    set(noise.merge, 1);
  else if (kind == "background" && of == NoiseOf::kEverything)
    set(noise.background, 1);
  else if (kind == "split" && of == NoiseOf::kEverything)
    set(noise.split, 1);
  else if (kind == "blob")
    set(noise.blob, 1);
  else
    fail(spec, of);
}

}  // namespace

MaskNoise parse_mask_noise(std::span<const std::string> specs, NoiseOf of) {
  MaskNoise noise;
  for (const std::string& list : specs)
    for (std::size_t begin = 0; begin <= list.size();) {
      const std::size_t end = std::min(list.find(',', begin), list.size());
      parse_one(list.substr(begin, end - begin), of, noise);
      begin = end + 1;
    }
  return noise;
}

ImageU16 disturb_labels(const Exec& exec, const ImageU16& labels, const MaskNoise& noise, const MaskDraw& draw) {
  const auto& [only_id, view, seed, photo, surfaces] = draw;
  ImageU16 result = labels;
  swap_and_drop(result, noise, view, seed);
  if (only_id > 0)
    for (std::uint16_t& id : result.data) id = id == only_id ? 1 : 0;
  if (noise.snap_px > 0 && photo != nullptr) result = snap_contours(exec, result, *photo, noise.snap_px);
  if (noise.jitter_px > 0) jitter(exec, result, noise.jitter_px, view, seed);
  if (noise.dilate_px > 0)
    morph(exec, result, noise.dilate_px, [](std::uint16_t own, std::uint16_t other) { return own == 0 && other != 0; });
  if (noise.erode_px > 0)
    morph(exec, result, noise.erode_px,
          [](std::uint16_t own, std::uint16_t other) { return own != 0 && other != own; });
  if (noise.blob > 0) add_blobs(result, noise.blob, view, seed);
  return result;
}

ImageU16 masks_of_everything(const Exec& exec, const ImageU16& labels, const MaskNoise& noise, const MaskDraw& draw) {
  ImageU16 result = labels;
  if (noise.merge > 0) merge_neighbours(result, noise.merge, {draw.seed, draw.view, kMerge});
  if (noise.background > 0 && draw.surfaces != nullptr)
    add_background(result, *draw.surfaces, noise.background, {draw.seed, draw.view, kBackground});
  if (noise.split > 0) split_masks(result, noise.split, {draw.seed, draw.view, kSplit});
  result = disturb_labels(exec, result, noise, draw);
  shuffle_ids(result, {draw.seed, draw.view, kShuffle});
  return result;
}

std::vector<int> mask_assignment(int views, double missing, double wrong, std::uint64_t seed) {
  std::vector<int> assigned(static_cast<std::size_t>(views)), order(assigned.size());
  std::iota(assigned.begin(), assigned.end(), 0);
  std::iota(order.begin(), order.end(), 0);
  const Draws draws(seed, 0, kAssignment);
  for (std::size_t i = order.size(); i-- > 1;)
    std::swap(order[i], order[std::size_t(draws.uniform(i) * double(i + 1))]);
  const auto count = [&](double share) { return std::size_t(std::llround(share * views)); };
  const std::size_t none = std::min(count(missing), order.size()), last = std::min(none + count(wrong), order.size());
  for (std::size_t i = 0; i < last; ++i) {
    const int view = order[i], step = 1 + int(draws.uniform(order.size() + i) * (views - 1));
    assigned[std::size_t(view)] = i < none || views < 2 ? -1 : (view + step) % views;
  }
  return assigned;
}

}  // namespace ngs::synth
