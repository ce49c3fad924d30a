#include "ngs/interactive/session.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "ngs/core/error.h"
#include "ngs/core/monitor.h"
#include "ngs/cut/masks/mask_consensus.h"
#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/interactive/correction.h"
#include "ngs/interactive/live_mask.h"
#include "ngs/ops/image/image_bytes.h"

namespace ngs::live {
namespace {

constexpr double kFreeBand = 0.02;  // half-width of the free band around the contour from other views, of the diagonal
constexpr double kReach = 0.25;     // free distance around a new stroke, of the diagonal
constexpr const char* kColours[] = {"#ff8c1a", "#2aa5ff", "#7bd13b", "#e0529c",
                                    "#f2d024", "#8f6be8", "#28c7b7", "#f25f4c"};

std::string picture_name(int number) {
  char name[24];
  std::snprintf(name, sizeof name, "%04d.png", number);
  return name;
}

int diagonal_share(const ImageU8& picture, double share) {
  return int(std::lround(share * std::hypot(double(picture.width_px), double(picture.height_px))));
}

PixelMask segmented(const ImageU8& picture, const Correction& correction, int band_px) {
  const ViewPrompt prompt = correction.prompt(diagonal_share(picture, kReach), band_px);
  return live_mask(picture, prompt, correction.colours(picture, kColourSamples), 0);
}

/// The strokes in pixels of `to`, which has the same pose as `from`.
std::vector<PromptStroke> in_pixels_of(const Viewpoint& to, const Viewpoint& from, std::vector<PromptStroke> strokes) {
  if (to == from) return strokes;
  const double scale = camera_of(to).fy / camera_of(from).fy;
  for (PromptStroke& stroke : strokes) {
    stroke.radius_px *= scale;
    for (auto& [x, y] : stroke.points) {
      x = scale * (x - 0.5 * from.width_px) + 0.5 * to.width_px;
      y = scale * (y - 0.5 * from.height_px) + 0.5 * to.height_px;
    }
  }
  return strokes;
}

/// Whether strokes drawn on `drawn_on` belong to the view `marked`: the pose is the same, and no point that is inside
/// the one picture is outside of the other.
bool belong_to(const Viewpoint& marked, const Viewpoint& drawn_on, const std::vector<PromptStroke>& strokes) {
  if (!has_same_pose(marked, drawn_on)) return false;
  const auto is_inside = [](const Viewpoint& picture, const std::array<double, 2>& p) {
    return p[0] >= 0 && p[1] >= 0 && p[0] <= picture.width_px && p[1] <= picture.height_px;
  };
  const std::vector<PromptStroke> there = in_pixels_of(marked, drawn_on, strokes);
  for (std::size_t s = 0; s < strokes.size(); ++s)
    for (std::size_t k = 0; k < strokes[s].points.size(); ++k)
      if (is_inside(drawn_on, strokes[s].points[k]) && !is_inside(marked, there[s].points[k])) return false;
  return true;
}

/// Throws if the object strokes, or without any the background strokes, cover only empty pixels.
void require_something(const std::vector<float>& alpha, const ViewPrompt& drawn) {
  const bool has_object = std::ranges::count(drawn.hint, PixelHint::kObject) > 0;
  const PixelHint side = has_object ? PixelHint::kObject : PixelHint::kBackground;
  bool any = false, shown = false;
  for (std::size_t p = 0; p < alpha.size(); ++p)
    if (drawn.hint[p] == side) {
      any = true;
      shown |= alpha[p] >= kEmptyAlpha;
    }
  if (any && !shown)
    throw Error(ErrorCode::kUsage, "stroke: nothing is there, expected a part of the splat under it",
                "paint on the object itself; empty space is background already");
}

class WithoutView {
 public:
  WithoutView(WeightSums<>& sums, const MarkedView* view) : sums_(sums), view_(view) {
    if (view_ != nullptr) remove_view(*view_, sums_);
  }
  ~WithoutView() {
    if (view_ != nullptr) add_view(*view_, sums_);
  }
  WithoutView(const WithoutView&) = delete;
  WithoutView& operator=(const WithoutView&) = delete;

