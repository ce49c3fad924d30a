#pragma once
// The temporaries of outputs that are being written, so that a signal handler can remove them before the
// process ends without unwinding.

namespace ngs::io {

/// Notes a path, of a file or of a folder that holds noted files only, for as long as it lives. Paths beyond 4095 bytes
/// and more than 64 at a time are not noted: their temporaries would survive a signal, never the targets.
class UnfinishedFile {
 public:
  UnfinishedFile() = default;
  ~UnfinishedFile() { release(); }
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;
  void note(const char* path);
  void release();

 private:
  int slot_ = -1;
};

/// Removes what is noted. Async-signal-safe.
void remove_unfinished_files() noexcept;

}  // namespace ngs::io
