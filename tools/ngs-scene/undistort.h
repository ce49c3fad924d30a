#pragma once
// ngs-scene undistort: photos and masks with lens distortion -> photos and masks of a pinhole camera.

namespace ngs::capture {

int undistort_command(int argc, char** argv);

}  // namespace ngs::capture
