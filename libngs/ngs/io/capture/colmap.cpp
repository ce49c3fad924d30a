#include "ngs/io/capture/colmap.h"

#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/io/capture/colmap_model.h"
#include "ngs/io/capture/pose.h"
#include "ngs/io/files/byte_reader.h"
#include "ngs/io/files/folder_index.h"
#include "ngs/io/files/mapped_file.h"

namespace ngs::io {
namespace {

namespace fs = std::filesystem;

bool has_model(const fs::path& folder, const char* extension) {
  return is_regular_file((folder / "cameras").generic_string() + extension) &&
         is_regular_file((folder / "images").generic_string() + extension);
}

ColmapCameras read_cameras(ByteReader reader, const ColmapReading& reading) {
  constexpr std::size_t kSmallestCamera = 24 + 2 * 8;  // a panorama's
  ColmapCameras cameras;
  const std::uint64_t count = reader.read_count(kSmallestCamera);
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto id = reader.read<std::int32_t>();
    const auto model_id = reader.read<std::int32_t>();
    const auto width = reader.read<std::uint64_t>(), height = reader.read<std::uint64_t>();
    const std::string where = reader.object() + ": camera " + std::to_string(id);
    const ColmapModel* model = find_colmap_model_by_id(model_id);
    if (model == nullptr) refuse_colmap_model("number " + std::to_string(model_id), where, reading.folder);
    std::vector<double> parameters;
    for (int p = 0; p < model->parameters; ++p) parameters.push_back(reader.read<double>());
    if (!cameras.emplace(id, intrinsics_of({*model, width, height, parameters}, where, reading)).second)
      throw Error(ErrorCode::kBadInput, where + ": defined twice, expected once");
  }
  return cameras;
}

}  // namespace

std::string find_colmap_model(const std::string& folder) {
  for (const char* below : {"", "sparse/0", "sparse", "0", "colmap/sparse/0"}) {
    const fs::path candidate = *below == '\0' ? fs::path(folder) : fs::path(folder) / below;
    if (has_model(candidate, ".bin") || has_model(candidate, ".txt")) return candidate.generic_string();
  }
  for (const char* below : {"sparse", "colmap/sparse"})  // without a model 0
    for (const std::string& name : list_folders((fs::path(folder) / below).generic_string()))
      if (const fs::path candidate = fs::path(folder) / below / name;
          has_model(candidate, ".bin") || has_model(candidate, ".txt"))
        return candidate.generic_string();
  return {};
}

Capture parse_colmap_binary(Bytes cameras, Bytes images, const std::string& object, Distortion distortion) {
  const ColmapCameras intrinsics = read_cameras(ByteReader(cameras, object + "/cameras.bin"), {object, distortion});
  constexpr std::size_t kSmallestImage = 4 + 7 * 8 + 4 + 1 + 8, kPointBytes = 24;
  ByteReader reader(images, object + "/images.bin");
  Capture capture;
  capture.format = "COLMAP binary";
  const std::uint64_t count = reader.read_count(kSmallestImage);
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto id = reader.read<std::int32_t>();
    double pose[7];
    for (double& value : pose) value = reader.read<double>();
    const auto camera_id = reader.read<std::int32_t>();
    const std::string name = reader.read_name();
    reader.skip(reader.read_count(kPointBytes) * kPointBytes);
    const std::string where = reader.object() + ": image " + std::to_string(id) + " (" + name + ")";
    const auto found = intrinsics.find(camera_id);
    if (found == intrinsics.end())
      throw Error(ErrorCode::kBadInput,
                  where + ": camera " + std::to_string(camera_id) + ", expected one of cameras.bin");
    SceneView& view = capture.views.emplace_back();
    set_intrinsics(found->second, name, capture, view);
    view.camera.rotation = rotation_from_quaternion(pose, where);
    view.camera.translation = vec3(pose + 4);
  }
  finish_capture(capture, reader.object());
  return capture;
}

Capture read_colmap(const std::string& model_folder, Distortion distortion) {
  const bool binary = has_model(model_folder, ".bin");
  const std::string extension = binary ? ".bin" : ".txt";
  const MappedFile cameras = map_regular_file(model_folder + "/cameras" + extension);
  const MappedFile images = map_regular_file(model_folder + "/images" + extension);
  if (!binary) return parse_colmap_text(cameras.text(), images.text(), model_folder, distortion);
  Capture capture = parse_colmap_binary(cameras.bytes(), images.bytes(), model_folder, distortion);
  if (has_model(model_folder, ".txt"))
    capture.notes.push_back(model_folder + ": holds a binary and a text model, the binary one is used");
  return capture;
}

}  // namespace ngs::io
