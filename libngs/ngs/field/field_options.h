#pragma once
// Options of the NeRF. Defaults are the paper's values, or our reading if it gives none (paper.md §4).
#include <functional>
#include <set>
#include <string>
#include <string_view>

#include "ngs/ops/field/film_mlp.h"
#include "ngs/ops/field/hash_grid.h"
#include "ngs/options/field.h"

namespace ngs {

/// Parts of the optimisation that are off, by the names of their effects (--effect NAME=off).
struct PartSwitches {
  std::set<std::string, std::less<>> off = {};
  bool on(std::string_view part) const { return !off.contains(part); }
};

inline constexpr double kHashRate = 1e-2, kMlpRate = 1e-3, kFeatureRate = 2.5e-3;
/// Coarsest resolution and features per level of the NeRF's encoding, and SH degree of its view direction (C14).
inline constexpr int kHashBase = 16, kHashFeatures = 2, kDirectionDegree = 2;

struct FieldOptions {
  int hash_levels = 8, hash_log2_table = 15, hash_finest = 512;
  int mlp_hidden = 64, mlp_layers = 2;
  int smooth_points = 2048;   // query points per step for L_smth
  double smooth_step = 0.01;  // finite-difference step of L_smth, kernel widths (D14)

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.hash_levels,
          Field<int>{"hash_levels", "", "Resolutions L of the hash encoding (Eq. 11)", 1, kMaxHashLevels});
    visit(self.hash_log2_table, Field<int>{"hash_log2_table", "", "log2 of the table size of a hashed level", 3, 24});
    visit(self.hash_finest,
          Field<int>{"hash_finest", "vertices", "Finest resolution along an axis", 2, kMaxHashResolution});
    visit(self.mlp_hidden, Field<int>{"mlp_hidden", "", "Width of the network", 16, 128});
    visit(self.mlp_layers, Field<int>{"mlp_layers", "", "Hidden layers, each modulated (Eq. 14)", 1, kMaxFilmLayers});
  }
};

}  // namespace ngs
