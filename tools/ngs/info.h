#pragma once
// What a file is: its format, Gaussians, bounds, foreign columns, and the command that comes next.

namespace ngs::ngs_tool {

/// ngs info FILE, of a splat, a scene.json or a capture.
int info_command(int argc, char** argv);

}  // namespace ngs::ngs_tool
