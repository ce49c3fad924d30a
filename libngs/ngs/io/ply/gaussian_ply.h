#pragma once
// Gaussian splatting models in PLY. Columns are found by property name. The reader accepts the Inria layout with or
// without normals, SH degree 0-3 (0, 9, 24 or 45 f_rest; higher degrees are truncated to 3, other numbers rejected),
// columns in any order and of any scalar type, unknown columns (`mask`, `obj_dc_*`, ...) and elements, ascii and both
// byte orders, 2DGS without scale_2, SuperSplat's compressed.ply, Mip-Splatting's filter_3D (applied to scales and
// opacities), CloudCompare's scalar_NAME, and any of these in a gzip stream or as the only PLY of a zip archive.
// Missing or contradictory columns are kBadInput.
//
// Three profiles are written. All are binary little-endian and independent of time, host and path:
// clang-format off
//   strict      the Inria record, all float: x y z nx ny nz (0) f_dc_0..2 f_rest_* opacity scale_0..2 rot_0..3,
//               with the model's number of f_rest (62 floats = 248 bytes at degree 3, 17 floats at degree 0); then the
//               input's further columns, such as those of a splat that moves, bit for bit (further_columns())
//   labelled    the input's columns bit for bit, then float ngs_label ngs_prob ngs_variance ngs_views ngs_boundary
//               (columns of these names are replaced); for several objects see write_labelled_ply
//   supersplat  labelled, then `uchar state`, 1 = selected: the editor opens with the object selected
// clang-format on
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ngs/io/ply/ply.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/labels/boundary_rule.h"
#include "ngs/scene/labels/label_column.h"

