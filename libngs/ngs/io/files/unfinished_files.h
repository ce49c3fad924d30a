#pragma once
// Registry of temporary files of outputs in progress, so that a signal handler can remove them before the process ends
// without unwinding.

namespace ngs::io {

/// Registers a path during its lifetime: a file, or a folder that contains registered files only. Paths beyond 4095
/// bytes and more than 64 at a time are not registered: a signal leaves their temporary files, targets are unaffected.
class UnfinishedFile {
 public:
  UnfinishedFile() = default;
  ~UnfinishedFile() { release(); }
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  void track(const char* path);
  void release();

 private:
  int slot_ = -1;
};

/// Removes all registered paths. Async-signal-safe.
void remove_unfinished_files() noexcept;

}  // namespace ngs::io
