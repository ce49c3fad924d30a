#pragma once
// ngs cut: the whole chain as one command, for a splat without photos, a capture or a scene.json.
namespace ngs::ngs_tool {

int cut_command(int argc, char** argv);

}  // namespace ngs::ngs_tool
