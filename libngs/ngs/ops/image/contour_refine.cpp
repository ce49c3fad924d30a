#include "ngs/ops/image/contour_refine.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "ngs/core/check.h"
#include "ngs/math/stable.h"
#include "ngs/ops/image/pixel_window.h"

namespace ngs {
namespace {

constexpr double kMinWeight = 1e-5;    // keeps the graph connected across any edge
constexpr double kShapeWidth_px = 2;   // of the sigmoid s
constexpr double kColourNoise = 3e-4;  // least variance of a colour, (share of full scale)²
constexpr double kColourGap_px = 2;    // nearer pixels are mixed: no colours are learned from them
constexpr double kOutliers = 0.1;      // share of colours that neither density explains
constexpr double kMinSupport = 1e-4;   // share of a neighbourhood below which its colours are unknown
constexpr double kTolerance = 1e-4;    // of the solution: contours move by less than a hundredth of a pixel
constexpr int kCellsOfRadius = 5;      // a blur runs on cells of pixels, this many per radius: too fine to be visible

/// Chessboard distance to the contour, positive inside, from pixel centres: ±0.5 at the contour itself.
std::vector<float> contour_distance(MaskPlane mask) {
  const std::vector<std::int32_t> distance = signed_distance(mask);
  std::vector<float> d(distance.size());
  for (std::size_t p = 0; p < d.size(); ++p) d[p] = float(distance[p]) + (distance[p] > 0 ? -0.5f : 0.5f);
  return d;
}

/// The part of the image that the random walks need: the band around the contour and the colours within reach.
PixelWindow window_of(const std::vector<float>& distance, MaskPlane mask, double reach_px) {
  const int w = mask.width_px, h = mask.height_px;
  return window_about(box_where(w, h, [&](std::size_t p) { return std::abs(distance[p]) < reach_px; }), 0, w, h);
}

/// Number of values that are blurred together, each with its own running sum: one cache line.
constexpr int kBlurLanes = 16;

/// `n` places, `stride` values apart, with `lanes` adjacent values each.
struct BlurLine {
  float* first;
  int n;
  std::size_t stride;
  int lanes;
  float& at(int i, int lane) const { return first[std::size_t(i) * stride + std::size_t(lane)]; }
};

/// Three running means of width 2 r + 1 along the line: close to a Gaussian with standard deviation r. Zero outside.
void blur(const BlurLine& line, int r, std::vector<double>& from) {
  const int n = line.n;
  from.resize(std::size_t(n) * kBlurLanes);
  const double scale = 1.0 / (2 * r + 1);
  const auto row = [&](int i) { return &from[std::size_t(i) * kBlurLanes]; };
  for (int pass = 0; pass < 3; ++pass) {
    for (int i = 0; i < n; ++i)
      for (int b = 0; b < line.lanes; ++b) row(i)[b] = double(line.at(i, b));
    double sum[kBlurLanes] = {};
    const auto add = [&](const double* values, double sign) {
      for (int b = 0; b < kBlurLanes; ++b) sum[b] += sign * values[b];
    };
    for (int i = 0; i < std::min(r, n); ++i) add(row(i), 1);
    for (int i = 0; i < n; ++i) {
      if (i + r < n) add(row(i + r), 1);
      for (int b = 0; b < line.lanes; ++b) line.at(i, b) = float(sum[b] * scale);
      if (i >= r) add(row(i - r), -1);
    }
  }
}

/// Local means of N values per pixel: sums over square cells, blurred.
template <int N>
class LocalMeans {
  static_assert(N <= kBlurLanes);

 public:
  LocalMeans(const PixelWindow& win, int r)
      : side_(std::max(1, r / kCellsOfRadius)), r_(r / side_), w_(cells(win.w)), h_(cells(win.h)) {
    values_.resize(std::size_t(w_) * std::size_t(h_) * N);
  }

  /// The N values of the cell of pixel (x, y) of the window: sums to add to; after blur(), local means.
  float* at(int x, int y) { return &values_[cell(x, y) * N]; }
  const float* at(int x, int y) const { return &values_[cell(x, y) * N]; }

  int cell_px() const { return side_; }

