#include "ngs/make/synth/mask_noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
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
enum Purpose : std::uint64_t { kSwap, kDrop, kJitter, kBlob, kAssignment };

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
      sum += w * draws.normal(node | channel << 40), squares += w * w;
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
  const std::string swap = of == NoiseOf::kLabelMaps ? "swap:P " : "";
  throw Error(ErrorCode::kUsage,
              "mask noise: \"" + spec +
                  "\", expected erode:PX, dilate:PX, jitter:PX (0..200), snap:PX (0..50), drop:P, " + swap +
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
  else if (kind == "swap" && of == NoiseOf::kLabelMaps)
    set(noise.swap, 1);
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
  const auto& [only_id, view, seed, photo] = draw;
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

std::vector<int> mask_assignment(int views, double missing, double wrong, std::uint64_t seed) {
  std::vector<int> assigned(static_cast<std::size_t>(views)), order(assigned.size());
  std::iota(assigned.begin(), assigned.end(), 0), std::iota(order.begin(), order.end(), 0);
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
