#pragma once

namespace ngs::ngs_tool {

/// ngs info FILE: what a splat, a scene.json or a capture is, and the command that comes next.
int info_command(int argc, char** argv);

}  // namespace ngs::ngs_tool