  void blur() {
    for (float& v : values_) v /= float(side_ * side_);
    std::vector<double> scratch;
    const std::size_t line = std::size_t(w_) * N;
    for (int y = 0; y < h_; ++y) ngs::blur({&values_[std::size_t(y) * line], w_, N, N}, r_, scratch);
    for (std::size_t x = 0; x < line; x += kBlurLanes)
      ngs::blur({&values_[x], h_, line, int(std::min<std::size_t>(kBlurLanes, line - x))}, r_, scratch);
  }

 private:
  int cells(int px) const { return (px + side_ - 1) / side_; }
  std::size_t cell(int x, int y) const { return std::size_t(y / side_) * std::size_t(w_) + std::size_t(x / side_); }

  int side_, r_, w_, h_;
  std::vector<float> values_;
};

using Colours = std::vector<std::array<float, 3>>;

/// Normal density of colours, from their moments: 1; r g b; rr gr gg br bg bb. A tenth of it is uniform, so a colour
/// that occurs on neither side is no evidence.
class ColourDensity {
 public:
  explicit ColourDensity(const float* moment) {
    const double n = double(moment[0]);
    known_ = n >= kMinSupport;
    if (!known_) return;
    for (std::size_t i = 0; i < 3; ++i) mean_[i] = double(moment[1 + i]) / n;
    for (std::size_t i = 0, m = 4; i < 3; ++i)
      for (std::size_t j = 0; j <= i; ++j, ++m)
        root_[i][j] = double(moment[m]) / n - mean_[i] * mean_[j] + (i == j ? kColourNoise : 0.0);
    // C = L Lᵀ; |L| is at least 1e-6.
    double root_det = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        for (std::size_t k = 0; k < j; ++k) root_[i][j] -= root_[i][k] * root_[j][k];
        root_[i][j] /= root_[j][j];
        root_[i][i] -= root_[i][j] * root_[i][j];
      }
      root_[i][i] = std::sqrt(std::max(root_[i][i], 0.5 * kColourNoise));
      root_det *= root_[i][i];
    }
    constexpr double kNormal = 0.06349363593424097;  // (2 π)^(-3/2)
    scale_ = (1 - kOutliers) * kNormal / root_det;
  }

  /// False: no chosen pixel is near.
  bool known() const { return known_; }

  double operator()(const std::array<float, 3>& colour) const {
    double z[3], square = 0;  // L⁻¹ (colour - mean)
    for (std::size_t i = 0; i < 3; ++i) {
      z[i] = double(colour[i]) - mean_[i];
      for (std::size_t j = 0; j < i; ++j) z[i] -= root_[i][j] * z[j];
      z[i] /= root_[i][i];
      square += z[i] * z[i];
    }
    return scale_ * std::exp(-0.5 * square) + kOutliers;
  }

 private:
  bool known_ = false;
  double mean_[3], root_[3][3], scale_ = 0;
};

/// Local normal density of the colours of the chosen pixels: blurred weights, means and second moments.
class LocalColours {
 public:
  LocalColours(const PixelWindow& win, const Colours& colour, const std::vector<std::uint8_t>& chosen, int r)
      : moments_(win, r) {
    for (int y = 0; y < win.h; ++y)
      for (int x = 0; x < win.w; ++x) {
        const std::size_t p = win.at(x, y);
        if (!chosen[p]) continue;
        const auto [r, g, b] = colour[p];
        const float terms[kMoments] = {1, r, g, b, r * r, g * r, g * g, b * r, b * g, b * b};
        float* sums = moments_.at(x, y);
        for (std::size_t m = 0; m < kMoments; ++m) sums[m] += terms[m];
      }
    moments_.blur();
  }

  /// The density about pixel (x, y), the same for all pixels of a cell.
  ColourDensity at(int x, int y) const { return ColourDensity(moments_.at(x, y)); }

 private:
  static constexpr std::size_t kMoments = 10;
  LocalMeans<kMoments> moments_;
};

