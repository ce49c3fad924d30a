#include "viewer_output.h"

#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "viewer.h"

namespace ngs::cli {
namespace {

std::string path_of(const Run& run, const ViewerOutput& output, const std::vector<RunFolder>& runs) {
  if (output.viewer) return output.viewer.path;
  if (run.goes_to_stdout(output.page) || runs.size() != 1 || !has_object(runs.front())) return {};
  const std::string path = viewer_beside(output.page.path);
  std::error_code unreadable;
  if (!run.overwrite() && std::filesystem::exists(path, unreadable))
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
