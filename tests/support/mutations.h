#pragma once
// Ways to spoil files, as data: what the contract cases do to a good scene before a tool sees it.
//
//   {"truncate": FILE, "bytes": N}  N < 0: that many bytes less        {"truncate": FILE, "share": 0.5}
//   {"replace": FILE, "from": TEXT, "to": TEXT}   the first occurrence; must be there
//   {"write": FILE, "text": TEXT, "times": 1}   {"append": FILE, ...}  {"remove": PATH}   {"mkdir": PATH}
//   {"copy": FROM, "to": TO}        files and folders                  {"link": TARGET, "to": NAME}
//   {"poke": PLY, "property": NAME, "row": I (absent: every row), "value": NUMBER or "nan", "inf", "-inf"}
//   {"bytes": FILE, "at": OFFSET, "hex": "ffff"}                       {"resize": FILE, "bytes": N}
//   zero-filled
//   {"negative": FOLDER}            of every grey PNG in it
//   {"png": FILE, "size": [W, H], "value": 0..255, "channels": 1}
#include <nlohmann/json.hpp>

namespace ngs::test {

/// Throws std::runtime_error if the step does not fit the file, so that a case cannot test nothing.
void apply_mutation(const nlohmann::json& step);

}  // namespace ngs::test