/// The photo in the window, relative to its mean colour so that second moments do not cancel. Non-finite values become
/// the mean colour; otherwise they would spread through all local means.
Colours colours_of(const PixelWindow& win, const ImageF& photo) {
  Colours colour(win.pixels());
  double sum[3] = {0, 0, 0}, count[3] = {0, 0, 0};
  for (int y = 0; y < win.h; ++y)
    for (int x = 0; x < win.w; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        const float v = photo.at(win.x0 + x, win.y0 + y, int(c));
        colour[win.at(x, y)][c] = v;
        if (std::isfinite(v)) {
          sum[c] += double(v);
          ++count[c];
        }
      }
  for (auto& v : colour)
    for (std::size_t c = 0; c < 3; ++c) v[c] = std::isfinite(v[c]) ? v[c] - float(sum[c] / count[c]) : 0.f;
  return colour;
}

/// The pixels of the window that the random walks use. Pixels farther from the contour are in no set.
struct Sides {
  std::vector<std::uint8_t> inside, outside;  // side known; colours are learned from these pixels
  std::vector<std::uint8_t> free;             // in the band: side unknown
  explicit Sides(std::size_t pixels) : inside(pixels), outside(pixels), free(pixels) {}
  bool any(std::size_t p) const { return inside[p] || outside[p] || free[p]; }
};

/// 3x3 binomial means: single pixels of a photo are noisy. Border pixels are repeated outside.
Colours smoothed(const PixelWindow& win, const Colours& in) {
  Colours out(in.size());
  std::vector<float> row(std::size_t(win.w + 2) * 3);  // means of three rows, with a pixel more on both sides
  for (int y = 0; y < win.h; ++y) {
    const float* above = in[win.at(0, std::max(y - 1, 0))].data();
    const float* here = in[win.at(0, y)].data();
    const float* below = in[win.at(0, std::min(y + 1, win.h - 1))].data();
    const std::size_t n = std::size_t(win.w) * 3;
    for (std::size_t i = 0; i < n; ++i) row[i + 3] = above[i] + 2 * here[i] + below[i];
    std::copy_n(&row[3], 3, &row[0]);
    std::copy_n(&row[n], 3, &row[n + 3]);
    float* to = out[win.at(0, y)].data();
    for (std::size_t i = 0; i < n; ++i) to[i] = (row[i] + 2 * row[i + 3] + row[i + 6]) / 16;
  }
  return out;
}

double squared_difference(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += double(a[c] - b[c]) * double(a[c] - b[c]);
  return sum;
}

/// Σ (a_i - b_i)², in lanes that the compiler vectorises.
double sum_of_squared_differences(const float* a, const float* b, std::size_t n) {
  constexpr std::size_t kLanes = 8;
  double sum[kLanes] = {};
  const auto add = [&](std::size_t lane, float d) { sum[lane] += double(d) * double(d); };
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes)
    for (std::size_t l = 0; l < kLanes; ++l) add(l, a[i + l] - b[i + l]);
  for (; i < n; ++i) add(0, a[i] - b[i]);
  return std::accumulate(sum, sum + kLanes, 0.0);
}

/// Mean squared colour difference of horizontal and vertical neighbours.
double mean_squared_step(const PixelWindow& win, const Colours& colour) {
  double sum = 0;
  for (int y = 0; y < win.h; ++y) {
    const float* row = colour[win.at(0, y)].data();
    const std::size_t n = std::size_t(win.w) * 3;
    sum += sum_of_squared_differences(row, row + 3, n - 3);
    if (y + 1 < win.h) sum += sum_of_squared_differences(row, row + n, n);
  }
  const double pairs = double(win.w - 1) * win.h + double(win.w) * (win.h - 1);
  return sum / std::max(1.0, pairs);
}

/// Calls f for every cell of the window, with its pixels.
template <class F>
void for_each_cell(const PixelWindow& win, int cell_px, const F& f) {
  for (int y = 0; y < win.h; y += cell_px)
    for (int x = 0; x < win.w; x += cell_px)
      f(PixelWindow{x, y, std::min(cell_px, win.w - x), std::min(cell_px, win.h - y)});
}

bool any_pixel(const PixelWindow& win, const PixelWindow& cell, const Sides& sides) {
  for (int y = cell.y0; y < cell.y0 + cell.h; ++y)
    for (int x = cell.x0; x < cell.x0 + cell.w; ++x)
      if (sides.any(win.at(x, y))) return true;
  return false;
}

