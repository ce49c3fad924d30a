// Labels of the objects of a Session: of their strokes, their edits by hand, and without locked objects.
#include <algorithm>
#include <cstdlib>

#include "ngs/edit/select/touched_pieces.h"
#include "ngs/interactive/hand_edit.h"
#include "ngs/interactive/session.h"

namespace ngs::live {
namespace {

std::array<float, 3> rgb(const std::string& colour) {
  const unsigned long value = std::strtoul(colour.c_str() + 1, nullptr, 16);
  return {float(value >> 16 & 255) / 255, float(value >> 8 & 255) / 255, float(value & 255) / 255};
}

}  // namespace

/// Removes deleted and changed views from the sums, adds new ones, and relabels the Gaussians visible in them.
void Session::update(CachedObject& cache, const ObjectMarks& object) {
  const auto in = [](const MarkedViews& views, const auto& view) {
    return std::find(views.begin(), views.end(), view) != views.end();
  };
  MarkedViews removed, added;
  for (const auto& view : cache.views)
    if (!in(object.views, view)) removed.push_back(view);
  for (const auto& view : object.views)
    if (!in(cache.views, view)) added.push_back(view);
  cache.views = object.views;
  if (cache.labels && removed.empty() && added.empty()) return;
  std::vector<std::vector<std::uint32_t>> changed;
  for (const auto& view : removed) {
    const auto now = std::ranges::find(added, view->seen, [](const auto& v) { return v->seen; });
    if (now != added.end()) {
      changed.push_back(replace_view(*view, **now, cache.sums));
      added.erase(now);
    } else {
      remove_view(*view, cache.sums);
      changed.push_back(view->seen->row);
    }
  }
  for (const auto& view : added) {
    add_view(*view, cache.sums);
    changed.push_back(view->seen->row);
  }
  ObjectLabels labels = cache.labels ? *cache.labels : ObjectLabels::none(std::size_t(cache.sums.gaussians));
  for (const std::vector<std::uint32_t>& rows : changed) label_rows(exec_, cache.sums, rows, labels);
  cache.labels = std::make_shared<const ObjectLabels>(std::move(labels));
}

void Session::remove_untouched(CachedObject& cache) const {
  if (cache.touched && cache.touched_of == cache.labels) return;
  cache.touched_of = cache.labels;
  std::vector<ViewSums> strokes;
  for (const auto& view : cache.views) strokes.insert(strokes.end(), view->touched.begin(), view->touched.end());
  const std::vector<std::uint8_t> member(cache.labels->label.begin(), cache.labels->label.end());
  const PieceSelection pieces = touched_pieces(exec_, model_.cloud, member, strokes);
  ObjectLabels labels = *cache.labels;
  for (std::size_t i = 0; i < member.size(); ++i)
    if (member[i] && !pieces.object[i]) {
      labels.label[i] = 0;
      labels.boundary[i] = 0;
    }
  labels.removed = pieces.removed + pieces.needles;
  labels.count -= labels.removed;
  cache.touched = std::make_shared<const ObjectLabels>(std::move(labels));
}

/// Starts from the cached result of the longest prefix of these edits, so that one more edit, or undo, is cheap.
std::shared_ptr<const ObjectLabels> Session::with_edits_of(CachedObject& cache, const ObjectMarks& object,
                                                           bool all_pieces) const {
  const std::shared_ptr<const ObjectLabels>& base = all_pieces ? cache.labels : cache.touched;
  if (!object.edits) return base;
  const HandEdits& edits = *object.edits;
  if (cache.steps_of != base) cache.steps.clear();
  cache.steps_of = base;
  std::shared_ptr<const ObjectLabels> labels = base;
  std::size_t done = 0;
  for (const auto& [some, result] : cache.steps)
    if (some.size() > done && some.size() <= edits.size() && std::equal(some.begin(), some.end(), edits.begin())) {
      done = some.size();
      labels = result;
    }
  if (done == edits.size()) return labels;
  labels = std::make_shared<const ObjectLabels>(with_edits(exec_, model_, *labels, std::span(edits).subspan(done)));
  cache.steps.insert(cache.steps.begin(), {edits, labels});
  if (cache.steps.size() > kMaxEditSteps) cache.steps.pop_back();
  return labels;
}

std::shared_ptr<const ObjectLabels> Session::edited(
    CachedObject& cache, const ObjectMarks& object, bool all_pieces,
    const std::vector<std::shared_ptr<const ObjectLabels>>& blocked) const {
  const std::shared_ptr<const ObjectLabels> labels = with_edits_of(cache, object, all_pieces);
  if (blocked.empty()) return labels;
  std::vector<std::shared_ptr<const void>> key{labels};
  key.insert(key.end(), blocked.begin(), blocked.end());
  if (cache.unblocked && cache.unblocked_of == key) return cache.unblocked;
  std::vector<std::uint8_t> rows(std::size_t(model_.cloud.size()));
  for (const auto& other : blocked)
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] |= other->label[i] > 0;
  cache.unblocked = std::make_shared<const ObjectLabels>(with_edits(exec_, model_, *labels, {}, rows));
  cache.unblocked_of = std::move(key);
  return cache.unblocked;
}

/// `blocked`: the labels of locked and hidden objects.
ShownObject Session::show(const ObjectMarks& object, bool all_pieces,
                          const std::vector<std::shared_ptr<const ObjectLabels>>& blocked) {
  ShownObject one{object.id, rgb(object.colour), nullptr, nullptr, object.hidden};
  if (object.is_empty()) {
    std::erase_if(cached_objects_, [&](const CachedObject& k) { return k.id == object.id; });
    return one;
  }
  CachedObject& sums = cached(object.id);
  update(sums, object);
  remove_untouched(sums);
  one.labels = edited(sums, object, all_pieces, blocked);
  one.touched = object.edits ? one.labels : sums.touched;
  return one;
}

void Session::publish(Marks marks) {
  std::erase_if(cached_objects_, [&](const CachedObject& k) { return marks.find(k.id) == nullptr; });
  std::vector<ShownObject> shown(marks.objects.size());
  std::vector<std::shared_ptr<const ObjectLabels>> blocked;
  for (const bool first : {true, false})  // locked and hidden objects first: the others leave their Gaussians to them
    for (std::size_t k = 0; k < shown.size(); ++k) {
      const ObjectMarks& object = marks.objects[k];
      if (first != (object.locked || object.hidden)) continue;
      shown[k] = show(object, marks.all_pieces, first ? decltype(blocked)() : blocked);
      if (first && shown[k].labels) blocked.push_back(shown[k].labels);
    }
  const std::lock_guard lock(mutex_);
  marks_ = std::make_shared<const Marks>(std::move(marks));
  shown_ = std::make_shared<const std::vector<ShownObject>>(std::move(shown));
}

}  // namespace ngs::live
