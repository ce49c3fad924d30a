#include "ngs/io/formats/compression/zip_archive.h"

#include <minizip/unzip.h>
#include <minizip/zip.h>

#include <algorithm>
#include <cstring>

#include "ngs/core/check.h"
#include "ngs/core/error.h"

namespace ngs::io {
namespace {

struct MemoryFile {
  Bytes input;                       // read
  std::vector<std::uint8_t> output;  // written
  std::size_t at = 0;

  std::size_t size() const { return std::max(input.size(), output.size()); }
};

MemoryFile& file_of(voidpf stream) { return *static_cast<MemoryFile*>(stream); }

voidpf open_file(voidpf opaque, const void*, int) { return opaque; }
int close_file(voidpf, voidpf) { return 0; }
int error_of_file(voidpf, voidpf) { return 0; }
ZPOS64_T tell_file(voidpf, voidpf stream) { return file_of(stream).at; }

uLong read_file(voidpf, voidpf stream, void* to, uLong size) {
  MemoryFile& file = file_of(stream);
  const std::size_t n = std::min<std::size_t>(size, file.input.size() - std::min(file.at, file.input.size()));
  if (n > 0) std::memcpy(to, file.input.data() + file.at, n);
  file.at += n;
  return uLong(n);
}

uLong write_file(voidpf, voidpf stream, const void* from, uLong size) {
  MemoryFile& file = file_of(stream);
  if (file.output.size() < file.at + size) file.output.resize(file.at + size);
  if (size > 0) std::memcpy(file.output.data() + file.at, from, size);
  file.at += size;
  return size;
}

long seek_file(voidpf, voidpf stream, ZPOS64_T offset, int origin) {
  MemoryFile& file = file_of(stream);
  const std::size_t base = origin == ZLIB_FILEFUNC_SEEK_CUR   ? file.at
                           : origin == ZLIB_FILEFUNC_SEEK_END ? file.size()
                                                              : 0;
  const std::size_t to = base + std::size_t(offset);
  if (to > file.size()) return -1;
  file.at = to;
  return 0;
}

zlib_filefunc64_def functions_of(MemoryFile& file) {
  return {open_file, read_file, write_file, tell_file, seek_file, close_file, error_of_file, &file};
}

/// The path of the archive's current entry; empty if it cannot be read.
std::string current_entry(unzFile archive, unz_file_info64& info) {
  constexpr std::size_t kMaxNameBytes = 256;
  char found[kMaxNameBytes] = {};
  if (unzGetCurrentFileInfo64(archive, &info, found, kMaxNameBytes - 1, nullptr, 0, nullptr, 0) != UNZ_OK) return {};
  return found;
}

}  // namespace

struct ZipReader::Impl {
  MemoryFile file;
  unzFile archive = nullptr;

  ~Impl() {
    if (archive != nullptr) unzClose(archive);
  }
};

ZipReader::ZipReader(const std::string& name, Bytes bytes) : name_(name), impl_(std::make_unique<Impl>()) {
  impl_->file.input = bytes;
  zlib_filefunc64_def functions = functions_of(impl_->file);
  impl_->archive = unzOpen2_64("", &functions);
  if (impl_->archive == nullptr) fail("not a zip archive, or a truncated one, expected a complete zip archive");
}

ZipReader::~ZipReader() = default;

void ZipReader::fail(const std::string& message) const {
  throw Error(ErrorCode::kBadInput, name_ + ": " + message, "copy or export it again");
}

std::vector<std::string> ZipReader::names() const {
  std::vector<std::string> names;
  unz_file_info64 info;
  for (int status = unzGoToFirstFile(impl_->archive); status == UNZ_OK; status = unzGoToNextFile(impl_->archive)) {
    const std::string path = current_entry(impl_->archive, info);
    if (path.empty()) break;
    if (!path.ends_with('/')) names.push_back(path);
  }
  return names;
}

std::vector<std::uint8_t> ZipReader::read(const std::string& entry, std::size_t max_bytes) const {
  const unzFile archive = impl_->archive;
  for (int status = unzGoToFirstFile(archive); status == UNZ_OK; status = unzGoToNextFile(archive)) {
    unz_file_info64 info;
    const std::string path = current_entry(archive, info);
    if (path.empty()) break;
    if (path != entry && !path.ends_with("/" + entry)) continue;
    if (info.uncompressed_size > max_bytes)
      fail("'" + entry + "' of " + std::to_string(info.uncompressed_size) + " bytes, expected at most " +
           std::to_string(max_bytes));
    std::vector<std::uint8_t> bytes(info.uncompressed_size);
    bool whole = unzOpenCurrentFile(archive) == UNZ_OK;
    for (std::size_t done = 0; whole && done < bytes.size();) {
      const int n = unzReadCurrentFile(archive, bytes.data() + done,
                                       unsigned(std::min(bytes.size() - done, std::size_t(1) << 30)));
      whole = n > 0;
      done += whole ? std::size_t(n) : 0;
    }
    if (!whole || unzCloseCurrentFile(archive) != UNZ_OK) fail("'" + entry + "' is damaged, expected an intact entry");
    return bytes;
  }
  fail("no entry '" + entry + "', expected it in the archive");
}

std::vector<std::uint8_t> zip(const std::vector<ZipEntry>& entries) {
  MemoryFile file;
  zlib_filefunc64_def functions = functions_of(file);
  const zipFile archive = zipOpen2_64("", APPEND_STATUS_CREATE, nullptr, &functions);
  NGS_CHECK(archive != nullptr, "an archive in memory opens");
  zip_fileinfo info{};
  info.dosDate = 1u << 21 | 1u << 16;  // 1 January 1980
  bool fine = true;
  for (const ZipEntry& entry : entries) {
    const bool is_large = entry.bytes.size() > 0xfffffffeu;
    fine &= zipOpenNewFileInZip64(archive, entry.name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr, 0, 0,
                                  is_large ? 1 : 0) == ZIP_OK;
    for (std::size_t done = 0; done < entry.bytes.size();) {
      const std::size_t n = std::min(entry.bytes.size() - done, std::size_t(1) << 30);
      fine &= zipWriteInFileInZip(archive, entry.bytes.data() + done, unsigned(n)) == ZIP_OK;
      done += n;
    }
    fine &= zipCloseFileInZip(archive) == ZIP_OK;
  }
  fine &= zipClose(archive, nullptr) == ZIP_OK;
  NGS_CHECK(fine, "an archive in memory takes its entries");
  return std::move(file.output);
}

}  // namespace ngs::io
