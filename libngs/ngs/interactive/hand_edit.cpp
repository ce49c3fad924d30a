#include "ngs/interactive/hand_edit.h"

#include <algorithm>
#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/core/error.h"
#include "ngs/cut/masks/mask_consensus.h"
#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/edit/select/clusters.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/scene/geometry/unproject.h"

namespace ngs::live {
namespace {

using Rows = std::vector<std::uint8_t>;  // [N] 1: in the set

Rows inside(const Exec& exec, const Model& model, const HandEdit& edit) {
  const GaussianCloud& cloud = model.cloud;
  Rows rows(std::size_t(cloud.size()));
  const bool is_outline = !edit.outline.empty();
  const Camera camera = is_outline ? camera_of(edit.viewpoint) : Camera();
  ViewPrompt drawn;
  Rows seen(std::size_t(cloud.size()), !edit.visible_only);
  if (is_outline) {
    HandPrompt hand;
    hand.width_px = camera.width_px;
    hand.height_px = camera.height_px;
    hand.polygons = {{true, edit.outline}};
    drawn = rasterise(hand, camera.width_px, camera.height_px);
    if (edit.visible_only)
      for (const std::uint32_t row : lift_mask(exec, cloud, camera, model.splat, PixelMask(drawn.hint.size())).row)
        seen[row] = 1;
  }
  for_each_index(exec, cloud.size(), [&](std::int64_t i) {
    const auto row = std::size_t(i);
    if (!cloud.usable[row]) return;
    const Vec3<double> at = world_position(cloud, row), off = at - edit.centre;
    if (!is_outline) {
      rows[row] = dot(off, off) <= edit.radius * edit.radius;
    } else if (const std::optional<Vec3<double>> pixel = camera.project(at)) {
      const std::size_t p = std::size_t(pixel->y) * std::size_t(camera.width_px) + std::size_t(pixel->x);
      rows[row] = drawn.hint[p] == PixelHint::kObject && seen[row];
    }
  });
  return rows;
}

/// Cells of a grid, for neighbours within the side of a cell.
class NearGrid {
 public:
  NearGrid(const GaussianCloud& cloud, const Rows& of, double side) : cloud_(cloud), side_(side) {
    for (std::size_t i = 0; i < of.size(); ++i)
      if (of[i] && cloud.usable[i]) cells_.emplace_back(cell_of(i), std::uint32_t(i));
    std::sort(cells_.begin(), cells_.end());
  }

  bool has_neighbour(std::size_t row) const {
    const Cell middle = cell_of(row);
    for (int k = 0; k < 9; ++k) {  // three cells along z are one run
      const Cell first{middle[0] + k / 3 - 1, middle[1] + k % 3 - 1, middle[2] - 1};
      for (auto at = std::lower_bound(cells_.begin(), cells_.end(), std::pair(first, std::uint32_t(0)));
           at != cells_.end() && at->first <= Cell{first[0], first[1], first[2] + 2}; ++at)
        if (is_near(row, at->second)) return true;
    }
    return false;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  Cell cell_of(std::size_t row) const {
    Cell cell{};
    for (std::size_t a = 0; a < 3; ++a)
      cell[a] = std::int64_t(std::clamp(std::floor(double(cloud_.position[3 * row + a]) / side_), -1e15, 1e15));
    return cell;
  }
  bool is_near(std::size_t a, std::size_t b) const {
    const Vec3<double> off = world_position(cloud_, a) - world_position(cloud_, b);
    return dot(off, off) <= side_ * side_;
  }

  const GaussianCloud& cloud_;
  double side_;
  std::vector<std::pair<Cell, std::uint32_t>> cells_;
};

/// Moves the edge of the selection by the neighbours on its other side.
void move_edge(const Exec& exec, const GaussianCloud& cloud, bool grow, Rows& selected) {
  const double side = 0.5 * cluster_side(exec, cloud, selected);
  if (!(side > 0)) return;
  Rows other = selected;
  if (!grow)
    for (std::uint8_t& row : other) row = !row;
  const NearGrid grid(cloud, other, side);
  for_each_index(exec, cloud.size(), [&](std::int64_t i) {
    const auto row = std::size_t(i);
    if (cloud.usable[row] && !other[row] && grid.has_neighbour(row)) selected[row] = grow;
  });
}

}  // namespace

ObjectLabels with_edits(const Exec& exec, const Model& model, ObjectLabels labels,
                        std::span<const std::shared_ptr<const HandEdit>> edits, std::span<const std::uint8_t> blocked) {
  const GaussianCloud& cloud = model.cloud;
  Rows selected(labels.label.begin(), labels.label.end());
  for (const auto& one : edits) {
    const HandEdit& edit = *one;
    const bool has_shape = edit.action == EditAction::kAdd || edit.action == EditAction::kTake;
    const Rows rows = has_shape ? inside(exec, model, edit) : Rows();
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (rows[i]) selected[i] = edit.action == EditAction::kAdd;
    if (edit.action == EditAction::kInvert)
      for (std::size_t i = 0; i < selected.size(); ++i) selected[i] = !selected[i] && cloud.usable[i];
    if (edit.action == EditAction::kGrow || edit.action == EditAction::kShrink)
      move_edge(exec, cloud, edit.action == EditAction::kGrow, selected);
  }
  for (std::size_t i = 0; i < blocked.size(); ++i)
    if (blocked[i]) selected[i] = 0;
  for (std::size_t i = 0; i < selected.size(); ++i) {
    if (float(selected[i]) == labels.label[i]) continue;
    labels.label[i] = selected[i];
    labels.boundary[i] = 0;
    labels.count += selected[i] ? 1 : -1;
  }
  return labels;
}

HandEdit ball_at(const Exec& exec, const GaussianCloud& cloud, const SplatOptions& splat, const Viewpoint& viewpoint,
                 std::array<double, 3> x_y_radius_px) {
  const auto [x, y, radius_px] = x_y_radius_px;
  const Camera camera = camera_of(viewpoint);
  RenderRequest request;
  request.colour = false;
  request.depth = true;
  const RenderedView view = render(exec, cloud, camera, splat, request);
  const auto column = std::size_t(std::clamp(x, 0.0, camera.width_px - 1.0)),
             row = std::size_t(std::clamp(y, 0.0, camera.height_px - 1.0));
  const std::size_t p = row * std::size_t(camera.width_px) + column;
  if (!(view.alpha.data[p] >= 0.5f) || !(view.depth.data[p] > 0))
    throw Error(ErrorCode::kUsage, "stroke: nothing is there, expected a part of the splat under it",
                "put the ball on the splat");
  const double z = double(view.depth.data[p] / view.alpha.data[p]);
  HandEdit edit;
  edit.centre = unproject(camera, x, y, z);
  edit.radius = radius_px * z / camera.fy;
  return edit;
}

}  // namespace ngs::live
