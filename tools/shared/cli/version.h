#pragma once
// The version in --version and in reports. Artifacts contain only kVersion (core/version.h), so that two commits that
// compute the same write the same bytes.
namespace ngs::cli {

/// "0.1.0+g1234abc", from a source file generated at build time: a new commit recompiles nothing else.
const char* version_with_commit();

}  // namespace ngs::cli
