#include <windows.h>

#include <algorithm>
#include <cerrno>

#include "ngs/os/input_file.h"
#include "ngs/os/windows_error.h"

namespace ngs::os {
namespace {

struct Handle {
  HANDLE value;
  bool owned = true;
  ~Handle() {
    if (owned && value != nullptr && value != INVALID_HANDLE_VALUE) CloseHandle(value);
  }
};

int read_all(HANDLE file, std::vector<std::uint8_t>& bytes) {
  for (std::size_t used = 0;;) {
    if (used == bytes.size()) bytes.resize(bytes.size() * 2 + (1 << 16));
    DWORD count = 0;
    const DWORD room = DWORD(std::min<std::size_t>(bytes.size() - used, 1 << 30));
    const bool read = ReadFile(file, bytes.data() + used, room, &count, nullptr);
    if (!read && GetLastError() != ERROR_BROKEN_PIPE && GetLastError() != ERROR_HANDLE_EOF) return last_errno();
    if (!read || count == 0) {
      bytes.resize(used);
      return 0;
    }
    used += count;
  }
}

}  // namespace

bool is_pipe(const std::string&) { return false; }
bool is_device(const std::string&) { return false; }

int load_file(const std::string& path, FileBytes& bytes) {
  if (path == path_of_stdin()) return read_all(GetStdHandle(STD_INPUT_HANDLE), bytes.read);
  const std::wstring name = wide(path);
  const DWORD kind = GetFileAttributesW(name.c_str());
  if (kind != INVALID_FILE_ATTRIBUTES && (kind & FILE_ATTRIBUTE_DIRECTORY) != 0) return EISDIR;
  // Others may rename or replace the file while it is mapped.
  const Handle file{CreateFileW(name.c_str(), GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                                nullptr, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, nullptr)};
  if (file.value == INVALID_HANDLE_VALUE) return last_errno();
  if (GetFileType(file.value) != FILE_TYPE_DISK) return read_all(file.value, bytes.read);
  LARGE_INTEGER size{};
  if (!GetFileSizeEx(file.value, &size)) return last_errno();
  if (size.QuadPart == 0) return 0;
  const Handle mapping{CreateFileMappingW(file.value, nullptr, PAGE_READONLY, 0, 0, nullptr)};
  if (mapping.value == nullptr) return last_errno();
  bytes.map = static_cast<const std::uint8_t*>(MapViewOfFile(mapping.value, FILE_MAP_READ, 0, 0, 0));
  if (bytes.map == nullptr) return last_errno();
  bytes.map_bytes = std::size_t(size.QuadPart);
  return 0;
}

void unmap_file(const FileBytes& bytes) {
  if (bytes.map != nullptr) UnmapViewOfFile(bytes.map);
}

/// Unlocking pages that are not locked removes them from the working set.
void forget_pages(const FileBytes& bytes) {
  if (bytes.map != nullptr) VirtualUnlock(const_cast<std::uint8_t*>(bytes.map), bytes.map_bytes);
}

const char* path_of_stdin() { return "<stdin>"; }  // no name of a file on Windows

}  // namespace ngs::os
