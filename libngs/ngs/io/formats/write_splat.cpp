#include "ngs/io/formats/write_splat.h"

#include <cstdio>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/core/formatted.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/formats/compressed_ply_write.h"
#include "ngs/io/formats/dot_splat.h"
#include "ngs/io/formats/sog.h"
#include "ngs/io/formats/spz.h"
#include "ngs/io/formats/write_only/glb_write.h"
#include "ngs/io/formats/write_only/usda_write.h"
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

std::vector<std::string> write_splat(const std::string& path, const GaussianPly& model,
                                     const std::vector<std::uint8_t>& keep) {
  if (output_format(path) != SplatFormat::kPly) return write_encoded(path, select_rows(model.cloud, keep));
  write_strict_ply(path, model, keep);
  std::vector<std::string> notes;
  return note_origin(path, model.cloud, notes), notes;
}

}  // namespace ngs::io
