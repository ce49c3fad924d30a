#include "ngs/interactive/ball_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "ngs/backend/for_each.h"
#include "ngs/core/error.h"
#include "ngs/cut/evidence/variance_stage.h"
#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/edit/extract/extract_stage.h"
#include "ngs/edit/select/canonical_points.h"
#include "ngs/edit/select/support_plane.h"
#include "ngs/edit/select/touched_pieces.h"
#include "ngs/interactive/live_mask.h"
#include "ngs/math/sh.h"
#include "ngs/math/stable.h"
#include "ngs/math/vectors.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/problem/cloud_rows.h"

namespace ngs::live {
namespace {

using orbit::Vec;

constexpr std::size_t kMinSurrounded = 2;  // least number of views with a background stroke around the object
constexpr double kBand = 0.02;             // half-width of the free band around the expected contour, of the diagonal
constexpr double kMinAbove = 0.9;          // least fraction above the plane of the weight under object strokes
constexpr double kMaxAbove = 0.1;          // largest fraction above the plane of the weight under background strokes
constexpr double kRimBand = 0.04;          // unevenness of the plane, as a fraction of the object's height
constexpr double kColourRadius = 0.5;      // distance below which colours count as similar, of the cube's edge

std::vector<std::int64_t> rows_in(const GaussianCloud& cloud, const orbit::Ball& ball) {
  std::vector<std::int64_t> rows;
  for (std::int64_t i = 0; i < cloud.size(); ++i) {
    const Vec3<double> d = world_position(cloud, std::size_t(i)) - ball.centre;
    if (cloud.usable[std::size_t(i)] && dot(d, d) <= ball.radius * ball.radius) rows.push_back(i);
  }
  return rows;
}

/// The corner of the colour cube with the least opacity of Gaussians of similar colour.
Vec3<float> unused_colour(const GaussianCloud& cloud) {
  std::array<double, 8> like{};
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i)
    for (std::size_t corner = 0; corner < 8; ++corner) {
      double distance2 = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const double value = std::clamp(colour_of_dc(double(cloud.sh_dc[3 * i + c])), 0.0, 1.0);
        const double step = value - double(corner >> c & 1);
        distance2 += step * step;
      }
      if (distance2 < kColourRadius * kColourRadius) like[corner] += sigmoid(double(cloud.logit_opacity[i]));
    }
  const auto best = std::size_t(std::min_element(like.begin(), like.end()) - like.begin());
  return {float(best & 1), float(best >> 1 & 1), float(best >> 2 & 1)};
}

/// Hints of a view from `expected`, the fraction of the object in every pixel.
ViewPrompt prompt_of(const ImageF& expected) {
  const std::size_t pixels = expected.data.size();
  Consensus consensus{expected.width_px, expected.height_px, expected.data, std::vector<float>(pixels, 1.f), {}};
  consensus.alone = consensus.object;
  const double diagonal = std::hypot(double(expected.width_px), double(expected.height_px));
  return prompt_from(consensus, int(std::lround(kBand * diagonal)), {});
}

/// Rendering weight of every Gaussian of the ball over the certain pixels of the marked views, [rows].
struct MarkedWeights {
  std::vector<double> object, background;
  static double share(const std::vector<double>& weight, const std::vector<std::uint8_t>& of) {
    double inside = 0, whole = 0;
    for (std::size_t i = 0; i < weight.size(); ++i) {
      whole += weight[i];
      inside += of[i] ? weight[i] : 0;
    }
    return whole > 0 ? inside / whole : 0;
  }
};

Vec mean_position(const std::vector<Vec>& position, const std::vector<double>& weight) {
  Vec sum{0, 0, 0};
  double whole = 0;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    sum = sum + weight[i] * position[i];
    whole += weight[i];
  }
  return (1 / whole) * sum;
}

