#include "ngs/edit/extract/import_stage.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/scene/precision/local_origin.h"
#include "ngs/scene/supersplat_state.h"

namespace ngs {
namespace {

using Key = std::array<std::uint32_t, 7>;  // bits of x y z, then opacity and colour

struct Keyed {
  Key key;
  std::uint32_t row;
  bool at(const Keyed& other) const { return std::equal(key.begin(), key.begin() + 3, other.key.begin()); }
};

std::uint32_t bits(double value) { return std::bit_cast<std::uint32_t>(float(value) + 0.0f); }  // -0 is 0

/// Keys of all rows, with `shift` added to the positions, sorted.
std::vector<Keyed> sorted_keys(const GaussianCloud& cloud, const std::array<double, 3>& shift) {
  std::vector<Keyed> keys(std::size_t(cloud.size()));
  for (std::size_t i = 0; i < keys.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      keys[i].key[a] = bits(shift[a] + double(cloud.position[i * 3 + a]));
      keys[i].key[4 + a] = bits(cloud.sh_dc[i * 3 + a]);
    }
    keys[i].key[3] = bits(cloud.logit_opacity[i]);
    keys[i].row = std::uint32_t(i);
  }
  std::sort(keys.begin(), keys.end(),
            [](const Keyed& a, const Keyed& b) { return a.key != b.key ? a.key < b.key : a.row < b.row; });
  return keys;
}

/// Pairs the rows of two sorted groups at one position: rows with equal keys first, the remaining rows in order.
void pair_group(std::span<const Keyed> model, std::span<const Keyed> edit, std::vector<std::int64_t>& found) {
  std::vector<std::uint32_t> model_left, edit_left;
  std::size_t m = 0, e = 0;
  while (m < model.size() || e < edit.size()) {
    if (m < model.size() && e < edit.size() && model[m].key == edit[e].key)
      found[edit[e++].row] = model[m++].row;
    else if (e == edit.size() || (m < model.size() && model[m].key < edit[e].key))
      model_left.push_back(model[m++].row);
    else
      edit_left.push_back(edit[e++].row);
  }
  for (std::size_t k = 0; k < std::min(model_left.size(), edit_left.size()); ++k) found[edit_left[k]] = model_left[k];
}

using RowPairs = std::vector<std::int64_t>;  // [edit rows] row of the model, -1: none

RowPairs match_sorted(const std::vector<Keyed>& model, const std::vector<Keyed>& edited) {
  RowPairs found(edited.size(), -1);
  const auto lies_before = [](const Keyed& a, const Keyed& b) {
    return std::lexicographical_compare(a.key.begin(), a.key.begin() + 3, b.key.begin(), b.key.begin() + 3);
  };
  const auto group_end = [](const std::vector<Keyed>& keys, std::size_t begin) {
    std::size_t end = begin + 1;
    while (end < keys.size() && keys[end].at(keys[begin])) ++end;
    return end;
  };
  for (std::size_t m = 0, e = 0; m < model.size() && e < edited.size();) {
    const bool first = lies_before(model[m], edited[e]), last = lies_before(edited[e], model[m]);
    const std::size_t m_end = group_end(model, m), e_end = group_end(edited, e);
    if (!first && !last) pair_group({&model[m], m_end - m}, {&edited[e], e_end - e}, found);
    if (!last) m = m_end;
    if (!first) e = e_end;
  }
  return found;
}

std::int64_t matched_of(const RowPairs& found) {
  return std::count_if(found.begin(), found.end(), [](std::int64_t row) { return row >= 0; });
}

/// Matches positions in the world. For a model with an origin, positions relative to the origin are tried as well:
/// output files store these, and an editor may have dropped the comment that states the origin.
RowPairs match_rows(const GaussianCloud& cloud, const GaussianCloud& edit) {
  constexpr std::array<double, 3> kNone{};
  RowPairs best = match_sorted(sorted_keys(cloud, cloud.origin), sorted_keys(edit, edit.origin));
  if (cloud.origin == kNone) return best;
  std::array<double, 3> offset;
  for (std::size_t a = 0; a < 3; ++a) offset[a] = edit.origin[a] - cloud.origin[a];
  const std::vector<Keyed> local = sorted_keys(cloud, kNone);
  for (const std::array<double, 3>& shift : {offset, kNone})
    if (RowPairs found = match_sorted(local, sorted_keys(edit, shift)); matched_of(found) >= matched_of(best))
      best = std::move(found);
  return best;
}

struct Points {
  std::vector<float> position;
  std::vector<std::int64_t> row;
  Rows<const float, 3> rows() const { return {position.data(), std::ssize(row)}; }
};

Points points_of(const GaussianCloud& cloud, const std::array<double, 3>& shift) {
  Points points;
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
    if (!cloud.usable[i]) continue;
    for (std::size_t a = 0; a < 3; ++a) points.position.push_back(float(shift[a] + double(cloud.position[i * 3 + a])));
    points.row.push_back(std::int64_t(i));
  }
  return points;
}