 private:
  WeightSums<>& sums_;
  const MarkedView* view_;
};

}  // namespace

Camera at_segmented_size(const Camera& camera, int longer_side_px) {
  const double scale = std::min(1.0, double(longer_side_px) / std::max(camera.width_px, camera.height_px));
  return resized(camera, scaled_size_px(camera.width_px, scale), scaled_size_px(camera.height_px, scale));
}

Session::Session(const Exec& exec, const Model& model) : exec_(exec), model_(model), recent_(exec_, model_) {
  Marks marks;
  marks.objects.push_back({1, "object 1", kColours[0], 1, {}});
  marks.active = 1;
  marks.next_id = 2;
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
  throw Error(ErrorCode::kUsage, "object " + std::to_string(id) + ": unknown number, expected one of the list");
}

Session::CachedObject& Session::cached(int id) {
  for (CachedObject& k : cached_objects_)
    if (k.id == id) return k;
  return cached_objects_.emplace_back(
      CachedObject{id, WeightSums<>(model_.cloud.size(), 1), {}, nullptr, nullptr, nullptr, {}, nullptr, nullptr, {}});
}

/// Finds the mask of a view without one from its strokes and, if there are other views, from their selection in it.
/// `sums` contains the other views and `before`, the previous state of this view.
void Session::segment(MarkedView& view, const MarkedView* before, const MarkedViews& others, WeightSums<>& sums) {
  const Camera& camera = view.camera;
  CachedFrame& here = recent_.of(view.viewpoint, camera);
  const ViewPrompt strokes = rasterise(view.strokes, camera.width_px, camera.height_px);
  if (others.empty()) {
    view.mask = live_mask(here.picture(), strokes, 0);
    return;
  }
  const WithoutView alone(sums, here.has_selection(others) ? nullptr : before);
  const Correction correction{here.selection(sums, others), strokes, strokes};
  if (std::ranges::count(strokes.hint, PixelHint::kObject) == 0)
    view.mask = corrected(correction.before, segmented(here.picture(), correction, 0), strokes);
  else
    view.mask = segmented(here.picture(), correction, std::max(3, diagonal_share(here.picture(), kFreeBand)));
}

void Session::correct(MarkedView& view, const MarkedView& before, const HandPrompt& added) {
  const int w = view.camera.width_px, h = view.camera.height_px;
  const ViewPrompt all = rasterise(view.strokes, w, h), drawn = rasterise(added, w, h);
  const ImageU8& picture = recent_.of(view.viewpoint, view.camera).picture();
  view.mask = corrected(before.mask, segmented(picture, {before.mask, all, drawn}, 0), drawn);
}

StrokeAnswer Session::mark(int id, const Viewpoint& drawn_on, const std::vector<PromptStroke>& drawn_strokes) {
  const double start_s = wall_seconds();
  Marks marks = *marks_;
  ObjectMarks& marked = changeable(marks, id);
  for (const ObjectMarks& other : marks.objects)
    if (other.hidden)
      throw Error(ErrorCode::kUsage, "stroke: " + other.name + " is hidden, expected all objects to be shown",
                  "show it again before you paint; hidden objects are for the lasso, the box and the ball");
  const auto place = std::find_if(marked.views.begin(), marked.views.end(), [&](const auto& view) {
    return belong_to(view->viewpoint, drawn_on, drawn_strokes);
  });
  const Viewpoint viewpoint = place != marked.views.end() ? (*place)->viewpoint : drawn_on;
  const std::vector<PromptStroke> strokes = in_pixels_of(viewpoint, drawn_on, drawn_strokes);
  MarkedView view;
  if (place != marked.views.end()) {
    view = **place;
  } else {
    view.name = picture_name(marked.next_view++);
    view.viewpoint = viewpoint;
    view.camera = at_segmented_size(camera_of(viewpoint));
    view.camera.name = view.name;
    view.strokes.view = view.name;
    view.strokes.width_px = viewpoint.width_px;
    view.strokes.height_px = viewpoint.height_px;
  }
  view.strokes.strokes.insert(view.strokes.strokes.end(), strokes.begin(), strokes.end());

  HandPrompt drawn = view.strokes;
  drawn.strokes = strokes;
  require_something(recent_.of(viewpoint, view.camera).alpha(),
                    rasterise(drawn, view.camera.width_px, view.camera.height_px));

  const bool is_new = place == marked.views.end();
  if (!is_new && std::ranges::count((*place)->mask, 1) > 0) {
    correct(view, **place, drawn);
  } else {
    MarkedViews others = marked.views;
    if (!is_new) others.erase(others.begin() + (place - marked.views.begin()));
    segment(view, is_new ? nullptr : place->get(), others, cached(id).sums);
  }
  empty_is_background(recent_.of(viewpoint, view.camera).alpha(), view.mask);
  const double masked_s = wall_seconds();
  recent_.of(viewpoint, view.camera).weigh(view);
  StrokeAnswer answer;
  answer.is_first = is_new;
  answer.coverage = double(std::count(view.mask.begin(), view.mask.end(), 1)) / double(view.mask.size());
  const auto made = std::make_shared<const MarkedView>(std::move(view));
  if (is_new)
    marked.views.push_back(made);
  else
    *place = made;
  marks.active = id;
  step(std::move(marks));
  answer.mask_s = masked_s - start_s;
  answer.lift_s = wall_seconds() - masked_s;
  return answer;
}

int Session::add_object(const std::string& name) {
  Marks marks = *marks_;
  if (marks.objects.size() >= kMaxObjects)
    throw Error(ErrorCode::kUsage, "objects: " + std::to_string(kMaxObjects) + " already, expected no more",
                "remove one, or export and start another session");
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

ObjectMarks& Session::changeable(Marks& marks, int id) const {
  if (object(id).locked)
    throw Error(ErrorCode::kUsage, object(id).name + ": is locked, expected an object that may change", "unlock it");
  return *marks.find(id);
}

void Session::edit_by_hand(int id, const HandEdit& edit) {
  Marks marks = *marks_;
  ObjectMarks& edited = changeable(marks, id);
  HandEdits edits = edited.edits ? *edited.edits : HandEdits();
  edits.push_back(std::make_shared<const HandEdit>(edit));
  edited.edits = std::make_shared<const HandEdits>(std::move(edits));
  marks.active = id;
  step(std::move(marks));
}

void Session::set_hidden(int id, bool hidden) {
  (void)object(id);
  Marks marks = *marks_;
  marks.find(id)->hidden = hidden;
  step(std::move(marks));
}

void Session::set_locked(int id, bool locked) {
  (void)object(id);
  Marks marks = *marks_;
  marks.find(id)->locked = locked;
  step(std::move(marks));
}

void Session::keep_dropped(int id, bool keep) {
  Marks marks = *marks_;
  changeable(marks, id).keeps_dropped = keep;
  step(std::move(marks));
}

void Session::activate(int id) {
  (void)object(id);
  Marks marks = *marks_;
  marks.active = id;
  publish(std::move(marks));
}

void Session::show_all_pieces(bool all) {
  Marks marks = *marks_;
  marks.all_pieces = all;
  step(std::move(marks));
}

void Session::step(Marks marks) {
  before_.push_back(marks_);
  if (before_.size() > kMaxStepsBack) before_.erase(before_.begin());
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

void Session::forget_steps() {
  before_.clear();
  after_.clear();
}

void Session::restore(Marks marks) {
  for (ObjectMarks& object : marks.objects)
    for (std::shared_ptr<const MarkedView>& view : object.views) {
      MarkedView whole = *view;
      whole.camera = at_segmented_size(camera_of(whole.viewpoint));
      whole.camera.name = whole.name;
      CachedFrame(exec_, model_, whole.viewpoint, whole.camera).weigh(whole);
      view = std::make_shared<const MarkedView>(std::move(whole));
    }
  forget_steps();
  publish(std::move(marks));
}

}  // namespace ngs::live
