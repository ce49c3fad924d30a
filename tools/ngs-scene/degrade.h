#pragma once
// ngs-scene degrade: adds errors to masks, to test the robustness of methods.

namespace ngs::capture {

int degrade_command(int argc, char** argv);

}  // namespace ngs::capture
