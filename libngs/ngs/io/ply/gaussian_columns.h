#pragma once
// Names of PLY columns, in the one place that readers and writers share.
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "ngs/io/ply/ply.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/labels/boundary_rule.h"
#include "ngs/scene/labels/label_columns.h"

namespace ngs::io {

/// The columns that a writer adds per object, in file order.
struct LabelField {
  std::string_view name;
  LabelColumn LabelColumns::*column;
};
inline constexpr std::array<LabelField, 5> kLabelFields{{{"ngs_label", &LabelColumns::label},
                                                         {"ngs_prob", &LabelColumns::prob},
                                                         {"ngs_variance", &LabelColumns::variance},
                                                         {"ngs_views", &LabelColumns::views},
                                                         {"ngs_boundary", &LabelColumns::boundary}}};
inline constexpr std::string_view kFixedColumn = "ngs_fixed";
inline constexpr std::string_view kFloaterColumn = "ngs_floater";
inline constexpr std::string_view kWeightColumn = "ngs_weight";
inline constexpr std::string_view kStateColumn = "state";
inline constexpr std::string_view kFilter3dColumn = "filter_3D";     // Mip-Splatting: a width per Gaussian, world
inline constexpr std::string_view kObjectsComment = "ngs-objects ";  // then a JSON array of names
inline constexpr std::string_view kRuleComment = "ngs-boundary ";     // then JSON: {"tau", "criterion", "exclusive"}
inline constexpr std::string_view kOriginComment = "ngs-origin ";    // then x y z: positions are relative to them

/// The Inria record for a degree: x y z nx ny nz f_dc f_rest opacity scale rot, all float.
PlyElement inria_element(std::int64_t count, int sh_degree);

/// Fills one row of inria_element() (`degree` as there) from row i; `shift` is added to its position.
void store_inria_row(const GaussianCloud& cloud, const std::array<double, 3>& shift, std::int64_t i, std::uint8_t* to);

/// Whether a comment says how the model is to be rendered ("SplatRenderMode: mip", "antialiased 1").
bool is_render_comment(std::string_view comment);

/// The name of a PLY column cannot hold blanks.
std::string column_suffix(const std::string& object);

/// Whether the vertices of a PLY are Gaussians, by the names of its properties: of any program's that is read.
bool is_gaussian_element(const PlyElement& vertex);

/// The middle of positions that are far from 0, each coordinate a float: where a column is double and the middle of the
/// bounding box, or that of the 80 % in the middle, is more than 8 half extents away from 0.
std::optional<std::array<double, 3>> far_origin(const std::array<PlyColumn, 3>& position, std::int64_t rows);
/// The comment that names the origin of the positions in a file, and what such a comment says.
std::string origin_comment(const std::array<double, 3>& origin);
std::optional<std::array<double, 3>> origin_in(const std::vector<std::string>& comments);

/// The comment that records the rule of the labels, and the rule in the comments of `file`; kBadInput for a comment
/// that is no such rule.
std::string rule_comment(const BoundaryRule& rule);
std::optional<BoundaryRule> rule_in(const std::vector<std::string>& comments, const std::string& file);

/// compressed.ply: decodes the chunk, vertex and sh elements of `file` into an Inria-like table of floats.
/// `is_compressed` tells whether the file is one.
bool is_compressed(const PlyFile& file);
PlyTable decode_compressed(const PlyFile& file);

/// A model with a column filter_3D (Mip-Splatting, GOF, RaDe-GS as trained): what its renderer draws, without that
/// column. With f the filter, every scale s becomes √(s² + f²) and the opacity is multiplied by Π s / Π √(s² + f²).
bool has_3d_filter(const PlyTable& rows);
PlyTable fuse_3d_filter(const PlyTable& rows);

/// CloudCompare's PLY: all columns but positions and normals are called scalar_NAME. The prefix goes where no column
/// has the name without it; the rows stay where they are.
bool has_scalar_names(const PlyTable& rows);
void drop_scalar_prefix(PlyTable& rows);

/// SH of a degree beyond 3, which are cut as .spz cuts them: its degree, 4 or more; 0 for any other number of f_rest_*.
int excess_sh_degree(std::size_t rest_columns);
std::size_t rest_columns_of(const PlyTable& rows);
/// A copy with the 45 f_rest_* of degrees 1 to 3; `degree` is that of `rows`.
PlyTable cut_sh(const PlyTable& rows, int degree);

/// Columns that hold values after their activation functions: scale_* lengths in place of logarithms, opacity a share
/// in place of a logit. Shares fill 0 to 1. Lengths are never negative, and two of these hold: they differ by large
/// factors, they make Gaussians larger than the scene where they are read as logarithms, the opacities are shares. Of
/// fewer than 16 rows nothing is concluded.
struct Activated {
  bool scale = false, opacity = false;
  double median_scale = 0;
  explicit operator bool() const { return scale || opacity; }
};
Activated find_activated(const PlyTable& rows);
std::string describe(const Activated& activated);
/// A copy with logarithms and logits in these columns.
PlyTable deactivated(const PlyTable& rows, const Activated& activated);

}  // namespace ngs::io
