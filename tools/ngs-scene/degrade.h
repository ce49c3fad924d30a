#pragma once
// ngs-scene degrade: a folder of good masks -> a folder of bad ones, to see what a method makes of them.

namespace ngs::capture {

int degrade_command(int argc, char** argv);

}  // namespace ngs::capture
