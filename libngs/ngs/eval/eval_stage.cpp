#include "ngs/eval/eval_stage.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "ngs/core/check.h"
#include "ngs/core/listed.h"
#include "ngs/core/parse_number.h"
#include "ngs/edit/extract/inpaint_stage.h"
#include "ngs/ops/splat/step_tiles.h"

namespace ngs {
namespace {

void require_pixels(const MaskSamples& samples, const std::string& view, const char* role) {
  if (samples.width_px > 0 && samples.height_px > 0 &&
      samples.data.size() ==
          std::size_t(samples.width_px) * std::size_t(samples.height_px) * std::size_t(samples.channels))
    return;
  throw Error(ErrorCode::kBadInput, view + ": " + role + " mask has no pixels, expected an image");
}

std::vector<std::uint8_t> equal_to(const std::vector<std::uint32_t>& labels, std::uint32_t id) {
  std::vector<std::uint8_t> mask(labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) mask[i] = labels[i] == id;
  return mask;
}

/// [H·W] 1 if the true label map has void_id there; empty without void_id.
std::vector<std::uint8_t> void_pixels(const EvalOptions& options, const std::vector<std::uint32_t>& truth) {
  if (options.void_id < 0) return {};
  return equal_to(truth, std::uint32_t(options.void_id));
}

/// Adds other objects than `id` with their margin, which may occlude it.
std::vector<std::uint8_t> with_occluders(const EvalOptions& options, const std::vector<std::uint32_t>& truth,
                                         const EvalPair& pair, std::vector<std::uint8_t> is_void) {
  if (options.occluder_margin_px < 0) return is_void;
  PixelMask others(truth.size());
  for (std::size_t p = 0; p < others.size(); ++p) others[p] = truth[p] != 0 && truth[p] != pair.truth_id;
  others = dilated(others, pair.truth.width_px, pair.truth.height_px, options.occluder_margin_px);
  for (std::size_t p = 0; p < others.size(); ++p)
    others[p] = (others[p] && truth[p] != pair.truth_id) || (!is_void.empty() && is_void[p]);
  return others;
}

/// PASCAL VOC and data sets derived from it mark unlabelled pixels by 255.
bool has_usual_void(const EvalOptions& options, const ObjectIds& ids, const std::vector<std::uint32_t>& truth) {
  constexpr std::uint32_t kUsualVoid = 255;
  if (options.void_id >= 0 || ids.contains(kUsualVoid)) return false;
  const auto other = [&](std::uint32_t id) { return id != 0 && id != kUsualVoid; };
  return std::ranges::find(truth, kUsualVoid) != truth.end() && std::ranges::any_of(truth, other);
}

/// [H·W] 0 or 1 each.
struct PairPlanes {
  const std::vector<std::uint8_t>&predicted, &truth;
  std::vector<std::uint8_t> is_void = {};  // 1: not counted; empty: none
};

PairScore score_planes(const Exec& exec, const EvalPair& pair, const PairPlanes& planes) {
  const int w = pair.truth.width_px, h = pair.truth.height_px;
  PairScore score;
  score.view = pair.view;
  score.object = pair.object;
  score.width_px = w;
  score.height_px = h;
  score.predicted_width_px = pair.predicted.width_px;
  score.predicted_height_px = pair.predicted.height_px;
  score.scores = score_mask(exec, {planes.predicted.data(), w, h}, {planes.truth.data(), w, h}, kContourTolerance,
                            planes.is_void.empty() ? MaskPlane{} : MaskPlane{planes.is_void.data(), w, h});
  return score;
}

void add(ScoreValues& sum, const ScoreValues& values) {
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += values[k];
}

void divide(ScoreValues& sum, std::size_t count) {
  for (double& value : sum) value /= double(count);
}

constexpr float kRarelySeenViews = 2;
constexpr double kOccluderDistance = 0.1;  // fraction of the object's radius
enum Channel : std::size_t { kObject, kRarelySeen, kBoundary, kChannels };

/// RMS distance of the object's Gaussians from their mean, world.
double object_radius(const GaussianCloud& cloud, const std::vector<std::uint8_t>& object) {
  double count = 0, sum[3] = {}, squares = 0;
  for (std::size_t i = 0; i < object.size(); ++i) {
    if (!object[i] || !cloud.usable[i]) continue;
    count += 1;
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = double(cloud.position[3 * i + a]);
      sum[a] += x;
      squares += x * x;
    }
  }
  if (count == 0) return 0;
  const double mean2 = (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / (count * count);
  return std::sqrt(std::max(0.0, squares / count - mean2));
}

struct Renders {
  RenderedView whole;            // label: kObject, kRarelySeen, kBoundary
  RenderedView object;           // the object alone, with depth
  RenderedView others;           // all but the object, with depth
  double occluder_distance = 0;  // world: least distance of an occluder in front of the object
};

/// The renderings in the pixels of `tiles`; others are undefined.
Renders rendered(const Exec& exec, const AtlasInput& in, const TileFlags& tiles) {
  const auto n = std::size_t(in.cloud.size());
  std::vector<float> value(n * kChannels);
  std::vector<std::uint8_t> object(n), other(n);
  for (std::size_t i = 0; i < n; ++i) {
    value[i * kChannels + kObject] = in.labels.label[i];
    value[i * kChannels + kRarelySeen] = in.labels.views[i] <= kRarelySeenViews;
    value[i * kChannels + kBoundary] = in.labels.boundary[i];
    object[i] = label_is_foreground(in.labels.label[i]);
    other[i] = !object[i];
  }
  RenderRequest request{.colour = false, .label = {value.data(), in.cloud.size(), int(kChannels)}};
  request.tiles = tiles.data();
  Renders r;
  r.whole = render(exec, in.cloud, in.camera, in.splat, request);
  request.label = {};
  request.depth = true;
  request.include = object.data();
  r.object = render(exec, in.cloud, in.camera, in.splat, request);
  request.include = other.data();
  r.others = render(exec, in.cloud, in.camera, in.splat, request);
  r.occluder_distance = kOccluderDistance * object_radius(in.cloud, object);
  return r;
}

bool is_occluded(const Renders& r, std::size_t p) {
  const double behind = double(r.object.alpha.data[p]), before = double(r.others.alpha.data[p]);
  if (!(behind > 0.5) || !(before > 0)) return false;
  return double(r.others.depth.data[p]) / before < double(r.object.depth.data[p]) / behind - r.occluder_distance;
}

ErrorCause cause_at(const AtlasInput& in, const Renders& r, std::size_t p) {
  const bool truth = in.truth.data[p] != 0;
  const double alpha = double(r.whole.alpha.data[p]);
  const float* value = &r.whole.label.data[p * kChannels];
  if (alpha < 0.5) return ErrorCause::kReach;
  if (double(value[kRarelySeen]) > 0.5 * alpha) return ErrorCause::kUnseen;
  if (truth && is_occluded(r, p)) return ErrorCause::kFloater;
  if (in.input.data != nullptr && (in.input.data[p] != 0) != truth) return ErrorCause::kInputMask;
  if (double(value[kBoundary]) > 0.5 * alpha) return ErrorCause::kStraddler;
  if (value[kObject] > 0.25f && value[kObject] < 0.75f) return ErrorCause::kSoftEdge;
  return ErrorCause::kLabel;
}

}  // namespace

ObjectIds parse_object_ids(const std::vector<std::string>& texts) {
  ObjectIds ids;
  std::set<std::string> names;
  for (const std::string& text : texts) {
    const std::size_t equals = text.rfind('=');
    const std::string number = equals == std::string::npos ? text : text.substr(equals + 1);
    std::uint32_t id = 0;
    if (!parse_number(number, id) || id == 0)
      throw Error(ErrorCode::kUsage, "object_id = '" + text + "', expected ID or NAME=ID with ID >= 1");
    const std::string name = equals == std::string::npos ? number : text.substr(0, equals);
    if (!ids.emplace(id, name).second || !names.insert(name).second)
      throw Error(ErrorCode::kUsage, "object_id = '" + text + "': the id or the name is given twice, expected once");
  }
  return ids;
}

bool is_black_and_white(const MaskSamples& samples) {
  return std::all_of(samples.data.begin(), samples.data.end(),
                     [](std::uint16_t value) { return value == 0 || value == 255; });
}

std::vector<std::uint8_t> binarised(const DecisiveSamples& samples, double threshold) {
  const double limit = samples.full_scale == 1 ? 1.0 : threshold * (double(samples.full_scale) / 255);
  std::vector<std::uint8_t> mask(samples.value.size());
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = double(samples.value[i]) >= limit;
  return mask;
}

std::vector<std::uint32_t> label_ids(const MaskSamples& samples) {
  const std::size_t pixels = std::size_t(samples.width_px) * std::size_t(samples.height_px);
  const std::size_t channels = std::size_t(samples.channels);
  const bool colours = channels >= 3 && !is_grey(samples);
  std::vector<std::uint32_t> labels(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint16_t* sample = samples.data.data() + i * channels;
    labels[i] = colours ? sample[0] + 256u * sample[1] + 65536u * sample[2] : sample[0];
  }
  return labels;
}

void require_consistent(const EvalOptions& options) {
  const auto need_label_map = [&](bool given, const std::string& name, const std::string& flag) {
    if (given && !options.label_map)
      throw Error(ErrorCode::kUsage, name + " without label_map, expected with label maps only",
                  "add --label-map, or leave " + flag + " out");
  };
  need_label_map(!options.object_id.empty(), "object_id", "--object-id");
  need_label_map(options.void_id >= 0, "void_id", "--void-id");
  for (const auto& [id, name] : parse_object_ids(options.object_id))
    if (std::int64_t(id) == options.void_id)
      throw Error(ErrorCode::kUsage,
                  "id " + std::to_string(id) + " is void and object '" + name + "', expected one of the two",
                  "leave --void-id or --object-id " + name + " out");
}

std::vector<PairScore> evaluate_pair(const Exec& exec, const EvalOptions& options, const ObjectIds& ids,
                                     const EvalPair& pair) {
  require_pixels(pair.predicted, pair.view, "the predicted");
  require_pixels(pair.truth, pair.view, "the true");
  const int w = pair.truth.width_px, h = pair.truth.height_px;
  const auto fitted = [&](const auto& plane) {
    return resized_nearest(plane.data(), pair.predicted.width_px, pair.predicted.height_px, w, h);
  };
  if (!options.label_map) {
    const DecisiveSamples predicted = decisive_samples(pair.predicted), truth = decisive_samples(pair.truth);
    PairScore score = score_planes(
        exec, pair, {fitted(binarised(predicted, options.threshold)), binarised(truth, options.threshold)});
    score.predicted_zero_one = predicted.full_scale == 1;
    score.truth_zero_one = truth.full_scale == 1;
    return {score};
  }
  if (pair.truth_id == 0 && ids.size() == 1 && ids.begin()->first != 255 && is_black_and_white(pair.predicted)) {
    EvalPair one = pair;
    one.truth_id = ids.begin()->first;
    one.object = ids.begin()->second;
    return evaluate_pair(exec, options, ids, one);
  }
  const std::vector<std::uint32_t> truth = label_ids(pair.truth);
  const std::vector<std::uint8_t> is_void = void_pixels(options, truth);
  const bool usual_void = has_usual_void(options, ids, truth);
  if (pair.truth_id > 0) {
    const DecisiveSamples predicted = decisive_samples(pair.predicted);
    PairScore score = score_planes(exec, pair,
                                   {fitted(binarised(predicted, options.threshold)), equal_to(truth, pair.truth_id),
                                    with_occluders(options, truth, pair, is_void)});
    score.predicted_zero_one = predicted.full_scale == 1;
    score.truth_has_usual_void = usual_void;
    if (score.scores.both_empty) return {};
    return {score};
  }
  const std::vector<std::uint32_t> predicted = fitted(label_ids(pair.predicted));
  std::set<std::uint32_t> present;
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (is_void.empty() || !is_void[i]) present.insert({predicted[i], truth[i]});
  present.erase(0);
  if (options.void_id >= 0) present.erase(std::uint32_t(options.void_id));
  std::vector<PairScore> scores;
  for (std::uint32_t id : present) {
    const auto wanted = ids.find(id);
    if (!ids.empty() && wanted == ids.end()) continue;
    PairScore score = score_planes(exec, pair, {equal_to(predicted, id), equal_to(truth, id), is_void});
    score.truth_has_usual_void = usual_void;
    score.object = wanted == ids.end() ? std::to_string(id) : wanted->second;
    if (!pair.object.empty()) score.object = pair.object + "/" + score.object;
    scores.push_back(std::move(score));
  }
  return scores;
}

EvalSummary summarise(std::span<const PairScore> pairs) {
  EvalSummary summary;
  std::map<std::string, ObjectMean> objects;
  for (const PairScore& pair : pairs) {
    const MaskScores& s = pair.scores;
    ObjectMean& object = objects[pair.object];
    ++object.pairs;
    object.both_empty += s.both_empty;
    object.one_empty += s.one_empty;
    object.counts.tp += s.counts.tp;
    object.counts.fp += s.counts.fp;
    object.counts.fn += s.counts.fn;
    object.counts.tn += s.counts.tn;
    object.far_fp += s.far_fp;
    object.far_fn += s.far_fn;
    object.void_px += s.void_px;
    add(object.mean, score_values(s));
    add(summary.mean_over_pairs, score_values(s));
  }
  for (auto& [name, object] : objects) {
    object.object = name;
    divide(object.mean, std::size_t(object.pairs));
    add(summary.mean, object.mean);
    summary.objects.push_back(object);
  }
  divide(summary.mean, objects.size());
  divide(summary.mean_over_pairs, pairs.size());
  return summary;
}

std::vector<ScoreCheck> check_scores(const std::string& rule, const std::map<std::string, double>& found) {
  std::vector<ScoreCheck> checks;
  if (rule.empty()) return checks;
  for (std::string_view part : split(rule, ',')) {
    const std::size_t equals = part.find('=');
    ScoreCheck check;
    check.score = part.substr(0, equals);
    if (check.score == "boundary_iou") check.score = "biou";
    if (check.score == "psnr") check.score = "psnr_db";
    if (equals == std::string_view::npos || !parse_number(part.substr(equals + 1), check.at_least))
      throw Error(ErrorCode::kUsage, "fail_below = '" + rule + "', expected SCORE=MIN,... as in iou=0.9,biou=0.6");
    const auto value = found.find(check.score);
    if (value == found.end()) {
      std::string known;
      for (const auto& [name, unused] : found) known += (known.empty() ? "" : ", ") + name;
      throw Error(ErrorCode::kUsage, "fail_below: unknown score '" + check.score + "', expected one of " + known);
    }
    check.found = value->second;
    checks.push_back(check);
  }
  return checks;
}

std::int64_t ErrorAtlas::wrong() const {
  std::int64_t sum = 0;
  for (std::size_t c = 1; c < kErrorCauses; ++c) sum += pixels[c];
  return sum;
}

ErrorAtlas error_atlas(const Exec& exec, const AtlasInput& in) {
  NGS_CHECK(in.camera.width_px == in.truth.width_px && in.camera.height_px == in.truth.height_px &&
                in.predicted.pixels() == in.truth.pixels(),
            "camera, prediction and truth have one size");
  std::vector<std::uint8_t> wrong(std::size_t(in.truth.pixels()));
  for (std::size_t p = 0; p < wrong.size(); ++p) wrong[p] = (in.predicted.data[p] != 0) != (in.truth.data[p] != 0);
  const Renders r = rendered(exec, in, tiles_with(wrong, in.truth.width_px, in.truth.height_px));
  ErrorAtlas atlas;
  atlas.cause.assign(wrong.size(), ErrorCause::kNone);
  for (std::size_t p = 0; p < wrong.size(); ++p) {
    if (wrong[p] != 0) atlas.cause[p] = cause_at(in, r, p);
    ++atlas.pixels[std::size_t(atlas.cause[p])];
  }
  return atlas;
}

}  // namespace ngs
