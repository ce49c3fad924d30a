#include "siblings.h"

#include <cstring>

#include "ngs/core/error.h"
#include "shared/os/process.h"
#include "shared/run/sibling_program.h"

namespace ngs::ngs_tool {

const std::vector<Sibling>& siblings() {
  static const std::vector<Sibling> all = {
      {"scene", "ngs-scene", "cameras, photos, masks, a splat -> checked scene.json; makes pictures of a bare splat"},
      {"mask", "ngs-mask", "strokes on some photos -> masks of all views"},
      {"variance", "ngs-variance", "masks -> the Gaussians on the edge of the object"},
      {"sample", "ngs-sample", "query points on rays over the boundary"},
      {"rbf", "ngs-rbf", "boundary features interpolated at the query points"},
      {"joint", "ngs-joint", "labels and Gaussians optimised together"},
      {"extract", "ngs-extract", "labels, or the place of the object -> object.ply and background.ply"},
      {"clean", "ngs-clean", "a splat -> the same without floaters and other debris"},
      {"render", "ngs-render", "colour, masks, depth and labels at the scene's cameras"},
      {"eval", "ngs-eval", "scores of masks against the truth"},
      {"report", "ngs-report", "HTML page of one run, or a comparison of several"},
      {"studio", "ngs-studio", "web page to mark an object on a splat, correct the selection and cut it"},
      {"fit", "ngs-fit", "photos -> a splat"},
      {"synth", "ngs-synth", "analytic scenes with exact masks"}};
  return all;
}

void exec_program(const std::string& program, const std::vector<std::string>& words) {
  std::vector<std::string> argv{program};
  argv.insert(argv.end(), words.begin(), words.end());
  argv = cli::sibling_command(std::move(argv));
  const int reason = os::become(argv);
  throw Error(ErrorCode::kEnvironment, argv[0] + ": cannot be started: " + std::strerror(reason));
}

}  // namespace ngs::ngs_tool
