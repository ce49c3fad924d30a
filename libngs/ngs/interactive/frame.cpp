#include "ngs/interactive/frame.h"

#include <algorithm>
#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/edit/select/touched_pieces.h"
#include "ngs/math/mask_variance.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs::live {
namespace {

/// Channels [N, 2] of the Gaussians `rows`: the object's share of the weight, and 1 if the Gaussian has evidence.
std::vector<float> known_channels(const Exec& exec, const WeightSums<>& sums, const std::vector<std::uint32_t>& rows) {
  std::vector<float> channel(2 * std::size_t(sums.gaussians));
  for_each_index(exec, std::ssize(rows), [&](std::int64_t v) {
    const std::size_t row = rows[std::size_t(v)];
    if (sums.weight.value(row) > 0) {
      channel[2 * row] = float(sums.prob(row, 0));
      channel[2 * row + 1] = 1;
    }
  });
  return channel;
}

/// Selection from a render of known_channels(): at least half of the pixel is known (empty counts as known background),
/// and most of the known part is the object.
PixelMask selection_of(const RenderedView& rendered) {
  PixelMask selection(rendered.alpha.data.size());
  for (std::size_t p = 0; p < selection.size(); ++p) {
    const float known = rendered.label.data[2 * p + 1] + 1 - rendered.alpha.data[p];
    selection[p] = known >= 0.5f && label_is_foreground(rendered.label.data[2 * p] / known);
  }
  return selection;
}

constexpr float kTint = 0.35f;  // opacity of the object's colour over its pixels
constexpr float kDim = 0.3f;    // brightness of the model under its boundary

using Shown = std::vector<const ShownObject*>;

Shown chosen(const std::vector<ShownObject>& objects, int id) {
  Shown shown;
  for (const ShownObject& object : objects)
    if (object.labels && !object.hidden && (id == 0 || object.id == id)) shown.push_back(&object);
  return shown;
}

/// [N] 1: in one of the objects; with `of_one` false: in none of them.
std::vector<std::uint8_t> rows_of(const Exec& exec, const Shown& objects, std::int64_t gaussians, bool of_one) {
  std::vector<std::uint8_t> rows(std::size_t(gaussians), std::uint8_t(!of_one));
  for (const ShownObject* object : objects)
    for_each_index(exec, gaussians, [&](std::int64_t i) {
      if (object->labels->label[std::size_t(i)] > 0) rows[std::size_t(i)] = of_one;
    });
  return rows;
}

/// [N] 0: in a hidden object; empty without any.
std::vector<std::uint8_t> rows_drawn(const Exec& exec, const std::vector<ShownObject>& objects,
                                     std::int64_t gaussians) {
  Shown hidden;
  for (const ShownObject& object : objects)
    if (object.labels && object.hidden) hidden.push_back(&object);
  return hidden.empty() ? std::vector<std::uint8_t>() : rows_of(exec, hidden, gaussians, false);
}

/// [N, K]
std::vector<float> channels_of(const Exec& exec, const Shown& objects, std::int64_t gaussians, bool boundary) {
  const std::size_t k_count = objects.size();
  std::vector<float> channel(std::size_t(gaussians) * k_count);
  for_each_index(exec, gaussians, [&](std::int64_t i) {
    const auto row = std::size_t(i);
    for (std::size_t k = 0; k < k_count; ++k) {
      const ObjectLabels& labels = *objects[k]->labels;
      channel[row * k_count + k] = boundary ? float(labels.boundary[row]) : labels.label[row];
    }
  });
  return channel;
}

bool same_view(const Camera& a, const Camera& b) {
  const Vec3<double>&s = a.translation, &t = b.translation;
  return a.width_px == b.width_px && a.height_px == b.height_px && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx &&
         a.cy == b.cy && std::ranges::equal(a.rotation.m, b.rotation.m) && s.x == t.x && s.y == t.y && s.z == t.z;
}

struct Canvas {
  const Exec& exec;
  const Model& model;
  const Camera& camera;
  CachedStill* last;
  std::vector<std::uint8_t> drawn;  // [N] 1: drawn; empty: all
};

ImageF colour_of(const Canvas& on, std::vector<std::uint8_t> rows) {
  for (std::size_t i = 0; i < on.drawn.size(); ++i) rows[i] &= on.drawn[i];
  RenderRequest request;
  request.background = on.model.background;
  request.include = rows.data();
  return std::move(render(on.exec, on.model.cloud, on.camera, on.model.splat, request).colour);
}

/// Renders all Gaussians that are drawn, with these labels [N, K] (empty: none).
RenderedView with_labels(const Canvas& on, const std::vector<float>& channel) {
  RenderRequest request;
  request.background = on.model.background;
  const std::int64_t n = on.model.cloud.size();
  if (!channel.empty()) request.label = {channel.data(), n, int(std::int64_t(channel.size()) / n)};
  if (!on.drawn.empty()) request.include = on.drawn.data();
  if (on.last == nullptr || !on.drawn.empty())
    return render(on.exec, on.model.cloud, on.camera, on.model.splat, request);
  auto& [view, colour] = *on.last;
  if (!view || !same_view(view->camera(), on.camera)) {
    view.reset();
    colour = {};  // frees its memory for the next one
    view = std::make_unique<CachedView>(on.exec, on.model.cloud, on.camera, on.model.splat);
  }
  request.colour = colour.empty();
  RenderedView rendered;
  if (request.colour || !channel.empty()) rendered = view->render(on.exec, request);
  if (request.colour)
    colour = rendered.colour;
  else
    rendered.colour = colour;
  return rendered;
}

void mix(const ImageF& other, float share, ImageF& image) {
  for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] += share * (other.data[i] - image.data[i]);
}

