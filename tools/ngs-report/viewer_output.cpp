#include "viewer_output.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "viewer.h"

namespace ngs::cli {
namespace {

/// Whether an earlier run wrote the file, for example one that was killed before it wrote the page.
bool is_viewer_page(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  constexpr std::streamoff kTail = 100;
  file.seekg(0, std::ios::end);
  file.seekg(std::max(std::streamoff(0), std::streamoff(file.tellg()) - kTail));
  const std::string tail{std::istreambuf_iterator<char>(file), {}};
  return tail.find(kViewerMark) != tail.npos;
}

std::string path_of(const Run& run, const ViewerOutput& output, const std::vector<RunFolder>& runs) {
  if (output.viewer) return output.viewer.path;
  if (run.goes_to_stdout(output.page) || runs.size() != 1 || !has_object(runs.front())) return {};
  const std::string path = viewer_beside(output.page.path);
  std::error_code unreadable;
  if (!run.overwrite() && std::filesystem::exists(path, unreadable) && !is_viewer_page(path))
    throw Error(ErrorCode::kUsage, path + ": exists already, expected a free name for the 3D page",
                "replace it with -w, or write no 3D page: --viewer-gaussians 0");
  return path;
}

}  // namespace

std::string write_viewer(Run& run, const ViewerOutput& output, std::vector<RunFolder>& runs) {
  if (output.options.gaussians == 0) {
    run.warn_unused({"--viewer"}, "with --viewer-gaussians 0");
    return {};
  }
  const std::string path = path_of(run, output, runs);
  if (path.empty()) return path;
  try {
    const ViewerPage object = viewer_page(runs.front(), output.options);
    io::write_file(path, object.html);
    run.result()["viewer"] = {{"gaussians", object.shown}, {"left_out", object.left_out}};
    return path;
  } catch (const Error& e) {
    if (output.viewer || e.code() == ErrorCode::kEnvironment) throw;
    runs.front().problems.push_back(e.what());
    return {};
  }
}

}  // namespace ngs::cli