/// Gaussians just above the plane with nothing higher over them are the rim of the supporting surface, not the object.
void remove_rim(Vec normal, const std::vector<Vec>& at, const std::vector<double>& height,
                std::vector<std::uint8_t>& above) {
  const double band = kRimBand * orbit::weighted_quantile(height, {above.begin(), above.end()}, 0.98);
  if (!(band > 0)) return;
  const Vec a = orbit::perpendicular(normal), b = cross(normal, a);
  const auto cell = [&](std::size_t i) {
    return std::pair(std::int64_t(std::floor(dot(a, at[i]) / band)), std::int64_t(std::floor(dot(b, at[i]) / band)));
  };
  std::set<std::pair<std::int64_t, std::int64_t>> covered;
  for (std::size_t i = 0; i < above.size(); ++i)
    if (above[i] && height[i] > band) covered.insert(cell(i));
  for (std::size_t i = 0; i < above.size(); ++i)
    if (above[i] && height[i] <= band && !covered.contains(cell(i))) above[i] = 0;
}

struct PromptedView {
  ImageU8 picture;
  ViewPrompt prompt;
  PixelMask mask() const { return live_mask(picture, prompt, 0); }
};

/// The ball's Gaussians as a model of their own.
class BallModel {
 public:
  BallModel(const Exec& exec, const BallCutInput& in)
      : exec_(exec), rows_(rows_in(in.cloud, in.ball)), splat_(in.splat) {
    if (rows_.empty())
      throw Error(ErrorCode::kNothingFound,
                  "the ball of radius " + std::to_string(in.ball.radius) + ": no Gaussian lies in it, expected some",
                  "centre and radius are in the coordinates of the model's file");
    cloud_ = gather_rows(exec, in.cloud, rows_);
    splat_.prepared = nullptr;
    splat_ = prepared_for(exec, splat_, cloud_);
    request_.background = unused_colour(cloud_);
  }

  const GaussianCloud& cloud() const { return cloud_; }
  const SplatOptions& splat() const { return splat_; }
  const std::vector<std::int64_t>& rows() const { return rows_; }

  /// [rows] 1: within the strokes that surround the object in each of these views, and above the plane that continues
  /// outside of them.
  std::vector<float> expected(const std::vector<Camera>& cameras, const std::map<std::size_t, ViewPrompt>& surrounded,
                              Vec up) const {
    std::vector<std::uint8_t> within(rows_.size(), 1);
    for (const auto& [view, prompt] : surrounded)
      for_each_index(exec_, std::int64_t(rows_.size()),
                     [this, &within, &camera = cameras[view], &prompt = prompt](std::int64_t i) {
                       within[std::size_t(i)] &= std::uint8_t(is_within(camera, prompt, std::size_t(i)));
                     });
    const SupportPlane plane = plane_outside(within, up);
    std::vector<float> share(within.begin(), within.end());
    for (std::size_t i = 0; i < share.size() && plane.found; ++i)
      if (dot(plane.normal, position(i)) - plane.offset <= plane.thickness) share[i] = 0;
    return share;
  }

