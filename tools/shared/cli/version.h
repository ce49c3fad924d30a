#pragma once
// What the tools say of themselves, in --version and in reports. Artifacts hold kVersion (core/version.h) alone: the
// same inputs give the same bytes at any commit that computes the same.
namespace ngs::cli {

/// "0.1.0+g1234abc"; in a source file that is written when the tools are built, so that a commit recompiles nothing
/// else.
const char* version_with_commit();

}  // namespace ngs::cli
