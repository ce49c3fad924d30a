#pragma once
// The checks of inputs and outputs before a tool starts to work.
#include "shared/run/report.h"

namespace ngs::cli {

/// Throws kBadInput unless every given input exists and is readable.
void check_inputs(const Spec& spec);
/// Throws kUsage if an output or the report exists (unless `overwrite`), is also an input, or is given twice. Throws
/// kEnvironment if the folder of an output is missing and a file is in its place.
void check_outputs(const Spec& spec, const std::string& report_path, bool overwrite);
/// Creates the folder with all missing levels and returns those created, the topmost first. Throws kEnvironment.
std::vector<std::string> create_folders(const std::string& folder);
/// Throws kUsage if an output or the report is this input, which the tool found in another file.
void refuse_outputs_over(const Spec& spec, const std::string& report_path, const std::string& name,
                         const std::string& input);
/// Sizes of all given inputs and, with `hash`, their content hashes.
std::vector<ReadInput> describe_inputs(const Spec& spec, bool hash);
ReadInput describe_input(const std::string& name, const std::string& path, bool hash);

/// Locks an output folder against a second run, until this object or the process ends. Does nothing where the system
/// has no locks.
class FolderLock {
 public:
  /// `folder` exists. Throws kEnvironment if another run holds it.
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace ngs::cli