struct ColourModels {
  const LocalColours &object, &rest;
  const Colours& colour;
};

/// Object probability by colour, and its reliability.
struct ColourEvidence {
  std::vector<float> object;      // probability of the object; 0.5 where no colour was learned, and outside `sides`
  std::vector<float> confidence;  // r, 0 to 1
};

/// Trust is how well the two densities classify the nearby pixels whose side is known: the local mean of ±(2 c - 1). A
/// texture on both sides, or two colours on one side, make c useless or wrong, which the densities alone do not show.
ColourEvidence weigh_colours(const PixelWindow& win, const ColourModels& models, const Sides& sides, int r) {
  ColourEvidence out{std::vector<float>(win.pixels(), 0.5f), std::vector<float>(win.pixels())};
  LocalMeans<2> agreement(win, r);  // of the known pixels: ±(2 c - 1), and 1
  std::vector<std::uint8_t> learned(win.pixels());
  for_each_cell(win, agreement.cell_px(), [&](const PixelWindow& cell) {
    if (!any_pixel(win, cell, sides)) return;
    const ColourDensity object = models.object.at(cell.x0, cell.y0), rest = models.rest.at(cell.x0, cell.y0);
    if (!object.known() || !rest.known()) return;
    float* sums = agreement.at(cell.x0, cell.y0);
    for (int y = cell.y0; y < cell.y0 + cell.h; ++y)
      for (int x = cell.x0; x < cell.x0 + cell.w; ++x) {
        const std::size_t p = win.at(x, y);
        if (!sides.any(p)) continue;
        const double in = object(models.colour[p]), ex = rest(models.colour[p]);
        learned[p] = 1;
        out.object[p] = float(in / (in + ex));
        if (!sides.inside[p] && !sides.outside[p]) continue;
        sums[0] += (sides.inside[p] ? 1.f : -1.f) * (2 * out.object[p] - 1);
        sums[1] += 1;
      }
  });
  agreement.blur();
  for (int y = 0; y < win.h; ++y)
    for (int x = 0; x < win.w; ++x) {
      const std::size_t p = win.at(x, y);
      const float* near = agreement.at(x, y);
      if (learned[p] && sides.free[p] && near[1] > float(kMinSupport))
        out.confidence[p] = std::clamp(near[0] / near[1], 0.f, 1.f);
    }
  return out;
}

/// The linear system of the random walks.
struct WalkSystem {
  PixelWindow win;
  std::vector<float> given;         // the mask, 0 or 1
  std::vector<std::int32_t> index;  // row of the system; -1: fixed
  std::vector<double> shape;        // [rows] s, where the solution starts
  std::vector<double> diagonal, right;
};

using WalkMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Edge weights between neighbouring pixels.
struct EdgeWeights {
  const Colours& colour;
  double mean_square;  // mean of the squared difference of neighbours
  double operator()(std::size_t p, std::size_t q, bool diagonal) const {
    const double distance_px = diagonal ? std::numbers::sqrt2 : 1;
    return (std::exp(-squared_difference(colour[p], colour[q]) / mean_square) + kMinWeight) / distance_px;
  }
};

/// Adds the row of pixel (x, y), in the storage order of the matrix: by column.
void add_row(WalkSystem& system, const EdgeWeights& weight, int x, int y, WalkMatrix& matrix) {
  const PixelWindow& win = system.win;
  const std::size_t p = win.at(x, y);
  const int row = system.index[p];
  double& diagonal = system.diagonal[std::size_t(row)];
  double* own = nullptr;  // the diagonal's entry
  matrix.startVec(row);
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, win.h - 1); ++v)
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, win.w - 1); ++u) {
      const std::size_t q = win.at(u, v);
      if (q == p) {
        own = &matrix.insertBack(row, row);
        continue;
      }
      const double w = weight(p, q, u != x && v != y);
      diagonal += w;
      if (system.index[q] >= 0)
        matrix.insertBack(row, system.index[q]) = -w;
      else
        system.right[std::size_t(row)] += w * double(system.given[q]);
    }
  *own = diagonal;
}

