#pragma once
// The readers of untrusted bytes. A reader may throw kBadInput or kInconsistent; anything else (a crash, a sanitizer
// report, another exception) is a finding.
//
// To add a reader: its entry in kTargets and a corpus. Inputs of findings go to corpus/NAME/, from which
// replay_test.cpp replays them.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/core/error.h"
#include "ngs/io/capture/capture_source.h"
#include "ngs/io/capture/colmap.h"
#include "ngs/io/capture/sparse_points.h"
#include "ngs/io/capture/transforms_json.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/files/safetensors.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/image/exr.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/ply/query_ply.h"
#include "ngs/io/scene/evidence_file.h"
#include "ngs/io/scene/prompt_files.h"
#include "ngs/io/scene/scene_json.h"

namespace ngs::fuzz {

inline std::string_view text_of(io::Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

inline void read_ply(io::Bytes bytes) {
  const io::PlyFile file = io::PlyFile::parse("fuzz.ply", bytes);
  for (const io::PlyElement& element : file.elements()) {
    const io::PlyTable table = file.table(element);
    for (const io::PlyProperty& p : table.properties)
      if (table.rows > 0) (void)table.column(p.name).value(table.rows - 1);
  }
}

/// Two files in one input: the first `split` bytes are cameras.*, the rest is images.*; `split` is a little-endian u16
/// before them.
template <bool kBinary>
void read_colmap(io::Bytes bytes) {
  if (bytes.size() < 2) return;
  const std::size_t split = std::min(bytes.size() - 2, std::size_t(bytes[0]) | std::size_t(bytes[1]) << 8);
  const io::Bytes cameras(bytes.data() + 2, split), images(bytes.data() + 2 + split, bytes.size() - 2 - split);
  if constexpr (kBinary)
    (void)io::parse_colmap_binary(cameras, images, "fuzz");
  else
    (void)io::parse_colmap_text(text_of(cameras), text_of(images), "fuzz");
}

inline void read_transforms_json(io::Bytes bytes) {
  const io::TransformsSource source{"/data",
                                    "fuzz.json",
                                    true,
                                    {[](const std::string& path) { return path.size() % 2 == 0; },
                                     [](const std::string&) {
                                       return io::ImageSize{640, 480};
                                     }}};
  (void)io::parse_transforms_json(io::parse_json(text_of(bytes), "fuzz.json"), source);
}

inline void read_npy(io::Bytes bytes) {
  const io::NpyMatrix matrix = io::parse_npy(bytes, "fuzz.npy");
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min<std::size_t>(matrix.rows, 1000); ++i) names.push_back(std::to_string(i));
  (void)io::llff_capture(matrix, names, "fuzz.npy");
}

inline void read_image_header(io::Bytes bytes) {
  const auto header = io::parse_image_header(bytes, "fuzz.png");
  if (header && header->palette) (void)io::palette_png_as_indices(bytes);
}

inline auto json_of(io::Bytes bytes) { return io::parse_json(text_of(bytes), "fuzz.json"); }

struct Target {
  std::string_view name;  // of its corpus folder
  void (*read)(io::Bytes);
};
inline constexpr Target kTargets[] = {
    {"ply", read_ply},
    {"gaussian_ply", [](io::Bytes b) { (void)io::parse_gaussian_ply("fuzz.ply", b); }},
    {"spz", [](io::Bytes b) { (void)io::decode_spz("fuzz.spz", b); }},
    {"sog", [](io::Bytes b) { (void)io::decode_sog("fuzz.sog", b); }},
    {"dot_splat", [](io::Bytes b) { (void)io::decode_dot_splat("fuzz.splat", b); }},
    {"ksplat", [](io::Bytes b) { (void)io::decode_ksplat("fuzz.ksplat", b); }},
    {"glb", [](io::Bytes b) { (void)io::decode_glb("fuzz.glb", b); }},
    {"query_ply", [](io::Bytes b) { (void)io::parse_query_ply("fuzz.ply", b); }},
    {"safetensors", [](io::Bytes b) { (void)io::parse_safetensors("fuzz.safetensors", b); }},
    {"evidence", [](io::Bytes b) { (void)io::parse_evidence("fuzz.evidence", b); }},
    {"colmap_bin", read_colmap<true>},
    {"colmap_txt", read_colmap<false>},
    {"transforms_json", read_transforms_json},
    {"cameras_json", [](io::Bytes b) { (void)io::parse_cameras_json(json_of(b), "fuzz.json"); }},
    {"scene_json", [](io::Bytes b) { (void)io::parse_scene_json(json_of(b), "/data", "fuzz.json"); }},
    {"prompts_json", [](io::Bytes b) { (void)io::parse_prompts_json(json_of(b), "fuzz.json"); }},
    {"npy", read_npy},
    {"exr", [](io::Bytes b) { (void)io::parse_exr(b, "fuzz.exr"); }},
    {"image_header", read_image_header},
    {"sparse_points", [](io::Bytes b) { (void)io::parse_points(b, "fuzz"); }},
};

inline void run(const Target& target, io::Bytes bytes) {
  try {
    target.read(bytes);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::kBadInput && e.code() != ErrorCode::kInconsistent) throw;
  }
}

}  // namespace ngs::fuzz
