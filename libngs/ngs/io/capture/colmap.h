#pragma once
// COLMAP sparse models, binary or text: cameras.* and images.* of one folder. points3D.* is not needed, newer
// rigs.* and frames.* neither. Poses are world -> camera, Hamilton quaternion w x y z; the first pixel's
// centre is (0.5, 0.5), as in scene/camera.h.
//
// Cameras: SIMPLE_PINHOLE and PINHOLE, with their true principal point; models with distortion where every distortion
// parameter is < 1e-9 in size, or where distortion is asked for, else kBadInput with what undoes it. Panoramas:
// kBadInput.
#include <string>
#include <string_view>

#include "ngs/io/capture/capture.h"
#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

/// The folder that holds the model: `folder`, or its sparse/0, sparse, 0 or colmap/sparse/0. Empty: none.
std::string find_colmap_model(const std::string& folder);

/// Binary files win where both are there (a note says so). Image names are as COLMAP spells them.
Capture read_colmap(const std::string& model_folder, Distortion distortion = Distortion::kRefused);

/// The same from memory; `object` names the folder in messages.
Capture parse_colmap_binary(Bytes cameras, Bytes images, const std::string& object,
                            Distortion distortion = Distortion::kRefused);
Capture parse_colmap_text(std::string_view cameras, std::string_view images, const std::string& object,
                          Distortion distortion = Distortion::kRefused);

}  // namespace ngs::io
