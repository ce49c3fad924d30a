#pragma once
// Multi-resolution hash encoding of positions.                                            Eqs. (10)-(11)
//
// Semantics of instant-ngp (D9): level l has Nmin·b^l vertices along each axis of a fixed box,
// with b = (Nmax/Nmin)^(1/(L-1)). Small levels are dense; large ones hash their vertices into 2^log2_table entries.
// Interpolation is trilinear. Points outside the box are clamped to it; an axis without extent encodes as its middle.
// Results do not depend on exec.threads.
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/ops/field/hash_grid_kernels.h"
#include "ngs/scene/param_store.h"

namespace ngs {

inline constexpr int kMaxHashResolution = 65536;

/// Whether this number of features per entry is implemented.
constexpr bool are_hash_features(int features) {
  return features == 1 || features == 2 || features == 4 || features == 8;
}

struct HashGridConfig {
  int levels = 8;            // L, 1..kMaxHashLevels
  int features = 2;          // F: 1, 2, 4 or 8
  int log2_table = 15;       // entries of a hashed level, 3..24
  int base_resolution = 16;  // Nmin >= 2
  int max_resolution = 512;  // Nmax >= Nmin, at most kMaxHashResolution
  int outputs() const { return levels * features; }
};

/// The cube about the bounding box of `points`, grown by `pad` on every side, world. So grid cells are cubes.
HashBox<float> hash_box(Rows<const float, 3> points, double pad);

/// Resolution and table range of each level.
std::vector<HashLevel> hash_levels(const HashGridConfig& config);

/// Appends the block PREFIX.table [entries, F] with values from U(-1e-4, 1e-4). Returns its offset.
std::size_t add_hash_grid(ParamStore& store, const std::string& prefix, const HashGridConfig& config,
                          std::uint64_t seed);

class HashGrid {
 public:
  /// `offset`: returned by add_hash_grid.
  HashGrid(const HashGridConfig& config, const HashBox<float>& box, std::size_t offset);

  const HashGridConfig& config() const { return config_; }
  const HashBox<float>& box() const { return box_; }
  const std::vector<HashLevel>& levels() const { return levels_; }
  /// [Q, 3] -> [Q, L·F], level-major rows.
  void forward(const Exec& exec, const ParamStore& store, Rows<const float, 3> points, std::vector<float>& out) const;
  /// Adds the table's gradient to store.grads. `grad_out` [Q, L·F].
  void backward(const Exec& exec, ParamStore& store, Rows<const float, 3> points,
                const std::vector<float>& grad_out) const;

 private:
  HashGridView<float> view(const ParamStore& store, Rows<const float, 3> points) const;
  std::uint64_t entries() const { return std::uint64_t(levels_.back().offset) + levels_.back().size; }
  HashGridConfig config_;
  HashBox<float> box_;
  std::size_t offset_;
  std::vector<HashLevel> levels_;
};

}  // namespace ngs
