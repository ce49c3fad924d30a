#include <cstring>

#include "ngs/core/error.h"
#include "ngs/io/formats/quantise.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/math/elementary.h"

namespace ngs::io {
namespace {

struct Record {
  float position[3], scale[3];
  std::uint8_t rgba[4], rotation[4];
};
static_assert(sizeof(Record) == 32);

constexpr double kRotationOffset = 128, kRotationSteps = 128;

SplatRow row_of(const Record& record) {
  SplatRow row;
  double q[4], length = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    q[k] = (record.rotation[k] - kRotationOffset) / kRotationSteps;
    length = portable_hypot(length, q[k]);
  }
  for (std::size_t k = 0; k < 4; ++k) row.rotation[k] = length > 0 ? float(q[k] / length) : 0.f;
  for (std::size_t a = 0; a < 3; ++a) {
    row.position[a] = record.position[a];
    row.log_scale[a] = log_of(record.scale[a]);
    row.sh_dc[a] = float(dc_of_colour(record.rgba[a] / 255.0));
  }
  row.logit_opacity = logit_of_alpha_byte(record.rgba[3]);
  return row;
}

Record record_of(const SplatRow& row) {
  Record record;
  for (std::size_t a = 0; a < 3; ++a) {
    record.position[a] = row.position[a];
    record.scale[a] = exp_of(row.log_scale[a]);
    record.rgba[a] = to_byte(255 * colour_of_dc(double(row.sh_dc[a])));
  }
  record.rgba[3] = alpha_byte(row.logit_opacity);
  const double sign = row.rotation[largest_component(row.rotation)] > 0 ? -1 : 1;
  for (std::size_t k = 0; k < 4; ++k)
    record.rotation[k] = to_byte(sign * row.rotation[k] * kRotationSteps + kRotationOffset);
  return record;
}

}  // namespace

DecodedSplat decode_dot_splat(const std::string& name, Bytes bytes) {
  if (bytes.empty() || bytes.size() % sizeof(Record) != 0)
    throw Error(ErrorCode::kBadInput,
                name + ": " + std::to_string(bytes.size()) + " bytes, expected records of 32 bytes (.splat)",
                "copy or export it again");
  DecodedSplat decoded;
  decoded.rows = splat_table(std::int64_t(bytes.size() / sizeof(Record)), 0);
  for (std::int64_t i = 0; i < decoded.rows.rows; ++i) {
    Record record;
    std::memcpy(&record, bytes.data() + std::size_t(i) * sizeof record, sizeof record);
    store_row(decoded.rows, i, row_of(record));
  }
  decoded.notes.push_back(".splat: colours and rotations are bytes, without spherical harmonics");
  return decoded;
}

std::vector<std::uint8_t> encode_dot_splat(const SplatSelection& model) {
  std::vector<std::uint8_t> bytes(model.rows.size() * sizeof(Record));
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    const Record record = record_of(load_row(model, model.rows[i]));
    std::memcpy(bytes.data() + i * sizeof record, &record, sizeof record);
  }
  return bytes;
}

}  // namespace ngs::io
