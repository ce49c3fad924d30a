#pragma once
// Gaussian splatting models in PLY, read by property name: the Inria layout with or without normals, SH
// degree 0-3 (0, 9, 24 or 45 f_rest; higher degrees are cut to 3, other numbers refused), columns in any order and of
// any scalar type, foreign columns (`mask`, `obj_dc_*`, ...) and elements, ascii and both byte orders, 2DGS without
// scale_2, SuperSplat's compressed.ply, Mip-Splatting's filter_3D, which becomes part of scales and opacities,
// CloudCompare's scalar_NAME, and any of these in a gzip stream or alone in a zip archive. Missing or contradictory
// columns are kBadInput.
//
// Three profiles are written, all binary little-endian and free of clock, host and path:
//   strict      exactly the Inria record: x y z nx ny nz (0) f_dc_0..2 f_rest_* opacity scale_0..2 rot_0..3,
//   all
//               float, with the model's own number of f_rest (62 floats = 248 bytes at degree 3, 17 at degree
//               0)
//   labelled    the input's own columns bit for bit, then float ngs_label ngs_prob ngs_variance ngs_views
//               ngs_boundary (replacing columns of these names); see write_labelled_ply for several objects
//   supersplat  labelled, then `uchar state`, 1 = selected: the editor opens with the object selected
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ngs/io/ply/ply.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/labels/boundary_rule.h"
#include "ngs/scene/labels/label_columns.h"

namespace ngs::io {

struct NamedLabels {
  std::string object = "object";
  LabelColumns columns;
};

struct GaussianPly {
  PlyFile file;   // kept: `rows` may borrow from it
  PlyTable rows;  // the input's columns, verbatim; of compressed.ply, with filter_3D and cut SH the decoded ones
  std::vector<std::string> comments;  // the file's, and how to render it where only a column said so
  GaussianCloud cloud;
  CloudHealth health;
  LabelColumns labels;               // the unsuffixed ngs_* columns; a vector is empty where its column is absent
  std::vector<NamedLabels> objects;  // the suffixed sets of a file with several objects, else empty
  std::string object = "object";     // the object's name, where the file has one
  bool names_object = false;         // it has
  std::vector<float> fixed;          // ngs_fixed: 1 = labelled by hand (ngs-extract --import); empty: absent
  std::vector<float> weight;         // ngs_weight: what the labels' views draw of it, W of Evidence; empty: absent
  std::optional<BoundaryRule> rule;  // by which the labels follow from evidence; nullopt: the file names none
  std::vector<std::uint8_t> state;   // SuperSplat: bit 1 selected, 2 locked, 4 deleted; empty: absent
  std::vector<std::string> notes;    // what a reader of the file should know, one sentence each
};

/// Reads .spz, .sog, .splat and .ksplat too, told by their content or name (io/formats/splat_format.h): `rows` are then
/// decoded into the Inria columns, and `file` has a name only.
///
/// A PLY is memory-mapped; costs the SoA cloud and nothing else for a plain little-endian file without filter_3D.
/// `health` and `cloud.usable` are filled (classify()). A 2DGS model gets log_scale[2] = min(log_scale[0..1]) - ln
/// 1000. Positions stored as double far from 0 (the box of all or of the middle 80 % more than 8 half extents away) are
/// kept relative to `cloud.origin`, so that float does not round the detail away; positions of a file with the comment
/// "ngs-origin X Y Z" are relative to it.
///
/// kCheckOnly: `cloud` has degree 0, but rows whose higher bands are not finite are excluded all the same; the file is
/// intact, so a labelled copy keeps them. For tools that never look at colour: a quarter of the memory at degree 3.
enum class HigherBands : std::uint8_t { kRead, kCheckOnly };
/// kTrained: scale_* are logarithms and opacity a logit; a PLY in which they are not is kBadInput, with the command
/// that converts it. kActivated: such a PLY is read, any other file is kBadInput.
enum class ValueEncoding : std::uint8_t { kTrained, kActivated };
struct ReadOptions {
  HigherBands bands = HigherBands::kRead;
  ValueEncoding encoding = ValueEncoding::kTrained;
};
GaussianPly read_gaussian_ply(const std::string& path, const ReadOptions& options = {});

/// The same on a buffer that outlives the result.
GaussianPly parse_gaussian_ply(std::string name, Bytes bytes);

/// The comment of a model that was trained with the opacity compensation of Mip-Splatting.
inline constexpr const char* kAntialiasedComment = "antialiased 1";
inline std::vector<std::string> trained_comments(const std::string& history, bool antialiased) {
  return antialiased ? std::vector<std::string>{history, kAntialiasedComment} : std::vector<std::string>{history};
}

/// "ngs <tool> <version> <options>", the line to append to `history` below.
std::string history_line(const std::string& tool, const std::string& options_json);

/// Rows with keep[i] != 0, in order; an empty `keep` means all. `comments` are written as they are. Where float does
/// not hold the world's coordinates (needs_local_origin()), positions are relative to the cloud's origin, which a
/// comment ngs-origin names.
void write_strict_ply(const std::string& path, const GaussianCloud& cloud, const std::vector<std::uint8_t>& keep,
                      const std::vector<std::string>& comments = {});
/// The same with the comments of the input that say how to render it.
void write_strict_ply(const std::string& path, const GaussianPly& ply, const std::vector<std::uint8_t>& keep,
                      const std::vector<std::string>& history = {});

struct LabelledWrite {
  const GaussianCloud* edited = nullptr;     // optimised attributes; null: the input's. Unusable rows and values
                                             // equal to the input's keep the input's bits
  std::span<const std::int64_t> source_row;  // [edited rows] row of the input that a row descends from (its
                                             // other columns are copied); empty: the same rows as the input
  std::span<const float> fixed;              // [rows] adds ngs_fixed; empty: the input's column, if any, is kept
  std::span<const float> floater;            // [rows] adds ngs_floater; empty: the input's column, if any, is kept
  std::span<const float> weight;             // [rows] adds ngs_weight; empty: none, whatever the input has
  std::span<const std::uint8_t> state;       // [rows] adds `uchar state` (supersplat)
  std::optional<BoundaryRule> rule = {};     // recorded in a comment; nullopt: the input's comment, if any, is copied
  std::vector<std::string> history;          // appended to the input's comments
};

/// Labels that others keep.
struct LabelSet {
  std::string object;
  const LabelColumns& columns;
};

/// One object: the unsuffixed columns. Several: the unsuffixed columns describe their union (the largest
/// value per column), then every object has its own set `ngs_label_<object>` ..., characters other than
/// [A-Za-z0-9_.-] replaced by '_' (two objects that become one name: kInconsistent). The names themselves
/// are kept in a comment. Every column of every set must have as many rows as the output.
void write_labelled_ply(const std::string& path, const GaussianPly& source, std::span<const LabelSet> objects,
                        const LabelledWrite& options = {});
void write_labelled_ply(const std::string& path, const GaussianPly& source, std::span<const NamedLabels> objects,
                        const LabelledWrite& options = {});

/// The largest value per column and row.
LabelColumns union_of(std::span<const NamedLabels> objects);

}  // namespace ngs::io
