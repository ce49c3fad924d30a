#pragma once
// Exact K nearest neighbours on a device: brute force, a tile of points at a time. Distances are compared in the order
// of ops/neighbours/knn.cpp, so graphs are equal. Used before Eq. (8).
#include <type_traits>

#include "ngs/backend/launcher.h"
#include "ngs/core/check.h"
#include "ngs/math/stable.h"
#include "ngs/scene/knn_graph.h"

namespace ngs {

/// Thread = query. K >= `neighbours` candidates are stored: with a constant K they are sorted in registers.
template <int K>
struct NearestPoints {
  static constexpr const char* kName = "nearest_points";
  static constexpr int kThreads = 128, kTile = 256;
  Rows<const float, 3> point, query;
  int neighbours;
  bool exclude_self;     // query i is point i
  std::uint32_t* index;  // [Q, neighbours] out
  float* dist2;          // [Q, neighbours] out

  struct Shared {
    float coordinate[kTile * 3];
  };
  struct Thread {
    float x, y, z;
    float reject;  // larger squared distances in float cannot be among the nearest
    double nearest[K];
    std::uint32_t of[K];
  };

  template <class Block>
  NGS_HD void operator()(Block& block) const {
    const std::int64_t first_query = block.index * kThreads;
    block.phase([&](int t, Shared&, Thread& own) {
      const std::int64_t q = min2(first_query + t, query.n - 1);
      own.x = query.row(q)[0];
      own.y = query.row(q)[1];
      own.z = query.row(q)[2];
      own.reject = HUGE_VALF;
      for (int s = 0; s < K; ++s) {
        own.nearest[s] = HUGE_VAL;
        own.of[s] = 0xffffffffu;
      }
    });
    for (std::int64_t first = 0; first < point.n; first += kTile) {
      const int count = int(min2<std::int64_t>(kTile, point.n - first));
      block.phase([&](int t, Shared& shared, Thread&) {
        for (int i = t; i < count * 3; i += kThreads) shared.coordinate[i] = point.data[first * 3 + i];
      });
      block.phase([&](int t, Shared& shared, Thread& own) {
        const std::int64_t self = exclude_self ? first_query + t : -1;
        for (int j = 0; j < count; ++j)
          if (first + j != self) consider(own, shared.coordinate + j * 3, std::uint32_t(first + j));
      });
    }
    block.phase([&](int t, Shared&, Thread& own) {
      const std::int64_t q = first_query + t;
      if (q >= query.n) return;
      for (int s = 0; s < K; ++s)
        if (s < neighbours) {
          index[q * neighbours + s] = own.of[s];
          dist2[q * neighbours + s] = float(own.nearest[s]);
        }
    });
  }

 private:
  /// Points are visited in ascending order. At equal distance the earlier point therefore stays first.
  NGS_HD void consider(Thread& own, const float* p, std::uint32_t which) const {
    const float fx = p[0] - own.x, fy = p[1] - own.y, fz = p[2] - own.z;
    if (fx * fx + fy * fy + fz * fz > own.reject) return;
    const double dx = double(p[0]) - double(own.x), dy = double(p[1]) - double(own.y),
                 dz = double(p[2]) - double(own.z);
    double distance = dx * dx + dy * dy + dz * dz;
    bool placed = false;  // the farther candidates then move back one place
    for (int s = 0; s < K; ++s) {
      if (!placed && !(distance < own.nearest[s])) continue;
      placed = true;
      const double farther = own.nearest[s];
      const std::uint32_t other = own.of[s];
      own.nearest[s] = distance;
      own.of[s] = which;
      distance = farther;
      which = other;
    }
    // The float sum of squares is off by at most 3 roundings of 6e-8 each.
    for (int s = 0; s < K; ++s)
      if (s == neighbours - 1) own.reject = float(own.nearest[s]) * 1.000002f;
  }
};

struct EdgeKeys {
  static constexpr const char* kName = "edge_keys";
  const std::uint32_t* index;  // [edges]
  std::uint64_t* key;          // [edges] out
  std::uint32_t* edge;         // [edges] out
  NGS_HD void operator()(std::int64_t e) const {
    key[e] = index[e];
    edge[e] = std::uint32_t(e);
  }
};

/// Thread = point; one extra thread writes the end.
struct TransposedRows {
  static constexpr const char* kName = "edge_rows";
  const std::uint64_t* key;  // [edges] sorted
  std::int64_t edges;
  std::int64_t* row_begin;  // [B + 1] out
  NGS_HD void operator()(std::int64_t j) const { row_begin[j] = lower_bound_of(key, edges, std::uint64_t(j)); }
};

struct WideEdges {
  static constexpr const char* kName = "wide_edges";
  const std::uint32_t* from;
  std::int64_t* to;
  NGS_HD void operator()(std::int64_t e) const { to[e] = from[e]; }
};

/// The arrays of a graph, in the memory of `out` if it is resident.
template <class Launcher>
struct GraphOnDevice {
  DeviceBuffer<Launcher, std::uint32_t> index;
  DeviceBuffer<Launcher, float> dist2;
  DeviceBuffer<Launcher, std::int64_t> row_begin, edge;

  /// `points`, `queries`: device pointers. `out` has its numbers and sizes.
  GraphOnDevice(Launcher& launcher, Rows<const float, 3> points, Rows<const float, 3> queries, bool exclude_self,
                const KnnGraph& out)
      : index(of(launcher, out.index)),
        dist2(of(launcher, out.dist2)),
        row_begin(of(launcher, out.row_begin)),
        edge(of(launcher, out.edge)) {
    const auto search = [&](auto capacity) {
      using Kernel = NearestPoints<capacity>;
      launcher.launch_blocks(ceil_div<std::int64_t>(queries.n, Kernel::kThreads),
                             Kernel{points, queries, out.neighbours, exclude_self, index.data(), dist2.data()});
    };
    if (out.neighbours <= 8)
      search(std::integral_constant<int, 8>{});
    else
      search(std::integral_constant<int, 32>{});
    transpose(launcher);
  }

 private:
  template <class T>
  static DeviceBuffer<Launcher, T> of(Launcher& launcher, const std::vector<T>& host) {
    return DeviceBuffer<Launcher, T>::result(launcher, host.data(), std::int64_t(host.size()));
  }
  void transpose(Launcher& launcher) {
    const std::int64_t edges = edge.size();
    NGS_CHECK(edges <= 0xffffffff, "edges are counted in 32 bits");
    const DeviceBuffer<Launcher, std::uint64_t> key(launcher, edges);
    const DeviceBuffer<Launcher, std::uint32_t> sorted(launcher, edges);
    launcher.parallel_for(edges, EdgeKeys{index.data(), key.data(), sorted.data()});
    launcher.sort(key.data(), sorted.data(), edges, 32);
    launcher.parallel_for(row_begin.size(), TransposedRows{key.data(), edges, row_begin.data()});
    launcher.parallel_for(edges, WideEdges{sorted.data(), edge.data()});
  }
};

}  // namespace ngs
