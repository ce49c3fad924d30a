#pragma once
// Files that users pass as a model although they are not one: a PLY in a gzip stream or zip archive, which is read, and
// others that are only recognised for the error message (parts of an unpacked .sog, archives, checkpoints, web pages).
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

struct PackedPly {
  std::vector<std::uint8_t> bytes;
  std::string note;  // where the PLY was found
};

/// The PLY in a gzip stream, or the only PLY in a zip archive that is not a .sog; nullopt if `bytes` are neither.
/// kBadInput, with the archive's contents in the message, if it has no PLY or several, or if the PLY is larger than 64
/// times the file.
std::optional<PackedPly> unpack_ply(const std::string& name, Bytes bytes);

/// kBadInput, with the kind of file and a hint how to get a model, if `bytes` begin like a known file that is not one.
void refuse_known_file(const std::string& name, Bytes bytes);

bool begins_like_ply(Bytes bytes);

/// What a JSON file describes: "an unpacked .sog", "a streamed .sog", or "" for anything else.
std::string_view sog_kind(const nlohmann::json& root);

/// Throws the error for an unpacked or streamed .sog.
[[noreturn]] void refuse_unpacked_sog(const std::string& name, std::string_view kind);

}  // namespace ngs::io
