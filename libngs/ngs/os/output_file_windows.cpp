#include <fcntl.h>
#include <io.h>
#include <process.h>
#include <windows.h>

#include <cerrno>

#include "ngs/os/output_file.h"
#include "ngs/os/windows_error.h"

namespace ngs::os {
namespace {

int open_file(const std::string& path, DWORD how, DWORD sharing) {
  const HANDLE file =
      CreateFileW(wide(path).c_str(), GENERIC_WRITE, sharing, nullptr, how, FILE_ATTRIBUTE_NORMAL, nullptr);
  if (file == INVALID_HANDLE_VALUE) {
    errno = last_errno();
    return -1;
  }
  return _open_osfhandle(std::intptr_t(file), _O_WRONLY | _O_BINARY);
}

}  // namespace

PathKind kind_of_path(const std::string& path) {
  const DWORD kind = GetFileAttributesW(wide(path).c_str());
  if (kind == INVALID_FILE_ATTRIBUTES) return PathKind::kNothing;
  if ((kind & FILE_ATTRIBUTE_DIRECTORY) != 0) return PathKind::kFolder;
  return (kind & FILE_ATTRIBUTE_DEVICE) != 0 ? PathKind::kOther : PathKind::kRegular;
}

int process_id() { return _getpid(); }

// Shared, as libraries open it again by its path, and so that it can be deleted on a signal.
int create_file(const std::string& path) {
  return open_file(path, CREATE_NEW, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE);
}

int open_to_write(const std::string& path) {
  return open_file(path, OPEN_EXISTING, FILE_SHARE_READ | FILE_SHARE_WRITE);
}

std::int64_t write_some(int descriptor, const void* data, std::size_t bytes) {
  return _write(descriptor, data, unsigned(bytes));
}

void start_write_back(int, std::int64_t, std::int64_t) {}

bool sync_file(int descriptor) { return _commit(descriptor) == 0; }

/// An open file cannot be renamed, so it is closed first.
bool replace_file(int descriptor, const std::string& path, const std::string& target) {
  _close(descriptor);
  constexpr DWORD kHow = MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH;
  if (MoveFileExW(wide(path).c_str(), wide(target).c_str(), kHow)) return true;
  errno = last_errno();
  return false;
}

void close_file(int descriptor) { _close(descriptor); }
void remove_file(const char* path) noexcept { DeleteFileA(path); }
void remove_folder(const char* path) noexcept { RemoveDirectoryA(path); }

}  // namespace ngs::os
