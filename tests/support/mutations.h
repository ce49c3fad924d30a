#pragma once
// File modifications, as data, that contract cases apply to a valid scene before a tool reads it.
//
// clang-format off
//   {"truncate": FILE, "bytes": N}                N < 0: remove that many bytes
//   {"truncate": FILE, "share": 0.5}
//   {"replace": FILE, "from": TEXT, "to": TEXT}   the first occurrence, which must exist
//   {"write": FILE, "text": TEXT, "times": 1}
//   {"append": FILE, ...}                         as write
//   {"remove": PATH}
//   {"mkdir": PATH}
//   {"copy": FROM, "to": TO}                      files and folders
//   {"link": TARGET, "to": NAME}
//   {"poke": PLY, "property": NAME, "row": I (absent: every row), "value": NUMBER or "nan", "inf", "-inf"}
//   {"bytes": FILE, "at": OFFSET, "hex": "ffff"}
//   {"resize": FILE, "bytes": N}                  zero-filled
//   {"negative": FOLDER}                          inverts every grey PNG in it
//   {"png": FILE, "size": [W, H], "value": 0..255, "channels": 1}
// clang-format on
#include <nlohmann/json.hpp>

namespace ngs::test {

/// Throws std::runtime_error if the step does not apply to the file, so that a case cannot pass without its
/// modification.
void apply_mutation(const nlohmann::json& step);

}  // namespace ngs::test
