#pragma once
// Files that are no model in a format of ours but often stand in for one: a PLY in a gzip stream or a zip archive,
// which is read, and others that are only recognised (parts of an unpacked .sog, archives, checkpoints, web pages).
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

struct PackedPly {
  std::vector<std::uint8_t> bytes;
  std::string note;  // where it was
};

/// The PLY in a gzip stream, or the only PLY in a zip archive that is no .sog; nothing where `bytes` are neither.
/// kBadInput, with what the archive holds, where it has none or several, and where the PLY has more than 64 times the
/// bytes of the file.
std::optional<PackedPly> unpack_ply(const std::string& name, Bytes bytes);

/// kBadInput with the kind of the file and the way to a model, where `bytes` begin like a known file that is no model.
void refuse_known_file(const std::string& name, Bytes bytes);

/// What a JSON file describes: "an unpacked .sog", "a streamed .sog", or "" for anything else.
std::string_view sog_kind(const nlohmann::json& root);

/// The error of an unpacked or streamed .sog.
[[noreturn]] void refuse_unpacked_sog(const std::string& name, std::string_view kind);

}  // namespace ngs::io