/// Greedy one-to-one matching by distance, nearest pairs first. No pairs at all if their median distance shows that the
/// edit was moved.
RowPairs match_nearest(const GaussianCloud& cloud, const GaussianCloud& edit, const std::array<double, 3>& shift) {
  constexpr int kNeighbours = 4;
  constexpr double kFarthest = 0.25, kUsual = 1.0 / 16;  // fractions of the usual size
  const Points model = points_of(cloud, {}), edited = points_of(edit, shift);
  const KnnGraph graph = nearest_points({}, model.rows(), edited.rows(), kNeighbours);
  struct Pair {
    float distance2;
    std::size_t edited, model;
    auto operator<=>(const Pair&) const = default;
  };
  std::vector<Pair> pairs;
  const double size = usual_size(cloud), most2 = kFarthest * kFarthest * size * size;
  for (std::size_t e = 0; e < edited.row.size(); ++e)
    for (int k = 0; k < graph.neighbours; ++k) {
      const std::size_t edge = e * std::size_t(graph.neighbours) + std::size_t(k);
      const float distance2 = graph.dist2[edge];
      if (double(distance2) <= most2) pairs.push_back({distance2, e, graph.index[edge]});
    }
  std::ranges::sort(pairs);
  RowPairs found(std::size_t(edit.size()), -1);
  std::vector<std::uint8_t> taken(model.row.size(), 0);
  std::vector<float> distances2;
  for (const Pair& pair : pairs) {
    std::int64_t& row = found[std::size_t(edited.row[pair.edited])];
    if (row >= 0 || taken[pair.model]) continue;
    row = model.row[pair.model];
    taken[pair.model] = 1;
    distances2.push_back(pair.distance2);
  }
  if (distances2.empty() || double(distances2[distances2.size() / 2]) > kUsual * kUsual * size * size)
    found.assign(found.size(), -1);
  return found;
}

/// The same for positions that the edit's format has rounded, relative to the world or to the model's origin.
RowPairs match_rounded(const GaussianCloud& cloud, const GaussianCloud& edit) {
  std::array<double, 3> offset;
  for (std::size_t a = 0; a < 3; ++a) offset[a] = edit.origin[a] - cloud.origin[a];
  RowPairs best = match_nearest(cloud, edit, offset);
  if (offset == std::array<double, 3>{}) return best;
  RowPairs local = match_nearest(cloud, edit, {});
  return matched_of(local) > matched_of(best) ? local : best;
}

/// How converters turn a model, and how to undo it: coordinate k is sign[k] times the edit's coordinate axis[k].
struct Turn {
  const char* name;
  std::size_t axis[3];
  float sign[3];
};
constexpr Turn kTurns[] = {{"by 180 degrees about x", {0, 1, 2}, {1, -1, -1}},  // y up or y down
                           {"by 180 degrees about z", {0, 1, 2}, {-1, -1, 1}},  // PlayCanvas
                           {"by 180 degrees about y", {0, 1, 2}, {-1, 1, -1}},
                           {"by 90 degrees about x", {0, 2, 1}, {1, 1, -1}},  // y up or z up
                           {"by -90 degrees about x", {0, 2, 1}, {1, -1, 1}}};

GaussianCloud turned_back(GaussianCloud edit, const Turn& turn) {
  for (std::size_t i = 0; i < edit.position.size(); i += 3) {
    const float p[3] = {edit.position[i], edit.position[i + 1], edit.position[i + 2]};
    for (std::size_t k = 0; k < 3; ++k) edit.position[i + k] = turn.sign[k] * p[turn.axis[k]];
  }
  return edit;
}

