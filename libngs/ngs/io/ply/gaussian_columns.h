#pragma once
// Names of PLY columns, shared by readers and writers.
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/io/ply/ply.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/labels/boundary_rule.h"
#include "ngs/scene/labels/label_column.h"

namespace ngs::io {

/// The columns that are written per object, in file order.
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
inline constexpr std::string_view kFilledColumn = "ngs_filled";
inline constexpr std::string_view kStateColumn = "state";
inline constexpr std::string_view kFilter3dColumn = "filter_3D";     // Mip-Splatting: width per Gaussian, world units
inline constexpr std::string_view kObjectsComment = "ngs-objects ";  // followed by a JSON array of names
inline constexpr std::string_view kRuleComment = "ngs-boundary ";    // followed by {"tau", "criterion", "exclusive"}
inline constexpr std::string_view kOriginComment = "ngs-origin ";    // followed by x y z: the origin of the positions

/// The Inria record of a degree: x y z nx ny nz f_dc f_rest opacity scale rot, all float.
PlyElement inria_element(std::int64_t count, int sh_degree);

/// Writes row i as a row of inria_element() (same `degree`); `shift` is added to its position.
void store_inria_row(const GaussianCloud& cloud, const std::array<double, 3>& shift, std::int64_t i, std::uint8_t* to);

/// Whether a comment affects how the model is rendered ("SplatRenderMode: mip", "antialiased 1").
bool is_render_comment(std::string_view comment);

/// The axis that nerfstudio's comment names as upwards, "z" for "Vertical Axis: z", with sign; else, and for y, empty.
std::string vertical_axis_in(std::string_view comment);

/// A note that Gaussians are marked as deleted in SuperSplat's state; empty: none are.
std::string deleted_note(const std::vector<std::uint8_t>& state);

/// Whether a column describes how a Gaussian moves, appears or turns in time (Spacetime Gaussians, 4D splats).
bool is_motion_column(std::string_view name);

/// The names of objects as parts of column names: characters that PLY columns cannot have, such as blanks, become '_'.
/// A name that then equals an earlier one gets its number among the objects: "__.2".
std::vector<std::string> column_suffixes(const std::vector<std::string>& objects);

/// Whether the vertices of a PLY are Gaussians, by their property names, in any supported program's naming.
bool is_gaussian_element(const PlyElement& vertex);

/// The centre of positions that are far from 0, rounded to float: set if a column is double and the centre of the
/// bounding box, or of the box of the middle 80 %, is more than 8 half extents from 0.
std::optional<std::array<double, 3>> far_origin(const std::array<PlyColumn, 3>& position, std::int64_t rows);
/// The comment with the origin of a file's positions, and its parser.
std::string origin_comment(const std::array<double, 3>& origin);
std::optional<std::array<double, 3>> origin_in(const std::vector<std::string>& comments);

/// The comment with the rule of a file's labels, and its parser; a malformed one is kBadInput.
std::string rule_comment(const BoundaryRule& rule);
std::optional<BoundaryRule> rule_in(const std::vector<std::string>& comments, const std::string& file);

/// compressed.ply: decodes the chunk, vertex and sh elements of `file` to a table of floats in the Inria layout.
/// `is_compressed`: whether `file` has these elements.
bool is_compressed(const PlyFile& file);
PlyTable decode_compressed(const PlyFile& file);

/// Removes the column filter_3D (Mip-Splatting, GOF, RaDe-GS) by applying it as its renderer does: with f the filter,
/// every scale s becomes √(s² + f²) and the opacity is multiplied by Π s / Π √(s² + f²).
bool has_3d_filter(const PlyTable& rows);
PlyTable fuse_3d_filter(const PlyTable& rows);

/// Renames the columns of other programs, such as scalar_scale_0, rotation_0 and opacities, unless a column of the
/// Inria name exists too; rows are unchanged. Returns a note; empty: nothing changed.
std::string take_foreign_names(PlyTable& rows);

/// The SH degree, 4 or more, of a model that is truncated to degree 3 (as in .spz); 0 for any other number of f_rest_*.
int excess_sh_degree(std::size_t rest_columns);
std::size_t rest_columns_of(const PlyTable& rows);
/// A copy with only the 45 f_rest_* of degrees 1 to 3; `degree` is the degree of `rows`.
PlyTable cut_sh(const PlyTable& rows, int degree);

/// Points with scales and rotations: red, green and blue become f_dc_* if there are none, and an opacity (or alpha, if
/// there is no opacity) of an integer type becomes a logit. Full scale is 1 of floats below 2, 255, else 65535.
/// Returns a note; empty: nothing changed.
std::string take_plain_colours(PlyTable& rows);

/// Converts rotations that are stored as bytes ((v - 128) / 128) or in 0..1 (2 v - 1), which is certain if all
/// quaternions then have length 1, and takes the identity if all are 0. Returns a note; empty: nothing changed.
std::string take_plain_rotations(PlyTable& rows);

/// Detects columns with values after activation: scale_* as lengths instead of logarithms, opacity in 0..1 or as its
/// logarithm instead of a logit. Opacities count as activated if they lie in 0 to 1, 100 or 255 and differ, or if they
/// lie there and scales are activated; as logarithms if none is above 0 and many are near it.
/// Scales do if none is negative and two of these hold: they differ by large factors; as logarithms they would exceed
/// the scene; the opacities are activated. With fewer than 16 rows nothing is detected.
struct Activated {
  bool scale = false, opacity = false;
  bool ones = false;                          // every opacity is 1: opaque, or a logit as any other
  double median_scale = 0, full_opacity = 1;  // 0: logarithms of opacities
  explicit operator bool() const { return scale || opacity; }
};
Activated find_activated(const PlyTable& rows);
std::string describe(const Activated& activated);
/// A copy with logarithms and logits in these columns.
PlyTable deactivated(const PlyTable& rows, const Activated& activated);

}  // namespace ngs::io