/// Index of the object at every pixel; -1: none.
std::vector<int> owners(const ImageF& label) {
  std::vector<int> owner(std::size_t(label.pixels()), -1);
  const auto k_count = std::size_t(label.channels);
  for (std::size_t p = 0; p < owner.size(); ++p) {
    float most = 0.5f;
    for (std::size_t k = 0; k < k_count; ++k)
      if (label.data[p * k_count + k] > most) {
        most = label.data[p * k_count + k];
        owner[p] = int(k);
      }
  }
  return owner;
}

/// Tints the selection and draws its outline: one pixel of the object's colour inside, one white pixel outside.
void highlight(const Exec& exec, const Shown& objects, const RenderedView& view, ImageF& image) {
  const std::vector<int> owner = owners(view.label);
  const int w = image.width_px, h = image.height_px;
  const auto owner_at = [&](int x, int y) {
    return owner[std::size_t(std::clamp(y, 0, h - 1)) * std::size_t(w) + std::size_t(std::clamp(x, 0, w - 1))];
  };
  for_each_index(exec, h, [&](std::int64_t row) {
    const int y = int(row);
    for (int x = 0; x < w; ++x) {
      const int mine = owner_at(x, y);
      int neighbour = -1;
      for (const int other : {owner_at(x - 1, y), owner_at(x + 1, y), owner_at(x, y - 1), owner_at(x, y + 1)})
        if (other != mine) neighbour = std::max(neighbour, other);
      const bool inner_edge = mine >= 0 && (owner_at(x - 1, y) != mine || owner_at(x + 1, y) != mine ||
                                            owner_at(x, y - 1) != mine || owner_at(x, y + 1) != mine);
      const bool outer_edge = mine < 0 && neighbour >= 0;
      const float share = inner_edge ? 1.f : mine >= 0 ? kTint : outer_edge ? 0.8f : 0.f;
      for (int c = 0; c < 3 && share > 0; ++c) {
        const float tint = outer_edge ? 1.f : objects[std::size_t(mine)]->colour[std::size_t(c)];
        float& value = image.at(x, y, c);
        value += share * (tint - value);
      }
    }
  });
}

ImageF boundary_picture(const Canvas& on, const Shown& objects) {
  RenderedView view = with_labels(on, channels_of(on.exec, objects, on.model.cloud.size(), true));
  const auto k_count = std::size_t(view.label.channels);
  for (std::size_t p = 0; p < std::size_t(view.colour.pixels()); ++p)
    for (std::size_t c = 0; c < 3; ++c) {
      float& value = view.colour.data[3 * p + c];
      value *= kDim;
      for (std::size_t k = 0; k < k_count; ++k)
        value += view.label.data[p * k_count + k] * (objects[k]->colour[c] - value);
    }
  return std::move(view.colour);
}

}  // namespace

CachedFrame::CachedFrame(const Exec& exec, const Model& model, const Viewpoint& viewpoint, const Camera& camera)
    : exec_(exec), model_(model), viewpoint_(viewpoint), cached_view_(exec, model.cloud, camera, model.splat) {}

/// Renders the picture unless it is cached, and the selection by `channel` unless that is empty.
void CachedFrame::draw(const std::vector<float>& channel) {
  RenderRequest request;
  request.colour = picture_.empty();
  request.background = model_.background;
  if (!channel.empty()) request.label = {channel.data(), model_.cloud.size(), 2};
  const RenderedView rendered = cached_view_.render(exec_, request);
  if (request.colour) {
    picture_ = to_bytes(rendered.colour);
    alpha_ = rendered.alpha.data;
  }
  if (!channel.empty()) selection_ = selection_of(rendered);
}

const ImageU8& CachedFrame::picture() {
  if (picture_.empty()) draw({});
  return picture_;
}

const std::vector<float>& CachedFrame::alpha() { return picture(), alpha_; }

const PixelMask& CachedFrame::selection(const WeightSums<>& sums, const MarkedViews& others) {
  if (!has_selection(others)) draw(known_channels(exec_, sums, cached_view_.rows()));
  others_ = others;
  return selection_;
}

