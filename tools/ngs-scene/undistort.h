#pragma once
// ngs-scene undistort: a capture with lens distortion -> the same photos and masks as a pinhole takes them.

namespace ngs::capture {

int undistort_command(int argc, char** argv);

}  // namespace ngs::capture
