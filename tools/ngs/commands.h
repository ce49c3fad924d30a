#pragma once
// Commands of ngs that no other tool has.
namespace ngs::ngs_tool {

/// ngs cut: the whole chain as one command, for a splat without photos, a capture or a scene.json.
int cut_command(int argc, char** argv);
/// ngs info FILE, of a splat, a scene.json or a capture: format, Gaussians, bounds, foreign columns, the next command.
int info_command(int argc, char** argv);

}  // namespace ngs::ngs_tool
