#include "shared/run/paths.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>

#include "ngs/io/capture/foreign_source.h"
#include "ngs/io/files/content_hash.h"
#include "shared/os/files.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;

void for_each_input(const Spec& spec,
                    const std::function<void(const std::string& name, const std::string& path)>& visit) {
  for (const Input& input : spec.inputs)
    if (input) visit(input.name.substr(input.name.find_first_not_of('-')), input.path);
  for (const Inputs& list : spec.input_lists)
    for (const std::string& path : list.paths) visit(list.name.substr(list.name.find_first_not_of('-')), path);
}

void refuse_input(const std::string& output, const std::string& name, const std::string& input) {
  std::error_code ignored;
  if (fs::equivalent(output, input, ignored))
    throw Error(ErrorCode::kUsage, output + ": is also the input '" + name + "', expected another path for the output");
}

/// The path with links resolved, so that one file has one name; empty for a device or pipe, which may be given twice.
fs::path place_of(const std::string& path) {
  std::error_code ignored;
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored) && !fs::is_directory(path, ignored)) return {};
  return (fs::weakly_canonical(path, ignored) / "").parent_path();  // "out/" is "out"
}

/// Throws kUsage if two outputs are one file: the second would replace the first.
void check_distinct(const Spec& spec, const std::string& report_path) {
  std::map<fs::path, std::string> taken;  // by the flag
  const auto take = [&](const std::string& path, const std::string& flag) {
    const fs::path place = path.empty() || path == "-" ? fs::path() : place_of(path);
    if (place.empty()) return;
    const auto [other, is_free] = taken.emplace(place, flag);
    if (!is_free)
      throw Error(ErrorCode::kUsage,
                  path + ": is given both for " + other->second + " and for " + flag + ", expected different paths");
  };
  for (const Output& output : spec.outputs) take(output.path, output.flags.substr(output.flags.find("--")));
  take(report_path, "--report");
}

/// Throws kEnvironment if a folder for the file neither exists nor can be created.
void require_place_for(const std::string& path) {
  std::error_code unreadable;
  fs::path folder = fs::absolute(path).lexically_normal().parent_path();
  while (folder.has_relative_path() && !fs::exists(folder, unreadable)) folder = folder.parent_path();
  if (fs::is_directory(folder, unreadable)) return;
  throw Error(ErrorCode::kEnvironment, path + ": no folder: " + folder.generic_string() + " is a file",
              "choose another path for the output");
}

void check_output(const Spec& spec, const Output& output, bool overwrite) {
  const fs::path path = output.path;
  std::error_code ignored;
  for_each_input(spec,
                 [&](const std::string& name, const std::string& input) { refuse_input(output.path, name, input); });
  require_place_for(output.path);
  if (!fs::exists(path, ignored)) return;
  const bool is_folder = fs::is_directory(path, ignored);
  if (is_folder != output.directory && (is_folder || fs::is_regular_file(path, ignored)))
    throw Error(ErrorCode::kUsage, output.path + ": is a " + (is_folder ? "folder" : "file") + ", expected a " +
                                       (output.directory ? "folder" : "file"));
  const bool occupied = output.directory ? !fs::is_empty(path, ignored) : fs::is_regular_file(path, ignored);
  if (occupied && !overwrite && !output.resumes)
    throw Error(ErrorCode::kUsage, output.path + (is_folder ? ": is not empty" : ": exists already"),
                "replace it with -w");
}

}  // namespace

void check_inputs(const Spec& spec) {
  for_each_input(spec, [](const std::string& name, const std::string& path) {
    if (!os::is_readable(path))
      throw Error(ErrorCode::kBadInput,
                  path + ": " + (errno == ENOENT ? "no such file or folder" : std::strerror(errno)) +
                      " (given as input '" + name + "')",
                  io::download_remedy(path));
  });
}

void refuse_outputs_over(const Spec& spec, const std::string& report_path, const std::string& name,
                         const std::string& input) {
  for (const Output& output : spec.outputs)
    if (output) refuse_input(output.path, name, input);
  if (!report_path.empty()) refuse_input(report_path, name, input);
}

void check_outputs(const Spec& spec, const std::string& report_path, bool overwrite) {
  check_distinct(spec, report_path);
  if (!spec.outputs.empty() && !os::owner_keeps_rights())
    throw Error(ErrorCode::kEnvironment, "umask: takes rights of their owner from new files, expected none",
                "set another first: umask 022");
  for (const Output& output : spec.outputs)
    if (output && output.path != "-") check_output(spec, output, overwrite);
  Output report;
  report.path = report_path;
  if (report) check_output(spec, report, overwrite);
}

std::vector<std::string> create_folders(const std::string& folder) {
  std::vector<std::string> created;
  std::error_code failed;
  fs::path missing = fs::absolute(folder).lexically_normal();
  if (!missing.has_filename()) missing = missing.parent_path();
  std::vector<fs::path> levels;
  for (; missing.has_relative_path() && !fs::exists(missing, failed); missing = missing.parent_path())
    levels.push_back(missing);
  for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
    if (!fs::create_directory(*level, failed) && failed)
      throw Error(ErrorCode::kEnvironment, level->string() + ": cannot be created: " + failed.message(),
                  "choose another path for the output");
    created.push_back(level->string());
  }
  return created;
}

ReadInput describe_input(const std::string& name, const std::string& path, bool hash) {
  ReadInput input{name, path, 0, {}};
  if (hash) {
    io::ContentHash content = io::content_hash(path);
    input.bytes = content.bytes;
    input.xxh3 = std::move(content.xxh3);
  } else if (fs::is_regular_file(path)) {
    input.bytes = fs::file_size(path);
  }
  return input;
}

std::vector<ReadInput> describe_inputs(const Spec& spec, bool hash) {
  std::vector<ReadInput> inputs;
  for_each_input(spec, [&](const std::string& name, const std::string& path) {
    inputs.push_back(describe_input(name, path, hash));
  });
  return inputs;
}

FolderLock::FolderLock(const std::string& folder) : descriptor_(os::lock_folder(folder)) {
  if (descriptor_ < 0 && errno == EWOULDBLOCK)
    throw Error(ErrorCode::kEnvironment, folder + ": another run writes here, expected none",
                "wait until it has ended, or choose another folder with -o");
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) os::unlock_folder(descriptor_);
}

}  // namespace ngs::cli
