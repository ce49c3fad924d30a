#pragma once
// Sources that people try and that are neither a splat nor a capture: what they are, and the next step.
#include <string>

namespace ngs::io {

/// The command that downloads `source`; empty if it is not a web address.
std::string download_remedy(const std::string& source);

/// Throws kBadInput if `source` is "-", a web address, or a file that its name or content shows to be a film, a
/// picture, a mesh or the scene of another program, or a list of cameras that is not read.
void refuse_foreign_file(const std::string& source);

/// The same for a folder without cameras: photos only, a sequence of splats, a scan of an app or a list of cameras;
/// with a splat only the last two.
void refuse_foreign_folder(const std::string& folder, bool has_splat);

}  // namespace ngs::io
