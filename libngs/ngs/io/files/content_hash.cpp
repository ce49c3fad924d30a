#include "ngs/io/files/content_hash.h"

#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>

#include "ngs/core/error.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/files/shell_word.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

struct FreeState {
  void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
};
using State = std::unique_ptr<XXH3_state_t, FreeState>;

State new_state() {
  State state(XXH3_createState());
  XXH3_128bits_reset(state.get());
  return state;
}

std::string digits(const State& state) {
  const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                static_cast<unsigned long long>(hash.low64));
  return text;
}

ContentHash file_hash(const fs::path& path) {
  if (os::is_device(path.string()))
    throw Error(ErrorCode::kBadInput, path.generic_string() + ": cannot be read: " + kDevice);
  std::vector<char> chunk(1 << 20), buffer(chunk.size());
  std::ifstream file;
  file.rdbuf()->pubsetbuf(buffer.data(), std::streamsize(buffer.size()));  // each read of a browser's file is a request
  file.open(path, std::ios::binary);
  if (const int reason = errno; !file)
    throw Error(
        ErrorCode::kBadInput, path.generic_string() + ": cannot be read: " + std::strerror(reason),
        reason == EACCES ? "give yourself the right to read it: chmod u+r " + shell_word(path.generic_string()) : "");
  ContentHash hash;
  const State state = new_state();
  while (file) {
    file.read(chunk.data(), std::streamsize(chunk.size()));
    XXH3_128bits_update(state.get(), chunk.data(), std::size_t(file.gcount()));
    hash.bytes += std::uint64_t(file.gcount());
  }
  if (!file.eof()) throw Error(ErrorCode::kBadInput, path.generic_string() + ": cannot be read");
  hash.xxh3 = digits(state);
  return hash;
}

ContentHash folder_hash(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code failed;
  for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed))
    if (entry->is_regular_file()) names.push_back(entry->path().lexically_relative(folder).generic_string());
  if (failed) throw Error(ErrorCode::kBadInput, folder.generic_string() + ": " + failed.message());
  std::sort(names.begin(), names.end());
  ContentHash hash;
  const State state = new_state();
  for (const std::string& name : names) {
    const ContentHash file = file_hash(folder / name);
    hash.bytes += file.bytes;
    const std::string line = name + '\n' + std::to_string(file.bytes) + '\n' + file.xxh3 + '\n';
    XXH3_128bits_update(state.get(), line.data(), line.size());
  }
  hash.xxh3 = digits(state);
  return hash;
}

}  // namespace

std::string files_hash(const std::vector<std::string>& paths) {
  const State state = new_state();
  for (const std::string& path : paths) {
    const std::string line = is_regular_file(path) ? file_hash(path).xxh3 + '\n' : "absent\n";
    XXH3_128bits_update(state.get(), line.data(), line.size());
  }
  return digits(state);
}

ContentHash content_hash(const std::string& path) {
  return fs::is_directory(path) ? folder_hash(path) : file_hash(path);
}

}  // namespace ngs::io
