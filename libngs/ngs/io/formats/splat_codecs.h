#pragma once
// Readers (decode_*) and writers (encode_*) of splat formats other than PLY; docs/formats.md.
//
// .splat models (antimatter15): records of 32 bytes without a header. 3 float position, 3 float scale (linear, not
// logarithmic), 4 bytes red green blue alpha, 4 bytes rotation w x y z as (byte - 128) / 128. SH of degree 0 only; the
// frame is that of a PLY.
#include <string>
#include <vector>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// kBadInput unless `bytes` are one or more complete records.
DecodedSplat decode_dot_splat(const std::string& name, Bytes bytes);

/// Rows in order. Opacity and rgb are rounded to 1/255, rgb is clamped to 0..1; rotation components are rounded to
/// 1/128. Of the two signs of a quaternion the one with a negative largest component is written, because a byte can
/// represent -1 but not 1.
std::vector<std::uint8_t> encode_dot_splat(const SplatSelection& model);

// Reads binary glTF with KHR_gaussian_splatting, uncompressed: what encode_glb() and splat-transform write.

/// All splats of the file's scene, with the transforms of their nodes, in the frame of a PLY. Attributes are float or,
/// where glTF allows it, normalised integers. Throws kBadInput, also for a file without splats, for compressed ones,
/// and for nodes that reflect or scale unevenly.
DecodedSplat decode_glb(const std::string& name, Bytes bytes);

// Binary glTF with KHR_gaussian_splatting (Khronos, ratified): points with ROTATION (x y z w), SCALE (linear), OPACITY
// (0 to 1) and SH coefficients as float attributes. The frame is x left, y up, z forward.

/// Rows in order, as float: the only loss is rounding of exp(log scale) and of the opacity. kUsage beyond 4 GiB, the
/// limit of .glb. Equal models give equal bytes.
std::vector<std::uint8_t> encode_glb(const SplatSelection& model);

// OpenUSD text with a prim of ParticleField3DGaussianSplat (UsdVol, OpenUSD 26.03): linear scales and opacities, unit
// quaternions w x y z, SH coefficients with the constant one first. The frame is x right, y up, z back.

/// Rows in order. Numbers are the shortest that read back as the same float, so the only loss is rounding of exp(log
/// scale) and of the opacity. Equal models give equal bytes.
std::vector<std::uint8_t> encode_usda(const SplatSelection& model);

// .ksplat models (mkkellogg's GaussianSplats3D), versions 0.1 and later 0.x. Layout: a header of 4096 bytes, a header
// of 1024 bytes per section, then per section: sizes of the partially filled buckets, centres of all buckets,
// Gaussians.
//
// clang-format off
//   compression 0   position, scale, rotation and SH as floats
//   compression 1   positions as 16 bits about the bucket centre; scale, rotation and SH as half floats
//   compression 2   as 1, but SH as bytes between a minimum and a maximum
// clang-format on
//
// Colour and opacity are always bytes; scales are linear, not logarithmic; rotation is w x y z; the frame is that of a
// PLY.

/// kBadInput unless the file is complete. Every count is checked against the file size before memory is allocated.
DecodedSplat decode_ksplat(const std::string& name, Bytes bytes);

// .spz models, versions 1 to 4. The file's frame is x right, y up, z back unless extension 0xADBE0003 names another;
// models are converted to and from the frame of a PLY.

/// kBadInput unless the file is complete; sizes are checked before memory is allocated. SH of degree 4 are truncated to
/// degree 3.
DecodedSplat decode_spz(const std::string& name, Bytes bytes);

/// Writes version 3. Positions are rounded to 2^-bits (error: half a step), with at most 16 fractional bits and as many
/// as the largest coordinate leaves of 23 bits and a sign. Other attributes have an error of half a step within their
/// range and are clamped outside: opacity 1/255; colour f_dc ±3.33, step 0.0261; ln scale -10 to 5.94, step 1/16; SH -1
/// to 0.99, step 1/128; rotation components except the largest, step 0.00138. Equal models give equal bytes. kUsage for
/// a coordinate beyond 2^23.
std::vector<std::uint8_t> encode_spz(const SplatSelection& model);

/// Rows whose rounding error in encode_spz() exceeds the Gaussians' size.
Rounding spz_rounding(const SplatSelection& model);

// .sog models (PlayCanvas; specification: developer.playcanvas.com, "The SOG Format"): a zip archive of meta.json and
// WebP images, one texel per Gaussian, row by row. The frame is that of a PLY.
//
// clang-format off
//   means_l, means_u   low and high bytes of sign(p) ln(1 + |p|), between "mins" and "maxs"
//   quats              the three smallest components · √2 as (byte / 255) · 2 - 1, and 252 + index of the largest of
//                      w x y z
//   scales             ln scale, as index into a codebook (version 1: between mins and maxs)
//   sh0                colour as index into a codebook, opacity in 255ths (version 1: all between mins and maxs,
//                      opacity as a logit)
//   shN_labels         16-bit index of an entry of shN_centroids
//   shN_centroids      64 entries per image row, one texel per coefficient: red green blue as indices into a codebook
//                      (version 1: between mins and maxs)
// clang-format on

/// Versions 1 and 2. kBadInput unless the file is complete; every size is checked before memory is allocated.
DecodedSplat decode_sog(const std::string& name, Bytes bytes);

/// Writes version 2, rows sorted along a Morton curve. Largest errors: position (1 + |p|) · (span of ln(1 + |p|)) /
/// 131070, opacity 1/510, rotation components except the largest 0.0028. Log scales and colours become the nearest of
/// 256 values that minimise the mean squared error. Up to 65536 distinct SH rows are kept, each coefficient as the
/// nearest of 256 values; more are clustered and replaced by means (codebook.h). Equal models give equal bytes.
std::vector<std::uint8_t> encode_sog(const SplatSelection& model);

// Writer of SuperSplat's compressed.ply: chunks of 256 Gaussians with the range of each value, 16 bytes per Gaussian
// quantised within these ranges, SH as bytes. Reader: io/ply/compressed_ply.cpp.

/// Rows are sorted along a Morton curve, so that chunks are small. Largest errors: chunk range / 4094 for x, z and the
/// first and third log scale; range / 2046 for y and the second log scale; range / 510 for rgb; 1/510 for opacity;
/// 0.0007 for rotation components except the largest; 1/64 for SH within ±3.97. Equal models give equal bytes.
std::vector<std::uint8_t> encode_compressed_ply(const SplatSelection& model);

/// Rows in chunks so wide that the quantisation error exceeds the Gaussians' size.
Rounding compressed_ply_rounding(const SplatSelection& model);

}  // namespace ngs::io
