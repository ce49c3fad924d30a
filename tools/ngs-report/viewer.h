#pragma once
// A page that shows the object of a run in 3D: splat and WebGL renderer in one file, without network access.
#include <cstdint>
#include <string>
#include <vector>

#include "ngs/options/field.h"
#include "run_folder.h"
#include "shared/run/run.h"

namespace ngs::cli {

struct ViewerOptions {
  int gaussians = 300000;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.gaussians, Field<int>{"viewer_gaussians", "",
                                     "Most Gaussians on the 3D page, 44 bytes each; 0: no 3D page", 0, 20000000});
  }
};

/// Near the end of every 3D page, followed by the version.
inline constexpr const char* kViewerMark = "<!-- ngs ";

struct ViewerPage {
  std::string html;
  std::int64_t shown = 0, left_out = 0;  // Gaussians
};

/// Path of the 3D page of a page: object.html next to report.html, else NAME-object.html next to NAME.html.
std::string viewer_beside(const std::string& page);

bool has_object(const RunFolder& run);  // object.ply is a file of the run's folder

/// Page for object.ply of the run's folder. The first camera looks at the middle of the object, from the side of
/// median_view(), otherwise of the first view of the scene, otherwise of the negative z axis; it is upright and far
/// enough away to show the whole object. The camera turns about the middle of the object. Colours have no view
/// dependence, as in .splat. kBadInput without object.ply, kNothingFound if it contains no Gaussian to draw.
ViewerPage viewer_page(const RunFolder& run, const ViewerOptions& options);

// Where ngs-report writes the 3D page of a run.
struct ViewerOutput {
  const Output& page;    // the page of the run
  const Output& viewer;  // --viewer; not given: viewer_beside(page)
  const ViewerOptions& options;
};

/// Writes the 3D page of a single run and returns its path. Empty: not written, because there are several runs, no
/// object, no file name (stdout) or --viewer-gaussians 0. An object that cannot be shown is an error with --viewer,
/// else a problem of the run. Throws kUsage if the default path is a file
/// that no ngs-report wrote, without -w.
std::string write_viewer(Run& run, const ViewerOutput& output, std::vector<RunFolder>& runs);

}  // namespace ngs::cli