  MarkedWeights marked_weights(const std::vector<Camera>& cameras,
                               const std::map<std::size_t, ViewPrompt>& marked) const {
    WeightSums<> sums(cloud_.size(), 2);
    for (const auto& [view, prompt] : marked) {
      ViewMasks masks = known_view(cameras[view]);
      for (const PixelHint side : {PixelHint::kObject, PixelHint::kBackground}) {
        const PixelMask marked_pixels = pixels_with(prompt, side);
        masks.target.emplace_back(marked_pixels.begin(), marked_pixels.end());
      }
      sums.add(view_sums(exec_, cloud_, {cameras[view], masks}, splat_));
    }
    MarkedWeights weights;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      weights.object.push_back(sums.object_weight(i, 0));
      weights.background.push_back(sums.object_weight(i, 1));
    }
    return weights;
  }

  /// [rows] 1: above a plane that separates the strokes on the object (above) from those on background (below), in a
  /// piece that the former touch. Empty if there is no such plane. Tries `up`, then the axis nearest to the direction
  /// from background to object strokes, for images that are rotated by 90 degrees.
  std::vector<float> above_plane(const MarkedWeights& marked, const std::vector<ViewSums>& strokes, Vec up) const {
    if (std::ranges::max(marked.object) <= 0 || std::ranges::max(marked.background) <= 0) return {};
    std::vector<Vec> at;
    for (std::size_t i = 0; i < rows_.size(); ++i) at.push_back(position(i));
    const Vec direction = mean_position(at, marked.object) - mean_position(at, marked.background);
    Vec axis{0, 0, 0};
    double farthest = 0;
    for (const Vec& a : {Vec{1, 0, 0}, Vec{0, 1, 0}, Vec{0, 0, 1}})
      if (const double along = dot(a, direction); std::abs(along) > std::abs(farthest)) {
        farthest = along;
        axis = a;
      }
    for (const Vec& upwards : {up, std::copysign(1.0, farthest) * axis}) {
      const std::vector<std::uint8_t> found = touched_pieces(exec_, cloud_, above(marked, at, upwards), strokes).object;
      if (MarkedWeights::share(marked.object, found) >= kMinAbove &&
          MarkedWeights::share(marked.background, found) <= kMaxAbove)
        return {found.begin(), found.end()};
    }
    return {};
  }

  /// A view with hints from expected() and marks. Empty pixels are background, except under strokes on the object.
  PromptedView prompted(const Camera& camera, const ViewPrompt* marks, const std::vector<float>& expected) const {
    const RenderedView view = render_from(camera, expected);
    ViewPrompt prompt = prompt_of(view.label);
    if (marks != nullptr) keep_strokes(*marks, prompt);
    return with_empty(view, std::move(prompt));
  }
  PixelMask segment(const Camera& camera, ViewPrompt prompt) const {
    return with_empty(render_from(camera, {}), std::move(prompt)).mask();
  }

 private:
  RenderedView render_from(const Camera& camera, const std::vector<float>& channel) const {
    RenderRequest request = request_;
    if (!channel.empty()) request.label = {channel.data(), cloud_.size(), 1};
    return render(exec_, cloud_, camera, splat_, request);
  }

  static PromptedView with_empty(const RenderedView& view, ViewPrompt prompt) {
    empty_is_background(view.alpha.data, prompt);
    return {to_bytes(view.colour), std::move(prompt)};
  }

  Vec position(std::size_t i) const {
    const float* p = &cloud_.position[3 * i];
    return {double(p[0]), double(p[1]), double(p[2])};
  }

  bool is_within(const Camera& camera, const ViewPrompt& prompt, std::size_t i) const {
    const std::optional<Vec3<double>> at = camera.project(world_position(cloud_, i));
    if (!at) return false;
    const std::size_t pixel = std::size_t(at->y) * std::size_t(prompt.width_px) + std::size_t(at->x);
    return prompt.hint[pixel] != PixelHint::kBackground;
  }

  /// [rows] 1: above the support plane between the background strokes and the lower object strokes. All 0 without one.
  std::vector<std::uint8_t> above(const MarkedWeights& marked, const std::vector<Vec>& at, Vec up) const {
    std::vector<std::uint8_t> found(rows_.size());
    std::vector<double> height;
    for (const Vec& p : at) height.push_back(dot(up, p));
    const double low = orbit::weighted_quantile(height, marked.background, 0.1),
                 high = orbit::weighted_quantile(height, marked.object, 0.25);
    const orbit::SurfacePoints between =
        points_where([&](std::uint32_t row) { return height[row] >= low && height[row] <= high; });
    const SupportPlane plane = refined_by(cloud_, between, find_support_plane(cloud_, between, up));
    if (!plane.found) return found;
    for (std::size_t i = 0; i < found.size(); ++i) {
      height[i] = dot(plane.normal, at[i]) - plane.offset - plane.thickness;
      found[i] = height[i] > 0;
    }
    remove_rim(plane.normal, at, height, found);
    return found;
  }

  orbit::SurfacePoints points_where(const auto& wanted) const {
    const orbit::SurfacePoints all = canonical_points(cloud_);
    orbit::SurfacePoints some;
    for (std::size_t i = 0; i < all.count(); ++i)
      if (wanted(all.row[i])) some.add(all, i);
    return some;
  }

  SupportPlane plane_outside(const std::vector<std::uint8_t>& within, Vec up) const {
    const orbit::SurfacePoints outside = points_where([&](std::uint32_t row) { return !within[row]; });
    return refined_by(cloud_, canonical_points(cloud_), find_support_plane(cloud_, outside, up));
  }

  const Exec& exec_;
  std::vector<std::int64_t> rows_;
  GaussianCloud cloud_;
  SplatOptions splat_;
  RenderRequest request_;
};

