#pragma once
// The commands of ngs-scene besides import.

namespace ngs::scene_tool {

/// A model without photos -> cameras, renders and scene.json.
int orbit_command(int argc, char** argv);
/// Repeats the checks of a scene.json.
int check_command(int argc, char** argv);
/// Photos and masks with lens distortion -> photos and masks of a pinhole camera.
int undistort_command(int argc, char** argv);
/// Adds errors to masks, to test the robustness of methods.
int degrade_command(int argc, char** argv);

}  // namespace ngs::scene_tool
