#include <fcntl.h>
#include <io.h>
#include <windows.h>

#include <algorithm>
#include <cerrno>
#include <random>
#include <vector>

#include "ngs/os/output_file.h"
#include "ngs/os/windows_error.h"
#include "shared/os/files.h"

namespace ngs::os {
namespace {

/// Calls `make` with names that end in random letters until one is free.
template <class Make>
bool with_random_name(std::string& path, const Make& make) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz0123456789";
  std::random_device random;
  for (int tries = 0; tries < 100; ++tries) {
    for (std::size_t i = path.size() - 6; i < path.size(); ++i) path[i] = kLetters[random() % kLetters.size()];
    if (make(path)) return true;
    if (errno != EEXIST) return false;
  }
  return false;
}

struct TemporaryFiles {
  std::vector<std::string> paths;
  ~TemporaryFiles() {
    for (const std::string& path : paths) DeleteFileW(wide(path).c_str());
  }
};

}  // namespace

bool is_readable(const std::string& path) {
  const DWORD kind = GetFileAttributesW(wide(path).c_str());
  errno = kind == INVALID_FILE_ATTRIBUTES ? last_errno() : 0;
  return kind != INVALID_FILE_ATTRIBUTES;
}

bool is_executable(const std::string& path) { return is_readable(path); }
bool owner_keeps_rights() { return true; }

FileVersion version_of_file(const std::string& path) {
  const HANDLE file = CreateFileW(wide(path).c_str(), 0, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                                  nullptr, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, nullptr);
  if (file == INVALID_HANDLE_VALUE) return {};
  BY_HANDLE_FILE_INFORMATION info{};
  const bool known = GetFileInformationByHandle(file, &info);
  CloseHandle(file);
  if (!known || (info.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0) return {};
  const auto joined = [](DWORD high, DWORD low) { return std::uint64_t(high) << 32 | low; };
  return {joined(info.nFileIndexHigh, info.nFileIndexLow),
          100 * std::int64_t(joined(info.ftLastWriteTime.dwHighDateTime, info.ftLastWriteTime.dwLowDateTime))};
}

bool make_temporary_file(std::string& path) {
  return with_random_name(path, [](const std::string& name) {
    const int descriptor = create_file(name);
    if (descriptor >= 0) close_file(descriptor);
    return descriptor >= 0;
  });
}

bool make_temporary_folder(std::string& path) {
  return with_random_name(path, [](const std::string& name) {
    if (CreateDirectoryW(wide(name).c_str(), nullptr)) return true;
    errno = last_errno();
    return false;
  });
}

std::string file_of_bytes(std::string_view bytes) {
  static TemporaryFiles files;
  std::string path(MAX_PATH + 1, '\0');
  path.resize(GetTempPathA(DWORD(path.size()), path.data()));
  path += "ngs-stdin-XXXXXX";
  if (!make_temporary_file(path)) return {};
  files.paths.push_back(path);
  const int descriptor = open_to_write(path);
  while (descriptor >= 0 && !bytes.empty()) {
    const std::int64_t written = write_some(descriptor, bytes.data(), std::min<std::size_t>(bytes.size(), 1 << 30));
    if (written < 0) break;
    bytes.remove_prefix(std::size_t(written));
  }
  if (descriptor >= 0) close_file(descriptor);
  return bytes.empty() ? path : std::string();
}

int unnamed_file(std::string path) {
  HANDLE file = INVALID_HANDLE_VALUE;
  with_random_name(path, [&](const std::string& name) {
    // FILE_APPEND_DATA: reading moves the position that this process shares with its children.
    file = CreateFileW(wide(name).c_str(), FILE_APPEND_DATA | FILE_GENERIC_READ,
                       FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, nullptr, CREATE_NEW,
                       FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE, nullptr);
    if (file == INVALID_HANDLE_VALUE) errno = last_errno();
    return file != INVALID_HANDLE_VALUE;
  });
  return file == INVALID_HANDLE_VALUE ? -1 : _open_osfhandle(std::intptr_t(file), _O_RDWR | _O_BINARY);
}

int lock_folder(const std::string& folder) {
  const HANDLE file = CreateFileW(wide(folder + "/.ngs-lock").c_str(), GENERIC_WRITE, 0, nullptr, OPEN_ALWAYS,
                                  FILE_ATTRIBUTE_HIDDEN | FILE_FLAG_DELETE_ON_CLOSE, nullptr);
  if (file != INVALID_HANDLE_VALUE) return _open_osfhandle(std::intptr_t(file), 0);
  errno = GetLastError() == ERROR_SHARING_VIOLATION ? EWOULDBLOCK : last_errno();
  return -1;
}

void unlock_folder(int descriptor) { close_file(descriptor); }

std::int64_t read_at(int descriptor, void* to, std::size_t bytes, std::int64_t offset) {
  OVERLAPPED from{};
  from.Offset = DWORD(offset);
  from.OffsetHigh = DWORD(offset >> 32);
  DWORD count = 0;
  if (ReadFile(HANDLE(_get_osfhandle(descriptor)), to, DWORD(bytes), &count, &from)) return count;
  if (GetLastError() == ERROR_HANDLE_EOF) return 0;
  errno = last_errno();
  return -1;
}

std::int64_t size_of_file(int descriptor) {
  LARGE_INTEGER size{};
  return GetFileSizeEx(HANDLE(_get_osfhandle(descriptor)), &size) ? size.QuadPart : -1;
}

}  // namespace ngs::os