std::vector<double> solve(WalkSystem& system, const Colours& colour) {
  const PixelWindow& win = system.win;
  const EdgeWeights weight{colour, std::max(mean_squared_step(win, colour), 1e-12)};
  const int n = int(system.diagonal.size());
  WalkMatrix matrix(n, n);
  matrix.reserve(std::ptrdiff_t(n) * 9);  // so that entries are never moved
  for (int y = 0; y < win.h; ++y)
    for (int x = 0; x < win.w; ++x)
      if (system.index[win.at(x, y)] >= 0) add_row(system, weight, x, y, matrix);
  matrix.finalize();
  Eigen::ConjugateGradient<WalkMatrix, Eigen::Lower | Eigen::Upper> cg(matrix);
  cg.setTolerance(kTolerance);
  const Eigen::Map<const Eigen::VectorXd> b(system.right.data(), n);
  const Eigen::Map<const Eigen::VectorXd> start(system.shape.data(), n);
  const Eigen::VectorXd x = cg.solveWithGuess(b, start);
  return {x.data(), x.data() + n};
}

}  // namespace

std::vector<float> refine_contour(const ContourRefineOptions& options, MaskPlane mask, const ImageF& photo) {
  NGS_CHECK(photo.width_px == mask.width_px && photo.height_px == mask.height_px && photo.channels == 3,
            "refine_contour: the photo must be RGB in the size of the mask");
  std::vector<float> out(std::size_t(mask.pixels()));
  for (std::size_t p = 0; p < out.size(); ++p) out[p] = mask.data[p] ? 1.f : 0.f;
  const std::vector<float> distance = contour_distance(mask);
  WalkSystem system;
  system.win = window_of(distance, mask, options.reach_px);
  const PixelWindow& win = system.win;
  if (win.pixels() == 0) return out;
  const auto colour = colours_of(win, photo);
  Sides sides(win.pixels());
  std::vector<float> d(win.pixels());
  system.given.resize(win.pixels());
  system.index.assign(win.pixels(), -1);
  for (int y = 0; y < win.h; ++y)
    for (int x = 0; x < win.w; ++x) {
      const std::size_t p = win.at(x, y);
      const std::size_t full = std::size_t(win.y0 + y) * std::size_t(mask.width_px) + std::size_t(win.x0 + x);
      d[p] = distance[full];
      system.given[p] = out[full];
      const double depth = std::abs(double(d[p]));
      const bool usable = depth > kColourGap_px && depth < options.reach_px;
      sides.inside[p] = usable && d[p] > 0;
      sides.outside[p] = usable && d[p] < 0;
      sides.free[p] = depth <= options.band_px;
    }
  const Colours smooth = smoothed(win, colour);
  const int r = std::max(1, int(std::lround(options.reach_px / 2)));
  const LocalColours object(win, smooth, sides.inside, r), rest(win, smooth, sides.outside, r);
  const ColourEvidence evidence = weigh_colours(win, {object, rest, smooth}, sides, r);
  for (std::size_t p = 0; p < win.pixels(); ++p) {
    if (!sides.free[p]) continue;
    system.index[p] = int(system.diagonal.size());
    const double confidence = double(evidence.confidence[p]), ambiguity = 1 - confidence;
    const double colour_weight = options.colour_weight * confidence,
                 shape_weight = options.shape_weight + options.ambiguity_weight * ambiguity * ambiguity;
    system.diagonal.push_back(shape_weight + colour_weight);
    system.shape.push_back(sigmoid(double(d[p]) / kShapeWidth_px));
    system.right.push_back(shape_weight * system.shape.back() + colour_weight * double(evidence.object[p]));
  }
  const std::vector<double> x = solve(system, colour);
  for (int wy = 0; wy < win.h; ++wy)
    for (int wx = 0; wx < win.w; ++wx) {
      const std::int32_t row = system.index[win.at(wx, wy)];
      if (row < 0) continue;
      out[std::size_t(win.y0 + wy) * std::size_t(mask.width_px) + std::size_t(win.x0 + wx)] =
          float(std::clamp(x[std::size_t(row)], 0.0, 1.0));
    }
  return out;
}

}  // namespace ngs