namespace ngs::io {

struct NamedLabels {
  std::string object = "object";
  LabelColumns columns;
};

struct GaussianPly {
  PlyFile file;   // owns the mapping from which `rows` may borrow
  PlyTable rows;  // the input's columns, verbatim; decoded for compressed.ply, filter_3D and truncated SH
  std::vector<std::string> comments;  // the file's; plus the render mode if only a column implied it
  GaussianCloud cloud;
  CloudHealth health;
  LabelColumns labels;               // the unsuffixed ngs_* columns; an absent column is an empty vector
  std::vector<NamedLabels> objects;  // the suffixed sets of a file with several objects, else empty
  std::string object = "object";     // the object's name, if the file has one
  bool names_object = false;         // the file has a name for the object
  std::vector<float> fixed;          // ngs_fixed: 1 = labelled by hand (ngs-extract --import); empty: absent
  std::vector<float> weight;         // ngs_weight: rendering weight in the labels' views, W of Evidence; empty: absent
  std::optional<BoundaryRule> rule;  // the rule of the labels; nullopt: not recorded
  std::string vertical_axis;         // of the comment "Vertical Axis: z", with sign; empty: none or y, which some
                                     // programs write for every model
  std::vector<std::uint8_t> state;   // SuperSplat: bit 1 selected, 2 locked, 4 deleted; empty: absent
  std::vector<std::string> notes;    // warnings for the user, one sentence each
};

/// Also reads .spz, .sog, .splat, .ksplat and .glb, detected by content or name (io/formats/splat_format.h): `rows` are
/// then decoded to the Inria columns, and `file` has only a name.
///
/// A PLY is memory-mapped; for a plain little-endian file without filter_3D only the SoA cloud is allocated. `health`
/// and `cloud.usable` are set (classify()). A 2DGS model gets log_scale[2] = min(log_scale[0..1]) - ln 1000. Double
/// positions far from 0 (the box of all, or of the middle 80 %, is more than 8 half extents away) are stored relative
/// to `cloud.origin`, so that float keeps their detail. The comment "ngs-origin X Y Z" is the origin of a file's
/// positions.
///
/// kCheckOnly: `cloud` has degree 0, but rows with non-finite higher bands are still excluded. A labelled copy keeps
/// the file's bands. For tools that do not need colour: a quarter of the memory at degree 3.
enum class HigherBands : std::uint8_t { kRead, kCheckOnly };
/// kTrained: scale_* are logarithms and opacity is a logit; a PLY with activated values is kBadInput, with the command
/// that converts it. kActivated: such a PLY is read; any other file is kBadInput.
enum class ValueEncoding : std::uint8_t { kTrained, kActivated };
struct ReadOptions {
  HigherBands bands = HigherBands::kRead;
  ValueEncoding encoding = ValueEncoding::kTrained;
};
GaussianPly read_gaussian_ply(const std::string& path, const ReadOptions& options = {});

/// The same from a buffer that outlives the result.
GaussianPly parse_gaussian_ply(std::string name, Bytes bytes);

/// The comment of a model trained with Mip-Splatting's opacity compensation.
inline constexpr const char* kAntialiasedComment = "antialiased 1";
inline std::vector<std::string> trained_comments(const std::string& history, bool antialiased) {
  return antialiased ? std::vector<std::string>{history, kAntialiasedComment} : std::vector<std::string>{history};
}

/// "ngs <tool> <version> <options>", an entry for `history` below.
std::string history_line(const std::string& tool, const std::string& options_json);

struct AddedColumn {
  std::string name;
  std::span<const float> values;  // [N] of the model's rows
};

/// Writes rows with keep[i] != 0, in order; an empty `keep` writes all. `comments` are written verbatim. `added` is a
/// float column after those of the Inria record. If float cannot hold world coordinates (needs_local_origin()),
/// positions are relative to the cloud's origin, which is written as the comment ngs-origin.
void write_strict_ply(const std::string& path, const GaussianCloud& cloud, const std::vector<std::uint8_t>& keep,
                      const std::vector<std::string>& comments = {}, const std::optional<AddedColumn>& added = {});
/// Those comments of the input that affect rendering, and its vertical axis.
std::vector<std::string> render_comments(const GaussianPly& ply);
/// Columns of the input beyond the Inria record, labels and selection: what other programs know about each Gaussian.
std::vector<std::string> further_columns(const GaussianPly& ply);
/// Rows with keep[i] != 0 with the further columns and render_comments(). `edited`: other attributes of the same rows;
/// null: the model's.
void write_strict_ply(const std::string& path, const GaussianPly& ply, const std::vector<std::uint8_t>& keep,
                      const GaussianCloud* edited = nullptr);

struct LabelledWrite {
  const GaussianCloud* edited = nullptr;          // optimised attributes; null: the input's. Unusable rows and values
                                                  // equal to the input's keep the input's bits
  std::span<const std::int64_t> source_row = {};  // [edited rows] row of the input that a row descends from (its
                                                  // other columns are copied); empty: the same rows as the input
  std::span<const float> fixed = {};              // [rows] adds ngs_fixed; empty: the input's column, if any, is kept
  std::span<const float> floater = {};            // [rows] adds ngs_floater; empty: the input's column, if any, is kept
  std::span<const float> weight = {};             // [rows] adds ngs_weight; empty: none, whatever the input has
  std::span<const std::uint8_t> state = {};       // [rows] adds `uchar state` (supersplat)
  std::optional<BoundaryRule> rule = {};  // recorded in a comment; nullopt: the input's comment, if any, is copied
  std::vector<std::string> history = {};  // appended to the input's comments
};

/// Labels owned by the caller.
struct LabelSet {
  std::string object;
  const LabelColumns& columns;
};

/// One object: unsuffixed columns. Several objects: the unsuffixed columns describe their union (the largest value per
/// column), and every object has its own columns `ngs_label_<object>` ... with characters other than [A-Za-z0-9_.-]
/// replaced by '_', numbered if two objects get the same name. A comment stores the names. Every column must have
/// as many rows as the output.
void write_labelled_ply(const std::string& path, const GaussianPly& source, std::span<const LabelSet> objects,
                        const LabelledWrite& options = {});
void write_labelled_ply(const std::string& path, const GaussianPly& source, std::span<const NamedLabels> objects,
                        const LabelledWrite& options = {});

/// The largest value per column and row over all objects.
LabelColumns union_of(std::span<const NamedLabels> objects);

/// Writes rows with keep[i] != 0 verbatim, in order, with the input's comments. For compressed.ply, filter_3D and
/// formats other than PLY these are the decoded rows. A column of the input with the name of `added` is replaced.
void write_ply_rows(const std::string& path, const GaussianPly& source, const std::vector<std::uint8_t>& keep,
                    const std::optional<AddedColumn>& added = {});

}  // namespace ngs::io