/// Mean up axis of the cameras. Assumes that level cameras surround the object.
Vec up_of(const std::vector<Camera>& cameras) {
  Vec sum{0, 0, 0};
  for (const Camera& c : cameras) sum = sum - Vec{c.rotation(1, 0), c.rotation(1, 1), c.rotation(1, 2)};
  return length(sum) > 0 ? unit(sum) : Vec{0, -1, 0};
}

struct PromptMasks {
  const std::map<std::size_t, ViewPrompt>& marked;  // by view
  std::vector<float> expected;                      // BallModel::expected()
};

/// Segments every view independently, from the object expected there: batches are rendered one by one, then segmented
/// in parallel.
void segment_all(const Exec& exec, Monitor& monitor, const BallModel& model, const PromptMasks& prompts, BallCut& cut) {
  const auto timed = monitor.scope("masks");
  const std::size_t batch = 4 * std::size_t(exec.threads);
  for (std::size_t begin = 0; begin < cut.cameras.size() && !monitor.stop_requested(); begin += batch) {
    std::vector<PromptedView> views;
    for (std::size_t v = begin; v < std::min(cut.cameras.size(), begin + batch); ++v) {
      const auto marks = prompts.marked.find(v);
      const bool is_marked = marks != prompts.marked.end();
      views.push_back(model.prompted(cut.cameras[v], is_marked ? &marks->second : nullptr, prompts.expected));
      cut.views[v].source = !is_marked ? MaskSource::kSegmented : MaskSource::kReference;
    }
    for_each_task(exec, std::int64_t(views.size()),
                  [&](std::int64_t k) { cut.views[begin + std::size_t(k)].mask = views[std::size_t(k)].mask(); });
    monitor.progress(std::int64_t(begin + views.size()), std::int64_t(cut.cameras.size()));
  }
}

bool has_evidence(const SpreadView& view) {
  return view.source == MaskSource::kReference || view.source == MaskSource::kSegmented;
}

/// Labels of the ball's Gaussians from the masks of all training and marked views. A Gaussian visible only through a
/// surface is object if its neighbours are, or if most of its small weight lies inside the masks; one without weight,
/// if its neighbours are.
LabelColumns labels_in_ball(const Exec& exec, const BallModel& model, const BallCutInput& in, const BallCut& cut) {
  EvidenceSum sum(exec, model.cloud(), 1, model.splat());
  for (std::size_t v = 0; v < cut.views.size(); ++v)
    if (has_evidence(cut.views[v]) && (in.scene.views[v].split == Split::kTrain || in.marks.contains(v)))
      sum.add({cut.cameras[v], known_view(cut.cameras[v], cut.views[v].mask)});
  const Evidence evidence = sum.result();
  LabelColumns labels = std::move(label_gaussians({}, evidence)[0]);
  const std::vector<float> own = labels.label.values();
  for (std::size_t i = 0; i < labels.views.size(); ++i)  // Gaussians visible only through a surface are not part of it
    if (evidence.weight.value(i) < kMinMeanWeight * double(evidence.pixels[i]))
      for (const auto column : kLabelColumns) (labels.*column)[i] = 0;
  const Extraction decided = extract_object(exec, {}, {model.cloud(), labels});
  std::vector<float> label(decided.object.begin(), decided.object.end());
  for (std::size_t i = 0; i < label.size(); ++i)  // hidden Gaussians: neighbours or the masks behind which they lie
    if (labels.views[i] == 0 && evidence.weight.value(i) > 0 && label[i] == 0) label[i] = own[i];
  labels.label = label;
  return labels;
}

/// The Gaussians inside each mask that was segmented.
std::vector<ViewSums> mask_weights(const Exec& exec, const BallModel& model, const BallCut& cut) {
  std::vector<ViewSums> inside;
  for (std::size_t v = 0; v < cut.views.size(); ++v)
    if (has_evidence(cut.views[v]))
      inside.push_back(
          view_sums(exec, model.cloud(), {cut.cameras[v], known_view(cut.cameras[v], cut.views[v].mask)}, model.splat())
              .weights_inside(0));
  return inside;
}

