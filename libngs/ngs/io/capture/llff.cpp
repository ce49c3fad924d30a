#include "ngs/io/capture/llff.h"

#include <cmath>

#include "ngs/core/error.h"
#include "ngs/io/capture/pose.h"
#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

Capture llff_capture(const NpyMatrix& poses_bounds, const std::vector<std::string>& image_names,
                     const std::string& object) {
  constexpr std::size_t kColumns = 17;
  if (poses_bounds.columns != kColumns)
    throw Error(ErrorCode::kBadInput, object + ": " + std::to_string(poses_bounds.columns) + " columns, expected 17");
  if (poses_bounds.rows != image_names.size())
    throw Error(ErrorCode::kInconsistent,
                object + ": " + std::to_string(poses_bounds.rows) + " poses, expected one for each of the " +
                    std::to_string(image_names.size()) + " images",
                "name the folder that holds exactly the posed images: --images DIR");
  Capture capture;
  capture.format = "LLFF";
  for (std::size_t i = 0; i < poses_bounds.rows; ++i) {
    const double* row = &poses_bounds.data[i * kColumns];
    const auto at = [&](int r, int c) { return row[r * 5 + c]; };
    const std::string where = object + ": row " + std::to_string(i) + " (" + image_names[i] + ")";
    Camera& camera = capture.views.emplace_back().camera;
    camera.name = image_names[i];
    const double height = at(0, 4), width = at(1, 4);
    if (!(height >= 1 && width >= 1 && height <= double(kMaxSide) && width <= double(kMaxSide)))
      throw Error(ErrorCode::kBadInput, where + ": size " + std::to_string(width) + "x" + std::to_string(height) +
                                            " px, expected 1.." + std::to_string(kMaxSide));
    camera.width_px = int(std::lround(width)), camera.height_px = int(std::lround(height));
    camera.fx = camera.fy = at(2, 4);
    camera.cx = camera.width_px / 2.0, camera.cy = camera.height_px / 2.0;
    Mat3<double> axes;
    for (int r = 0; r < 3; ++r) axes(r, 0) = at(r, 1), axes(r, 1) = at(r, 0), axes(r, 2) = -at(r, 2);
    set_pose(camera, checked_rotation(axes, where), {at(0, 3), at(1, 3), at(2, 3)});
  }
  capture.notes.push_back(object + ": the format has no principal point, the image centre is assumed");
  finish_capture(capture, object);
  return capture;
}

Capture read_llff(const std::string& path, const std::vector<std::string>& image_names) {
  const MappedFile file = map_regular_file(path);
  return llff_capture(parse_npy(file.bytes(), path), image_names, path);
}

}  // namespace ngs::io
