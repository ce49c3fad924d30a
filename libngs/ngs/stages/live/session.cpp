#include "ngs/stages/live/session.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "ngs/backend/for_each.h"
#include "ngs/core/error.h"
#include "ngs/core/monitor.h"
#include "ngs/ops/image/connected_components.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/ops/splat/evidence.h"
#include "ngs/scene/mask_threshold.h"
#include "ngs/stages/live/live_mask.h"
#include "ngs/stages/masks/hand_prompt.h"
#include "ngs/stages/masks/mask_consensus.h"

namespace ngs::live {
namespace {

constexpr double kBand = 0.02;       // of the diagonal: free on both sides of the contour that other views tell
constexpr double kContested = 0.12;  // of the diagonal, about a stroke that says otherwise than the other views
constexpr const char* kColours[] = {"#ff8c1a", "#2aa5ff", "#7bd13b", "#e0529c",
                                    "#f2d024", "#8f6be8", "#28c7b7", "#f25f4c"};

bool same(const Look& a, const Look& b) {
  const auto equal = [](Vec3<double> u, Vec3<double> v) { return u.x == v.x && u.y == v.y && u.z == v.z; };
  return equal(a.position, b.position) && equal(a.look_at, b.look_at) && equal(a.up, b.up) &&
         a.fov_y_deg == b.fov_y_deg && a.width_px == b.width_px && a.height_px == b.height_px;
}

std::string picture_name(int number) {
  char name[24];
  std::snprintf(name, sizeof name, "%04d.png", number);
  return name;
}

std::array<float, 3> rgb(const std::string& colour) {
  const unsigned long value = std::strtoul(colour.c_str() + 1, nullptr, 16);
  return {float(value >> 16 & 255) / 255, float(value >> 8 & 255) / 255, float(value & 255) / 255};
}

ViewMasks masks_of(const MarkedView& view) {
  ViewMasks masks{view.camera.width_px, view.camera.height_px, {}, {}, true};
  masks.target.emplace_back(view.mask.begin(), view.mask.end());
  return masks;
}

int diagonal_share(const Camera& camera, double share) {
  return int(std::lround(share * std::hypot(double(camera.width_px), double(camera.height_px))));
}

/// While it lives a view is not in the sums.
class WithoutView {
 public:
  WithoutView(ObjectEvidence& sums, const MarkedView* view) : sums_(sums), view_(view) {
    if (view_ != nullptr) sums_.remove(*view_);
  }
  ~WithoutView() {
    if (view_ != nullptr) sums_.add(*view_);
  }
  WithoutView(const WithoutView&) = delete;
  WithoutView& operator=(const WithoutView&) = delete;

