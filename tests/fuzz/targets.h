#pragma once
// One function per reader of untrusted bytes, with libFuzzer's signature. A reader may throw kBadInput or
// kInconsistent; anything else (a crash, a sanitizer report, another exception) is a finding.
//
// To add a reader: a function here, its line in kTargets, and <name>_fuzz.cpp of three lines. Inputs of findings go to
// corpus/<name>/, from which replay_test.cpp replays them.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/core/error.h"
#include "ngs/io/capture/cameras_json.h"
#include "ngs/io/capture/colmap.h"
#include "ngs/io/capture/llff.h"
#include "ngs/io/capture/sparse_points.h"
#include "ngs/io/capture/transforms_json.h"
#include "ngs/io/files/json_file.h"
#include "ngs/io/files/safetensors.h"
#include "ngs/io/formats/splat_codecs.h"
#include "ngs/io/image/exr.h"
#include "ngs/io/image/image_header.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/ply/query_ply.h"
#include "ngs/io/scene/evidence_file.h"
#include "ngs/io/scene/prompt_files.h"
#include "ngs/io/scene/scene_json.h"

namespace ngs::fuzz {

template <class Read>
int refuses_or_reads(const Read& read) {
  try {
    read();
  } catch (const Error& e) {
    if (e.code() != ErrorCode::kBadInput && e.code() != ErrorCode::kInconsistent) throw;
  }
  return 0;
}

inline int fuzz_ply(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] {
    const io::PlyFile file = io::PlyFile::parse("fuzz.ply", {data, size});
    for (const io::PlyElement& element : file.elements()) {
      const io::PlyTable table = file.table(element);
      for (const io::PlyProperty& p : table.properties)
        if (table.rows > 0) (void)table.column(p.name).value(table.rows - 1);
    }
  });
}

inline int fuzz_gaussian_ply(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] { (void)io::parse_gaussian_ply("fuzz.ply", {data, size}); });
}

inline int fuzz_spz(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] { (void)io::decode_spz("fuzz.spz", {data, size}); });
}

inline int fuzz_dot_splat(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] { (void)io::decode_dot_splat("fuzz.splat", {data, size}); });
}

inline int fuzz_sog(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] { (void)io::decode_sog("fuzz.sog", {data, size}); });
}

inline int fuzz_glb(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] { (void)io::decode_glb("fuzz.glb", {data, size}); });
}

inline int fuzz_ksplat(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] { (void)io::decode_ksplat("fuzz.ksplat", {data, size}); });
}

inline int fuzz_query_ply(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] { (void)io::parse_query_ply("fuzz.ply", {data, size}); });
}

inline int fuzz_safetensors(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] { (void)io::parse_safetensors("fuzz.safetensors", {data, size}); });
}

inline int fuzz_evidence(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] { (void)io::parse_evidence("fuzz.evidence", {data, size}); });
}

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Two files in one input: the first `split` bytes are cameras.*, the rest is images.*; `split` is a
/// little-endian u16 before them.
inline int fuzz_colmap_files(const std::uint8_t* data, std::size_t size, bool binary) {
  if (size < 2) return 0;
  const std::size_t split = std::min(size - 2, std::size_t(data[0]) | std::size_t(data[1]) << 8);
  const std::uint8_t *cameras = data + 2, *images = cameras + split;
  const std::size_t rest = size - 2 - split;
  return refuses_or_reads([&] {
    if (binary)
      (void)io::parse_colmap_binary({cameras, split}, {images, rest}, "fuzz");
    else
      (void)io::parse_colmap_text(text_of(cameras, split), text_of(images, rest), "fuzz");
  });
}
inline int fuzz_colmap_bin(const std::uint8_t* data, std::size_t size) { return fuzz_colmap_files(data, size, true); }
inline int fuzz_colmap_txt(const std::uint8_t* data, std::size_t size) { return fuzz_colmap_files(data, size, false); }

inline int fuzz_transforms_json(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] {
    const io::TransformsSource source{"/data",
                                      "fuzz.json",
                                      true,
                                      {[](const std::string& path) { return path.size() % 2 == 0; },
                                       [](const std::string&) {
                                         return io::ImageSize{640, 480};
                                       }}};
    (void)io::parse_transforms_json(io::parse_json(text_of(data, size), "fuzz.json"), source);
  });
}

inline int fuzz_cameras_json(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads(
      [&] { (void)io::parse_cameras_json(io::parse_json(text_of(data, size), "fuzz.json"), "fuzz.json"); });
}

inline int fuzz_scene_json(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads(
      [&] { (void)io::parse_scene_json(io::parse_json(text_of(data, size), "fuzz.json"), "/data", "fuzz.json"); });
}

inline int fuzz_prompts_json(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads(
      [&] { (void)io::parse_prompts_json(io::parse_json(text_of(data, size), "fuzz.json"), "fuzz.json"); });
}

inline int fuzz_npy(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] {
    const io::NpyMatrix matrix = io::parse_npy({data, size}, "fuzz.npy");
    std::vector<std::string> names;
    for (std::size_t i = 0; i < std::min<std::size_t>(matrix.rows, 1000); ++i) names.push_back(std::to_string(i));
    (void)io::llff_capture(matrix, names, "fuzz.npy");
  });
}

inline int fuzz_exr(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] { (void)io::parse_exr({data, size}, "fuzz.exr"); });
}

inline int fuzz_image_header(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] {
    const auto header = io::parse_image_header({data, size}, "fuzz.png");
    if (header && header->palette) (void)io::palette_png_as_indices({data, size});
  });
}

inline int fuzz_sparse_points(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] { (void)io::parse_points({data, size}, "fuzz"); });
}

struct Target {
  const char* name;  // of its corpus folder
  int (*run)(const std::uint8_t*, std::size_t);
};
inline constexpr Target kTargets[] = {
    {"ply", fuzz_ply},
    {"gaussian_ply", fuzz_gaussian_ply},
    {"spz", fuzz_spz},
    {"sog", fuzz_sog},
    {"dot_splat", fuzz_dot_splat},
    {"ksplat", fuzz_ksplat},
    {"glb", fuzz_glb},
    {"query_ply", fuzz_query_ply},
    {"safetensors", fuzz_safetensors},
    {"evidence", fuzz_evidence},
    {"colmap_bin", fuzz_colmap_bin},
    {"colmap_txt", fuzz_colmap_txt},
    {"transforms_json", fuzz_transforms_json},
    {"cameras_json", fuzz_cameras_json},
    {"scene_json", fuzz_scene_json},
    {"prompts_json", fuzz_prompts_json},
    {"npy", fuzz_npy},
    {"exr", fuzz_exr},
    {"image_header", fuzz_image_header},
    {"sparse_points", fuzz_sparse_points},
};

}  // namespace ngs::fuzz