void CachedFrame::weigh(MarkedView& view) {
  view.touched.clear();
  for (const PixelMask& stroke : object_strokes(rasterise(view.strokes, view.camera.width_px, view.camera.height_px)))
    view.touched.push_back(cached_view_.weigh(exec_, stroke).weights_inside(0));
  const ViewSums& sums = cached_view_.weigh(exec_, view.mask);
  if (!view.seen) view.seen = std::make_shared<const ViewSums>(sums.weights());
  view.inside = sums.weights_inside(0);
}

CachedFrame& FrameCache::of(const Viewpoint& viewpoint, const Camera& camera) {
  const auto found =
      std::find_if(views_.begin(), views_.end(), [&](const auto& view) { return view->viewpoint() == viewpoint; });
  if (found != views_.end()) {
    std::rotate(views_.begin(), found, found + 1);
  } else {
    if (views_.size() == kMaxFrames) views_.pop_back();  // frees its memory for the next one
    views_.insert(views_.begin(), std::make_unique<CachedFrame>(exec_, model_, viewpoint, camera));
  }
  return *views_.front();
}

void add_view(const MarkedView& view, WeightSums<>& sums) {
  sums.add(*view.seen);
  for (std::size_t v = 0; v < view.inside.size(); ++v) sums.add_object(view.inside.row[v], 0, view.inside.weight(v));
}

void remove_view(const MarkedView& view, WeightSums<>& sums) {
  sums.remove(*view.seen);
  for (std::size_t v = 0; v < view.inside.size(); ++v) sums.remove_object(view.inside.row[v], 0, view.inside.weight(v));
}

std::vector<std::uint32_t> replace_view(const MarkedView& before, const MarkedView& now, WeightSums<>& sums) {
  NGS_CHECK(before.seen == now.seen, "two masks of one view");
  std::vector<std::uint32_t> changed;
  const ViewSums &old = before.inside, &next = now.inside;
  for (std::size_t a = 0, b = 0; a < old.size() || b < next.size();) {
    const bool has_old = a < old.size() && (b == next.size() || old.row[a] <= next.row[b]);
    const bool has_next = b < next.size() && (a == old.size() || next.row[b] <= old.row[a]);
    const std::uint32_t row = has_old ? old.row[a] : next.row[b];
    if (!(has_old && has_next && old.weight(a) == next.weight(b))) {
      if (has_old) sums.remove_object(row, 0, old.weight(a));
      if (has_next) sums.add_object(row, 0, next.weight(b));
      changed.push_back(row);
    }
    a += has_old;
    b += has_next;
  }
  return changed;
}

void label_rows(const Exec& exec, const WeightSums<>& sums, const std::vector<std::uint32_t>& rows,
                ObjectLabels& labels) {
  const BoundaryRule rule;
  constexpr std::int64_t kChunk = 1 << 12;
  std::vector<std::int64_t> more(std::size_t((std::int64_t(rows.size()) + kChunk - 1) / kChunk));
  for_each_task(exec, std::ssize(more), [&](std::int64_t chunk) {
    const std::int64_t end = std::min(std::int64_t(rows.size()), (chunk + 1) * kChunk);
    for (std::int64_t r = chunk * kChunk; r < end; ++r) {
      const std::size_t row = rows[std::size_t(r)];
      const double prob = sums.prob(row, 0);
      const bool object = is_object(rule, double(float(prob)));  // compared as in files, whose columns are float
      more[std::size_t(chunk)] += std::int64_t(object) - std::int64_t(labels.label[row] > 0);
      labels.label[row] = float(object);
      labels.boundary[row] = is_boundary(rule, mask_variance(prob));
    }
  });
  for (const std::int64_t m : more) labels.count += m;
}

ImageU8 draw_frame(const Exec& exec, const Model& model, const std::vector<ShownObject>& objects,
                   const FrameRequest& request, CachedStill* last) {
  const std::int64_t n = model.cloud.size();
  const Canvas canvas{exec, model, request.camera, last, rows_drawn(exec, objects, n)};
  const Shown shown = chosen(objects, request.object);
  if (request.layer == Layer::kBoundary && !shown.empty()) return to_bytes(boundary_picture(canvas, shown));
  const double fade = request.layer == Layer::kObject ? 0 : request.layer == Layer::kBackground ? 1 : request.fade;
  if (fade == 0) return to_bytes(colour_of(canvas, rows_of(exec, shown, n, true)));
  if (fade == 1) return to_bytes(colour_of(canvas, rows_of(exec, shown, n, false)));
  const bool marks = request.highlight && !shown.empty();
  RenderedView view = with_labels(canvas, marks ? channels_of(exec, shown, n, false) : std::vector<float>());
  if (fade != 0.5)
    mix(colour_of(canvas, rows_of(exec, shown, n, fade < 0.5)), float(2 * std::abs(fade - 0.5)), view.colour);
  if (marks) highlight(exec, shown, view, view.colour);
  return to_bytes(view.colour);
}

}  // namespace ngs::live
