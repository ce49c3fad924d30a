#pragma once
// Exact K nearest neighbours in 3-D.                                                   before Eq. (8)
//
// Distances are compared in double and ties broken by the lower index, so the result is a function of the
// input alone: not of the search tree, nor of exec.threads. Coincident points are legal. With fewer than K
// points `neighbours` is the number of points (0 points: 0 neighbours, empty tables). All coordinates must be
// finite (NGS_CHECK).
#include "ngs/backend/exec.h"
#include "ngs/scene/knn_graph.h"

namespace ngs {

/// For every query its `neighbours` nearest points; 1 <= neighbours <= kMaxNeighbours.
KnnGraph nearest_points(const Exec& exec, Rows<const float, 3> points, Rows<const float, 3> queries, int neighbours);

/// For every point its nearest other points. A coincident point is another point.
KnnGraph nearest_others(const Exec& exec, Rows<const float, 3> points, int neighbours);

/// 1 where some point lies within `radius` of the query, [queries]. Much cheaper than the distance to the nearest, and
/// nearly free of what lies far from all points. `asked` [queries] 0: is not asked, gets 0, and may be anything; empty:
/// all are.
std::vector<std::uint8_t> any_within(const Exec& exec, Rows<const float, 3> points, Rows<const float, 3> queries,
                                     double radius, const std::vector<std::uint8_t>& asked = {});

/// Fills graph.row_begin and graph.edge from graph.index.
void build_transpose(KnnGraph& graph);

/// Mean distance to a neighbour over the whole graph, world; 0 for an empty graph.
double mean_spacing(const KnnGraph& graph);

}  // namespace ngs
