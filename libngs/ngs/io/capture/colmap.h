#pragma once
// COLMAP sparse models, binary or text: cameras.* and images.* of one folder. rigs.* and frames.* are not read;
// points3D.* is read by sparse_points.h. Poses are world -> camera, Hamilton quaternion w x y z; the first pixel's
// centre is (0.5, 0.5), as in scene/camera.h.
//
// Camera models: SIMPLE_PINHOLE and PINHOLE with their principal point. Models with distortion are read where every
// distortion parameter has a magnitude below kNegligibleDistortion, or with Distortion::kKept; else kBadInput with the
// command that undistorts. Panoramas are kBadInput.
#include <functional>
#include <string>
#include <string_view>

#include "ngs/io/capture/capture.h"
#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

/// The folder that holds the model: `folder`, or its sparse/0, sparse, 0, colmap/sparse/0, or the first other folder in
/// sparse or colmap/sparse. Empty: no model found.
std::string find_colmap_model(const std::string& folder);

/// How many views of a capture have a photo.
using PhotoCount = std::function<std::size_t(Capture)>;

/// If both encodings exist, the binary files are read, with a note; the text files if the binary ones are damaged or
/// empty, or if more photos exist for them. Image names are as COLMAP wrote them.
Capture read_colmap(const std::string& model_folder, Distortion distortion = Distortion::kRefused,
                    const PhotoCount& photos = {});

/// The same from memory; `object` names the folder in messages.
Capture parse_colmap_binary(Bytes cameras, Bytes images, const std::string& object,
                            Distortion distortion = Distortion::kRefused);
Capture parse_colmap_text(std::string_view cameras, std::string_view images, const std::string& object,
                          Distortion distortion = Distortion::kRefused);

}  // namespace ngs::io
