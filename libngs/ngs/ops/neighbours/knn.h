#pragma once
// Exact K nearest neighbours in 3-D.                                                   before Eq. (8)
//
// Distances are compared in double; ties are broken by the lower index. So the result does not depend on the search
// tree or on exec.threads. Coincident points are legal. With fewer than K points, KnnGraph::neighbours is the number of
// points (0 points: 0 neighbours, empty tables). All coordinates must be finite (NGS_CHECK).
#include "ngs/backend/exec.h"
#include "ngs/scene/knn_graph.h"

namespace ngs {

class ResidentResults;

/// The `neighbours` nearest points of every query; 1 <= neighbours <= kMaxNeighbours.
KnnGraph nearest_points(const Exec& exec, Rows<const float, 3> points, Rows<const float, 3> queries, int neighbours);
/// The same, into arrays that stay on the device.
struct GraphResult {
  KnnGraph& graph;
  ResidentResults& memory;
};
void nearest_points(const Exec& exec, Rows<const float, 3> points, Rows<const float, 3> queries, int neighbours,
                    const GraphResult& out);

/// The nearest other points of every point. A coincident point is another point.
KnnGraph nearest_others(const Exec& exec, Rows<const float, 3> points, int neighbours);

/// [queries] 1: a point lies within `radius` of the query. Much cheaper than the nearest distance, and almost free for
/// queries far from all points. `active` [queries] 0: the query is skipped and gets 0, and need not be finite; empty:
/// all are active.
std::vector<std::uint8_t> any_within(const Exec& exec, Rows<const float, 3> points, Rows<const float, 3> queries,
                                     double radius, const std::vector<std::uint8_t>& active = {});

/// Fills graph.row_begin and graph.edge from graph.index.
void build_transpose(KnnGraph& graph);

/// Mean distance to a neighbour over the whole graph, world; 0 for an empty graph.
double mean_spacing(const KnnGraph& graph);

}  // namespace ngs
