#pragma once
// An output file that appears under its name only when it is complete: write() fills a temporary file in the same
// folder, commit() syncs and renames it. Without commit() (an exception, an early return) the temporary file is removed
// and a previous file at the path is unchanged.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace ngs::io {

// Registry of temporary files of outputs, so that a signal handler can remove them before an end without unwinding.

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

class AtomicFile {
 public:
  /// Opens the temporary file. Throws kEnvironment (no such folder, no permission, the path is a folder). A path that
  /// exists and is not a regular file (a pipe, /dev/null) is written directly.
  explicit AtomicFile(std::string path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Appends. Throws kEnvironment (disk full, input/output error).
  void write(const void* data, std::size_t bytes);
  void write(std::string_view text) { write(text.data(), text.size()); }

  /// For libraries that write by path: write to this path (it has the target's extension), then commit(). Not to be
  /// combined with write().
  const std::string& temporary_path() const { return temporary_; }

  /// Syncs and renames. Throws kEnvironment.
  void commit();

 private:
  void fail(const char* what) const;
  /// Starts write-back of the bytes written so far, so that commit() only waits for the rest.
  void start_write_back();

  std::string path_;    // as given, for messages
  std::string target_;  // symbolic links resolved
  std::string temporary_;
  int descriptor_ = -1;
  std::int64_t written_bytes_ = 0, started_bytes_ = 0;
  bool direct_ = false;
  UnfinishedFile unfinished_;  // the tools' signal handlers remove it
};

void write_file(const std::string& path, std::string_view bytes);

}  // namespace ngs::io
