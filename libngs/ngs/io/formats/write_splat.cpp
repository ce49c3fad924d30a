#include "ngs/io/formats/write_splat.h"

#include <algorithm>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/core/formatted.h"
#include "ngs/core/listed.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/formats/axes.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/ply/gaussian_columns.h"
#include "ngs/scene/precision/local_origin.h"

namespace ngs::io {
namespace {

std::vector<std::uint8_t> encode(SplatFormat format, const SplatSelection& model) {
  switch (format) {
    case SplatFormat::kSpz: return encode_spz(model);
    case SplatFormat::kSog: return encode_sog(model);
    case SplatFormat::kSplat: return encode_dot_splat(model);
    case SplatFormat::kCompressedPly: return encode_compressed_ply(model);
    case SplatFormat::kGlb: return encode_glb(model);
    case SplatFormat::kUsda: return encode_usda(model);
    case SplatFormat::kKsplat:
    case SplatFormat::kPly: break;
  }
  NGS_CHECK(false, "a format that is written here");
  return {};
}

std::string short_number(double value) { return formatted("%.10g", value); }

void note_origin(const std::string& path, const GaussianCloud& cloud, std::vector<std::string>& notes) {
  if (!needs_local_origin(cloud)) return;
  const bool is_ply = output_format(path) == SplatFormat::kPly;
  notes.push_back(path + ": positions are relative to " + short_number(cloud.origin[0]) + "," +
                  short_number(cloud.origin[1]) + "," + short_number(cloud.origin[2]) +
                  (is_ply ? " (comment ngs-origin)" : " (which the format cannot store)") +
                  "; as world coordinates, float would round them to steps of " + short_number(float_spacing(cloud)));
}

void note_rounding(const std::string& path, const SplatSelection& model, std::vector<std::string>& notes) {
  const SplatFormat format = output_format(path);
  Rounding rounding;
  if (format == SplatFormat::kSpz) rounding = spz_rounding(model);
  if (format == SplatFormat::kCompressedPly) rounding = compressed_ply_rounding(model);
  if (rounding.rows == 0) return;
  notes.push_back(path + ": " + std::to_string(rounding.rows) + " of " + std::to_string(model.rows.size()) +
                  " positions are rounded to steps of " + short_number(rounding.step) +
                  ", wider than the Gaussians: row " + std::to_string(rounding.farthest) + " of the model lies at " +
                  short_number(rounding.coordinate) +
                  "; remove it (ngs-clean removes isolated Gaussians), or write .ply or .sog");
}

/// The direction that is up in the model, if the file is to be turned.
std::optional<Vec3<double>> up_to_turn(SplatFormat format, const PartOfModel& part) {
  if (part.up || part.model.vertical_axis.empty()) return part.up;
  const bool is_y_up = format == SplatFormat::kGlb || format == SplatFormat::kUsda;
  return is_y_up ? std::optional(axis_named(part.model.vertical_axis)) : std::nullopt;
}

std::vector<std::string> write_encoded(const std::string& path, const SplatSelection& model) {
  const std::vector<std::uint8_t> bytes = with_context(path, [&] { return encode(output_format(path), model); });
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  std::vector<std::string> notes;
  note_origin(path, model.cloud, notes);
  note_rounding(path, model, notes);
  if (model.left_out > 0)
    notes.push_back(path + ": " + std::to_string(model.left_out) +
                    " Gaussians have values that are not finite or absurd and are left out; a PLY keeps them");
  return notes;
}

}  // namespace

std::vector<std::string> write_splat(const std::string& path, const GaussianCloud& cloud,
                                     const std::vector<std::uint8_t>& keep, const std::vector<std::string>& comments,
                                     const std::optional<AddedColumn>& added) {
  if (output_format(path) != SplatFormat::kPly) return write_encoded(path, select_rows(cloud, keep));
  write_strict_ply(path, cloud, keep, comments, added);
  std::vector<std::string> notes;
  return note_origin(path, cloud, notes), notes;
}

std::vector<std::string> write_splat(const std::string& path, const PartOfModel& part) {
  const GaussianCloud& cloud = part.edited != nullptr ? *part.edited : part.model.cloud;
  const SplatFormat format = output_format(path);
  std::vector<std::string> notes;
  if (format == SplatFormat::kPly) {
    write_strict_ply(path, part.model, part.keep, part.edited);
    return note_origin(path, cloud, notes), notes;
  }
  SplatSelection rows = select_rows(cloud, part.keep);
  if (const auto up = up_to_turn(format, part); up || part.unit != 1)
    rows.turn = placing(up.value_or(Vec3<double>{0, -1, 0}), part.unit);
  notes = write_encoded(path, rows);
  if (std::string note = note_of_left_columns(path, part.model); !note.empty()) notes.push_back(std::move(note));
  return notes;
}

std::string note_of_left_columns(const std::string& path, const GaussianPly& model) {
  const std::vector<std::string> names = further_columns(model);
  if (names.empty()) return {};
  return path + ": without the columns " + listed(names, 4) +
         (std::ranges::any_of(names, is_motion_column)
              ? ": a splat that moves, this file has its state at the reference time"
              : ", which this output cannot store") +
         "; a PLY of ngs-extract without --fill keeps them";
}

Vec3<double> axis_named(std::string_view axis) {
  const double sign = axis.starts_with('-') ? -1 : 1;
  return {sign * axis.ends_with('x'), sign * axis.ends_with('y'), sign * axis.ends_with('z')};
}

}  // namespace ngs::io