void remove_floor(const BallModel& model, const BallCut& cut, LabelColumns& labels) {
  std::vector<std::uint8_t> object(labels.label.begin(), labels.label.end());
  remove_support(model.cloud(), up_of(cut.cameras), object);
  labels.label = std::vector<float>(object.begin(), object.end());
}

/// The columns of the full model.
LabelColumns spread_out(const LabelColumns& part, const std::vector<std::int64_t>& rows, std::int64_t gaussians) {
  LabelColumns whole;
  for (const auto column : kLabelColumns) {
    (whole.*column).assign(std::size_t(gaussians), float(column == &LabelColumns::views));
    for (std::size_t i = 0; i < rows.size(); ++i) (whole.*column)[std::size_t(rows[i])] = (part.*column)[i];
  }
  return whole;
}

}  // namespace

BallCut cut_in_ball(const Exec& exec, Monitor& monitor, const BallCutInput& in) {
  BallCut cut;
  for (const SceneView& view : in.scene.views) cut.cameras.push_back(at_segmented_size(view.camera, in.longer_side_px));
  cut.views.resize(cut.cameras.size());
  std::map<std::size_t, ViewPrompt> marked, surrounded;
  for (const auto& [view, hand] : in.marks) {
    marked[view] = rasterise(hand, cut.cameras[view].width_px, cut.cameras[view].height_px);
    if (fill_surrounded(marked[view])) surrounded[view] = marked[view];
  }
  const BallModel model(exec, in);
  cut.in_ball = model.cloud().size();
  std::vector<ViewSums> strokes;
  for (const auto& [view, prompt] : marked)
    std::ranges::move(stroke_weights(exec, model.cloud(), cut.cameras[view], prompt, model.splat()),
                      std::back_inserter(strokes));
  const bool by_lines = surrounded.size() >= kMinSurrounded;
  PromptMasks prompts{marked, {}};
  if (by_lines)
    prompts.expected = model.expected(cut.cameras, surrounded, up_of(cut.cameras));
  else
    prompts.expected = model.above_plane(model.marked_weights(cut.cameras, marked), strokes, up_of(cut.cameras));
  cut.is_expected = !prompts.expected.empty();
  bool is_dense = false;  // most Gaussians are hidden by their neighbours in every view
  if (cut.is_expected) {
    segment_all(exec, monitor, model, prompts, cut);
  } else {
    const auto spread = [&](bool use_neighbours) {
      spread_masks(
          exec, monitor, {.passes = 1},
          {model.cloud(), in.scene, cut.cameras, std::vector<bool>(cut.cameras.size(), true), model.splat(), marked,
           [&](std::size_t view, const ViewPrompt& prompt) { return model.segment(cut.cameras[view], prompt); },
           [&](std::size_t view, const SpreadView& result) { cut.views[view] = result; }, use_neighbours});
    };
    spread(false);
    is_dense = 2 * std::ranges::count_if(cut.views, has_evidence) < std::ssize(cut.views);
    if (is_dense && !monitor.stop_requested()) spread(true);
  }
  if (monitor.stop_requested()) return cut;
  LabelColumns labels = [&] {
    const auto timed = monitor.scope("labels");
    return labels_in_ball(exec, model, in, cut);
  }();
  if (is_dense) remove_floor(model, cut, labels);
  for (std::size_t i = 0; i < prompts.expected.size(); ++i)  // the object occludes part of its plane
    if (labels.views[i] == 0 && (!by_lines || prompts.expected[i] == 0)) labels.label[i] = prompts.expected[i];
  if (!in.all_pieces) {
    const std::vector<std::uint8_t> member(labels.label.begin(), labels.label.end());
    const PieceSelection pieces = touched_pieces(exec, model.cloud(), member, strokes,
                                                 is_dense ? mask_weights(exec, model, cut) : std::vector<ViewSums>());
    labels.label = std::vector<float>(pieces.object.begin(), pieces.object.end());
    cut.removed = pieces.removed;
    cut.needles = pieces.needles;
  }
  cut.object = std::count(labels.label.begin(), labels.label.end(), 1.f);
  cut.labels = spread_out(labels, model.rows(), in.cloud.size());
  return cut;
}

}  // namespace ngs::live