/// Pairs by exact positions, else by nearest, else the same after turning the edit back; records how in `out`.
RowPairs match_any(const GaussianCloud& cloud, const GaussianCloud& edit, ImportedEdit& out) {
  const auto is_enough = [&](const RowPairs& found) { return 2 * matched_of(found) >= edit.size(); };
  RowPairs exact = match_rows(cloud, edit);
  if (is_enough(exact)) return exact;
  RowPairs rounded = match_rounded(cloud, edit);
  out.by_nearest = true;
  if (is_enough(rounded) || edit.origin != std::array<double, 3>{}) return rounded;
  for (const Turn& turn : kTurns) {
    const GaussianCloud back = turned_back(edit, turn);
    out.turned = turn.name;
    out.by_nearest = false;
    if (RowPairs found = match_rows(cloud, back); is_enough(found)) return found;
    out.by_nearest = true;
    if (RowPairs found = match_rounded(cloud, back); is_enough(found)) return found;
  }
  out.turned.clear();
  return rounded;
}

/// [rows of the model] -1 not in the edit, 0 background, 1 object.
std::vector<std::int8_t> fixed_decisions_of(const std::vector<std::int64_t>& found,
                                            const std::vector<std::uint8_t>& state, bool by_selection,
                                            std::size_t rows) {
  std::vector<std::int8_t> decision(rows, -1);
  for (std::size_t e = 0; e < found.size(); ++e) {
    if (found[e] < 0) continue;
    const std::uint8_t s = state.empty() ? std::uint8_t(0) : state[e];
    decision[std::size_t(found[e])] = (s & kDeletedState) == 0 && (!by_selection || (s & kSelectedState) != 0);
  }
  return decision;
}

/// Throws if the edit contains the whole model as object: nothing was edited, or the file does not contain the edit.
void refuse_whole_model(const GaussianCloud& cloud, const std::vector<std::uint8_t>& object,
                        const std::vector<std::int8_t>& decision) {
  bool changes = false;
  for (std::size_t i = 0; i < decision.size(); ++i) {
    if (!cloud.usable[i]) continue;
    if (decision[i] != 1) return;
    changes |= !object[i];
  }
  if (!changes) return;
  throw Error(ErrorCode::kInconsistent,
              "the edited model contains all Gaussians of the labelled model, expected those of the object only",
              "exports contain no selection: select the object in the editor, invert, delete, then export");
}

}  // namespace

ImportedEdit import_edit(const GaussianCloud& cloud, const std::vector<std::uint8_t>& object,
                         const std::vector<float>& label, const GaussianCloud& edit,
                         const std::vector<std::uint8_t>& state) {
  const std::size_t n = std::size_t(cloud.size());
  NGS_CHECK(object.size() == n && label.size() == n, "one decision and one label per Gaussian");
  NGS_CHECK(state.empty() || std::int64_t(state.size()) == edit.size(), "one state per edited row");
  if (edit.size() == 0)
    throw Error(ErrorCode::kNothingFound, "the edited model: contains no Gaussian, expected those of the object",
                "export the object from the editor");
  ImportedEdit out{.label = label, .fixed = std::vector<float>(n, 0.f)};
  const RowPairs found = match_any(cloud, edit, out);
  out.matched = matched_of(found);
  out.unmatched = edit.size() - out.matched;
  if (2 * out.matched < edit.size())
    throw Error(ErrorCode::kInconsistent,
                "the edited model: " + std::to_string(out.matched) + " of " + std::to_string(edit.size()) +
                    " Gaussians are at positions of the labelled model, expected at least half",
                "edit an output of this model and do not move, rotate or scale it in the editor");

  out.by_selection = std::any_of(state.begin(), state.end(), [](std::uint8_t s) { return s & kSelectedState; });
  const std::vector<std::int8_t> decision = fixed_decisions_of(found, state, out.by_selection, n);
  if (!out.by_selection) refuse_whole_model(cloud, object, decision);
  for (std::size_t i = 0; i < n; ++i) {
    if (decision[i] < 0 && !object[i]) continue;
    const bool is_object = decision[i] == 1;
    out.fixed[i] = 1;
    out.label[i] = is_object;
    out.to_object += is_object && !object[i];
    out.to_background += !is_object && object[i];
  }
  return out;
}

}  // namespace ngs
