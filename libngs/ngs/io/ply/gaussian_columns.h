#pragma once
// Names of PLY columns, in the one place that readers and writers share.
#include <array>
#include <string>
#include <string_view>

#include "ngs/io/ply/ply.h"
#include "ngs/scene/gaussian_cloud.h"
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

/// The Inria record for a degree: x y z nx ny nz f_dc f_rest opacity scale rot, all float.
PlyElement inria_element(std::int64_t count, int sh_degree);

/// Fills one row of inria_element() (`degree` as there) from row i.
void store_inria_row(const GaussianCloud& cloud, std::int64_t i, std::uint8_t* to);

/// Whether a comment says how the model is to be rendered ("SplatRenderMode: mip", "antialiased 1").
bool is_render_comment(std::string_view comment);

/// The name of a PLY column cannot hold blanks.
std::string column_suffix(const std::string& object);

/// compressed.ply: decodes the chunk, vertex and sh elements of `file` into an Inria-like table of floats.
/// `is_compressed` tells whether the file is one.
bool is_compressed(const PlyFile& file);
PlyTable decode_compressed(const PlyFile& file);

/// A model with a column filter_3D (Mip-Splatting, GOF, RaDe-GS as trained): what its renderer draws, without that
/// column. With f the filter, every scale s becomes √(s² + f²) and the opacity is multiplied by Π s / Π √(s² + f²).
bool has_3d_filter(const PlyTable& rows);
PlyTable fuse_3d_filter(const PlyTable& rows);

}  // namespace ngs::io