 private:
  ObjectEvidence& sums_;
  const MarkedView* view_;
};

/// Distance of every pixel from the strokes of one side that contradict what the other views say.
std::vector<std::int32_t> distance_of_contest(const ViewPrompt& strokes, const ViewPrompt& prompt, bool object) {
  PixelMask calm(prompt.hint.size(), 1);
  for (std::size_t p = 0; p < calm.size(); ++p)
    if (is_certain(strokes.hint[p]) && is_object(strokes.hint[p]) == object && is_object(prompt.hint[p]) != object)
      calm[p] = 0;
  return chessboard_distance({calm.data(), prompt.width_px, prompt.height_px}, Outside::kUnknown);
}

/// Strokes hold. About those that contradict what the other views say, that is no longer certain: the colours decide.
/// But a stroke on the object takes nothing away, and one beside it adds nothing.
void lay_strokes(const ViewPrompt& strokes, int contested_px, ViewPrompt& prompt) {
  const auto to_object = distance_of_contest(strokes, prompt, true),
             to_background = distance_of_contest(strokes, prompt, false);
  for (std::size_t p = 0; p < prompt.hint.size(); ++p) {
    if (is_object(prompt.hint[p]) && to_background[p] <= contested_px) prompt.hint[p] = PixelHint::kLikelyObject;
    if (!is_object(prompt.hint[p]) && to_object[p] <= contested_px) prompt.hint[p] = PixelHint::kLikelyBackground;
    if (is_certain(strokes.hint[p])) prompt.hint[p] = strokes.hint[p];
  }
}

/// Which pixels of `changed` are connected, through others of it, to a stroke of that side.
PixelMask reached(const PixelMask& changed, const ViewPrompt& strokes, PixelHint side) {
  const ConnectedComponents pieces = connected_components({changed.data(), strokes.width_px, strokes.height_px});
  std::vector<std::uint8_t> is_reached(pieces.size.size());
  for (std::size_t p = 0; p < changed.size(); ++p)
    if (changed[p] && strokes.hint[p] == side) is_reached[std::size_t(pieces.component[p])] = 1;
  PixelMask out(changed.size());
  for (std::size_t p = 0; p < changed.size(); ++p) out[p] = changed[p] && is_reached[std::size_t(pieces.component[p])];
  return out;
}

/// A correction is local: of the mask before it changes what is connected to the new strokes, and to their side.
PixelMask corrected(const PixelMask& before, const PixelMask& found, const ViewPrompt& strokes) {
  PixelMask more(before.size()), less(before.size()), out = before;
  for (std::size_t p = 0; p < before.size(); ++p) more[p] = found[p] && !before[p], less[p] = before[p] && !found[p];
  more = reached(more, strokes, PixelHint::kObject), less = reached(less, strokes, PixelHint::kBackground);
  for (std::size_t p = 0; p < out.size(); ++p)
    if (more[p] || less[p]) out[p] = more[p];
  return out;
}

/// Of a render of known_channels(); what is empty is known.
Consensus consensus_of(const RenderedView& rendered) {
  Consensus consensus{rendered.width_px, rendered.height_px, {}, {}, {}};
  const std::size_t pixels = rendered.alpha.data.size();
  consensus.object.resize(pixels), consensus.known.resize(pixels);
  for (std::size_t p = 0; p < pixels; ++p) {
    const float known = rendered.label.data[2 * p + 1] + 1 - rendered.alpha.data[p];
    consensus.known[p] = std::clamp(known, 0.f, 1.f);
    consensus.object[p] = known > 0 ? std::clamp(rendered.label.data[2 * p] / known, 0.f, 1.f) : 0.f;
  }
  consensus.alone = consensus.object;
  return consensus;
}

}  // namespace

Camera segmented_camera(const Look& look) {
  Camera camera = camera_of(look);
  const int longer = std::max(camera.width_px, camera.height_px);
  if (longer <= kSegmentedSide_px) return camera;
  const double scale = double(kSegmentedSide_px) / longer;
  return resized(camera, scaled_size_px(camera.width_px, scale), scaled_size_px(camera.height_px, scale));
}

Session::Session(const Exec& exec, const Model& model) : exec_(exec), model_(model) {
  Marks marks;
  marks.objects.push_back({1, "object 1", kColours[0], 1, {}});
  marks.active = 1, marks.next_id = 2;
  publish(std::move(marks));
}

std::shared_ptr<const Marks> Session::marks() const {
  const std::lock_guard lock(mutex_);
  return marks_;
}

std::shared_ptr<const std::vector<ShownObject>> Session::shown() const {
  const std::lock_guard lock(mutex_);
  return shown_;
}

ImageU8 Session::picture(const Camera& camera) const {
  RenderRequest request;
  request.background = model_.background;
  return to_bytes(render(exec_, model_.cloud, camera, model_.splat, request).colour);
}

const ObjectMarks& Session::object(int id) const {
  if (const ObjectMarks* found = marks_->find(id)) return *found;
  throw Error(ErrorCode::kUsage,
              "object " + std::to_string(id) + ": there is none of this number, expected one of the list");
}

Session::Kept& Session::kept(int id) {
  for (Kept& k : kept_)
    if (k.id == id) return k;
  return kept_.emplace_back(Kept{id, ObjectEvidence(model_.cloud.size()), {}, nullptr});
}

/// What the object's other views know of every Gaussian, [N, 2]: its share in the object, and 1 where it is known.
std::vector<float> Session::known_channels(const ObjectEvidence& others) const {
  std::vector<float> channel(2 * others.gaussians());
  for_each_index(exec_, std::int64_t(others.gaussians()), [&](std::int64_t i) {
    const auto row = std::size_t(i);
    if (others.is_seen(row)) channel[2 * row] = float(others.share(row)), channel[2 * row + 1] = 1;
  });
  return channel;
}

/// Finds the mask of a view from its strokes, and from what the object's other views say there; null: there are none.
void Session::segment(MarkedView& view, const ObjectEvidence* others) const {
  const Camera& camera = view.camera;
  const std::vector<float> channel = others ? known_channels(*others) : std::vector<float>();
  RenderRequest request;
  request.background = model_.background;
  if (others) request.label = {channel.data(), model_.cloud.size(), 2};
  const RenderedView rendered = render(exec_, model_.cloud, camera, model_.splat, request);
  ViewPrompt prompt = rasterise(view.strokes, camera.width_px, camera.height_px);
  if (others) {
    const ViewPrompt strokes = std::exchange(
        prompt, prompt_from(consensus_of(rendered), std::max(3, diagonal_share(camera, kBand)), view.mask));
    prompt.by_hand = true;
    lay_strokes(strokes, diagonal_share(camera, kContested), prompt);
  }
  view.mask = live_mask(to_bytes(rendered.colour), prompt, 0);
}

/// Sets what the view says of the Gaussians.
void Session::weigh(MarkedView& view) const {
  const ViewSums sums = view_sums(exec_, model_.cloud, {view.camera, masks_of(view)}, model_.splat);
  if (!view.seen) {
    ViewWeights seen;
    seen.row = sums.row;
    for (std::size_t v = 0; v < sums.size(); ++v) seen.weight.push_back(sums.weight(v));
    view.seen = std::make_shared<const ViewWeights>(std::move(seen));
  }
  view.inside = {};
  for (std::size_t v = 0; v < sums.size(); ++v)
    if (sums.object_weight(v, 0) > 0)
      view.inside.row.push_back(sums.row[v]), view.inside.weight.push_back(sums.object_weight(v, 0));
}

StrokeAnswer Session::mark(int id, const Look& look, const std::vector<PromptStroke>& strokes) {
  const double start_s = wall_seconds();
  Marks marks = *marks_;
  (void)object(id);
  ObjectMarks& marked = *marks.find(id);
  const auto place =
      std::find_if(marked.views.begin(), marked.views.end(), [&](const auto& view) { return same(view->look, look); });
  MarkedView view;
  if (place != marked.views.end()) {
    view = **place;
  } else {
    view.name = picture_name(marked.next_view++), view.look = look;
    view.camera = segmented_camera(look), view.camera.name = view.name;
    view.strokes.view = view.name, view.strokes.width_px = look.width_px, view.strokes.height_px = look.height_px;
  }
  view.strokes.strokes.insert(view.strokes.strokes.end(), strokes.begin(), strokes.end());

  const bool is_new = place == marked.views.end();
  {
    const bool others_know = marked.views.size() > (is_new ? 0u : 1u);
    const WithoutView others(kept(id).evidence, is_new ? nullptr : place->get());
    segment(view, others_know ? &kept(id).evidence : nullptr);
  }
  if (!is_new && std::ranges::count((*place)->mask, 1) > 0) {
    HandPrompt drawn = view.strokes;
    drawn.strokes = strokes;
    view.mask = corrected((*place)->mask, view.mask, rasterise(drawn, view.camera.width_px, view.camera.height_px));
  }
  const double masked_s = wall_seconds();
  weigh(view);
  StrokeAnswer answer;
  answer.coverage = double(std::count(view.mask.begin(), view.mask.end(), 1)) / double(view.mask.size());
  const auto made = std::make_shared<const MarkedView>(std::move(view));
  if (is_new)
    marked.views.push_back(made);
  else
    *place = made;
  marks.active = id;
  step(std::move(marks));
  answer.mask_s = masked_s - start_s, answer.lift_s = wall_seconds() - masked_s;
  return answer;
}

int Session::add_object(const std::string& name) {
  Marks marks = *marks_;
  if (marks.objects.size() >= kMostObjects)
    throw Error(ErrorCode::kUsage, "objects: " + std::to_string(kMostObjects) + " already, expected no more",
                "remove one, or export and begin another visit");
  const int id = marks.next_id++;
  const char* colour = kColours[std::size_t(id - 1) % std::size(kColours)];
  marks.objects.push_back({id, name.empty() ? "object " + std::to_string(id) : name, colour, 1, {}});
  marks.active = id;
  step(std::move(marks));
  return id;
}

void Session::remove_object(int id) {
  (void)object(id);
  Marks marks = *marks_;
  std::erase_if(marks.objects, [&](const ObjectMarks& o) { return o.id == id; });
  if (marks.active == id) marks.active = marks.objects.empty() ? 0 : marks.objects.front().id;
  step(std::move(marks));
}

void Session::edit_object(int id, const std::string& name, const std::string& colour) {
  (void)object(id);
  Marks marks = *marks_;
  ObjectMarks& edited = *marks.find(id);
  if (!name.empty()) edited.name = name;
  if (!colour.empty()) edited.colour = colour;
  step(std::move(marks));
}

void Session::activate(int id) {
  (void)object(id);
  Marks marks = *marks_;
  marks.active = id;
  publish(std::move(marks));
}

void Session::step(Marks marks) {
  before_.push_back(marks_);
  if (before_.size() > kMostStepsBack) before_.erase(before_.begin());
  after_.clear();
  publish(std::move(marks));
}

bool Session::undo() {
  if (before_.empty()) return false;
  after_.push_back(marks_);
  const std::shared_ptr<const Marks> to = before_.back();
  before_.pop_back();
  publish(*to);
  return true;
}

bool Session::redo() {
  if (after_.empty()) return false;
  before_.push_back(marks_);
  const std::shared_ptr<const Marks> to = after_.back();
  after_.pop_back();
  publish(*to);
  return true;
}

void Session::forget_steps() { before_.clear(), after_.clear(); }

void Session::restore(Marks marks) {
  for (ObjectMarks& object : marks.objects)
    for (std::shared_ptr<const MarkedView>& view : object.views) {
      MarkedView whole = *view;
      whole.camera = segmented_camera(whole.look), whole.camera.name = whole.name;
      weigh(whole);
      view = std::make_shared<const MarkedView>(std::move(whole));
    }
  forget_steps();
  publish(std::move(marks));
}

/// Takes out the views that are gone or have changed and puts in those that are new. False: none.
bool Session::bring_up_to_date(Kept& kept, const ObjectMarks& object) {
  const auto in = [](const auto& views, const auto& view) {
    return std::find(views.begin(), views.end(), view) != views.end();
  };
  bool changed = false;
  for (const auto& view : kept.views)
    if (!in(object.views, view)) kept.evidence.remove(*view), changed = true;
  for (const auto& view : object.views)
    if (!in(kept.views, view)) kept.evidence.add(*view), changed = true;
  kept.views = object.views;
  return changed;
}

void Session::publish(Marks marks) {
  std::erase_if(kept_, [&](const Kept& k) { return marks.find(k.id) == nullptr; });
  std::vector<ShownObject> shown;
  for (const ObjectMarks& object : marks.objects) {
    ShownObject one{object.id, rgb(object.colour), nullptr};
    if (!object.views.empty()) {
      Kept& sums = kept(object.id);
      if (bring_up_to_date(sums, object) || !sums.labels)
        sums.labels = std::make_shared<const ObjectLabels>(labels_of(exec_, sums.evidence));
      one.labels = sums.labels;
    } else {
      std::erase_if(kept_, [&](const Kept& k) { return k.id == object.id; });
    }
    shown.push_back(std::move(one));
  }
  const std::lock_guard lock(mutex_);
  marks_ = std::make_shared<const Marks>(std::move(marks));
  shown_ = std::make_shared<const std::vector<ShownObject>>(std::move(shown));
}

}  // namespace ngs::live
