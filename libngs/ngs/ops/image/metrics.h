#pragma once
// Agreement of a predicted mask with the true one: counts in, ratios out. Planes are row-major [H·W] bytes, nonzero =
// object; both planes of a pair have the same size. Counts are exact integers, so a score depends on the pixels alone.
//
// clang-format off
//   IoU             TP / (TP + FP + FN)
//   accuracy        (TP + TN) / all                     the papers' "Acc": background counts
//   class accuracy  mean recall over the classes that occur in the truth
//   boundary IoU    |P_d ∩ G_d| / |P_d ∪ G_d|           Cheng et al., CVPR 2021
//                   X_d: pixels of X whose chessboard distance to the complement is <= d; outside the image counts as
//                   complement. The same set as X minus X eroded d times by a 3x3 square.
//   contour F       2PR / (P + R)
//                   P: share of the prediction's contour pixels with a contour pixel of the truth within r (Euclidean).
//                   R: the same with truth and prediction exchanged.
//                   Contour: object pixels with a 4-neighbour inside the image that is not object. The image frame is
//                   therefore never a contour.
//                   r = ceil(0.008 · diagonal), as in DAVIS (Perazzi et al., CVPR 2016)
// clang-format on
//
// Degenerate pairs have defined scores and are flagged. Both masks empty: every score is 1. Exactly one empty: IoU,
// boundary IoU and contour F are 0.
//
// Void pixels have no true label (PASCAL VOC's 255). They are counted nowhere: not in TP to TN, in no band, as no pixel
// of a contour. Before contours are extracted, the truth gets the predicted label in void pixels. Neither mask then has
// an edge along a void that the prediction does not have (paper.md 5.15). A mask is empty if it contains no pixel that
// is not void.
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/scene/views.h"

namespace ngs {

/// A non-owning view of a mask.
struct MaskPlane {
  const std::uint8_t* data = nullptr;  // [H·W] nonzero = object
  int width_px = 0, height_px = 0;
  std::int64_t pixels() const { return std::int64_t(width_px) * height_px; }
};

struct Confusion {
  std::uint64_t tp = 0, fp = 0, fn = 0, tn = 0;  // without void pixels
  std::uint64_t total() const { return tp + fp + fn + tn; }
  bool both_empty() const { return tp + fp + fn == 0; }
  bool one_empty() const { return !both_empty() && (tp + fp == 0 || tp + fn == 0); }
};

/// Throws std::logic_error if the sizes differ.
Confusion confusion(const Exec& exec, MaskPlane predicted, MaskPlane truth);

double iou(const Confusion& counts);
double pixel_accuracy(const Confusion& counts);
double class_accuracy(const Confusion& counts);

enum class Outside : std::uint8_t { kComplement, kUnknown };

/// Chessboard distance of every object pixel to the nearest pixel that is not object; 0 outside the object.
/// Two raster passes. With Outside::kUnknown and no pixel outside the object, the distance is kUnbounded.
inline constexpr std::int32_t kUnbounded = 1 << 30;
std::vector<std::int32_t> chessboard_distance(MaskPlane mask, Outside outside = Outside::kComplement);

/// Chessboard distance of every pixel to the nearest pixel of the other side: positive in the object, negative outside,
/// never 0; kUnbounded in magnitude without a pixel of the other side.
std::vector<std::int32_t> signed_distance(MaskPlane mask);

/// Squared Euclidean distance, px², of every pixel to the nearest object pixel, 0 inside the object; kUnbounded for an
/// empty mask. Sides of at most 23000 px.
std::vector<std::int32_t> squared_distance(MaskPlane mask);

/// Width in px of the boundary band for a share of the diagonal: max(1, round(ratio · sqrt(h² + w²))), ties
/// to even as in the official Python.
int band_width_px(double ratio, int width_px, int height_px);

/// Boundary IoU at band width d, from the two distance maps; both bands empty -> 1.
double boundary_iou(const Exec& exec, const std::vector<std::int32_t>& predicted_distance,
                    const std::vector<std::int32_t>& truth_distance, int width_px, int band_px);

/// Contour F-score at a tolerance in px. 1 if neither mask has a contour, 0 if exactly one has. Contour pixels in
/// `is_void` (no data: none) can be matched, but are not counted.
double contour_f(MaskPlane predicted, MaskPlane truth, int tolerance_px, MaskPlane is_void = {});

/// All scores of one pair. score_values() lists them in the order of kScoreNames.
struct MaskScores {
  Confusion counts;
  double iou = 0, accuracy = 0, class_accuracy = 0;
  double biou = 0;      // 0.02 of the diagonal, the papers' B-IoU
  double biou_005 = 0;  // 0.005 of the diagonal
  double biou_1px = 0, biou_3px = 0, biou_5px = 0;
  double contour_f = 0;  // DAVIS tolerance
  // Wrong pixels farther from the truth's contour than the 0.02 band (chessboard distance). Far
  // false positives are leaks and floaters, far false negatives lost parts; the rest is contour error.
  std::uint64_t far_fp = 0, far_fn = 0;
  std::uint64_t void_px = 0;
  bool both_empty = false, one_empty = false;
};

inline constexpr std::array<std::string_view, 9> kScoreNames = {
    "iou", "accuracy", "class_accuracy", "biou", "biou_005", "biou_1px", "biou_3px", "biou_5px", "contour_f"};
std::array<double, kScoreNames.size()> score_values(const MaskScores& scores);

/// `contour_tolerance` is a share of the diagonal; `is_void` marks the void pixels, no data: there are none. Runs on
/// exec.threads threads; the result does not depend on them.
MaskScores score_mask(const Exec& exec, MaskPlane predicted, MaskPlane truth, double contour_tolerance = 0.008,
                      MaskPlane is_void = {});

/// The nearest-neighbour resize of the official evaluators (Pillow's NEAREST): the destination pixel's centre
/// is mapped into the source. Integer arithmetic, so every machine selects the same pixel.
template <class T>
std::vector<T> resized_nearest(const T* source, int source_width, int source_height, int width_px, int height_px) {
  std::vector<T> out;
  out.reserve(std::size_t(width_px) * std::size_t(height_px));
  for (std::int64_t y = 0; y < height_px; ++y) {
    const T* row = source + ((2 * y + 1) * source_height) / (2 * std::int64_t(height_px)) * source_width;
    for (std::int64_t x = 0; x < width_px; ++x)
      out.push_back(row[((2 * x + 1) * source_width) / (2 * std::int64_t(width_px))]);
  }
  return out;
}

// Similarity of two images. Values in [0, 1], any number of channels; sizes must agree.

/// Mean squared difference over pixels and channels, summed in double by rows. `weight` ([H, W, 1]) may be null;
/// NaN if all weights are 0.
double mean_squared_error(const Exec& exec, const ImageF& a, const ImageF& b, const ImageF* weight = nullptr);

/// -10 log10(MSE), dB; infinite for equal images.
double psnr_db(const Exec& exec, const ImageF& a, const ImageF& b, const ImageF* weight = nullptr);

/// The PSNR that reports give to equal images, the most that they give.
inline constexpr double kEqualPsnrDb = 100;

/// Mean SSIM, 3DGS's convention (ops/losses/photometric.h). With a weight, the mean over the weighted pixels; their
/// windows include the pixels around them.
double ssim_index(const Exec& exec, const ImageF& a, const ImageF& b, const ImageF* weight = nullptr);

// Errors of the opacity of an object, rendered alone: outside its true silhouette (halo), and missing inside (holes).

/// Tolerances of the contour: errors no farther than this from the silhouette's contour are not counted.
inline constexpr std::array<int, 4> kHaloBands_px = {1, 2, 3, 5};
/// Margin around occluders: the silhouette ends there, the object may not.
inline constexpr int kOccluderMargin_px = 4;

/// In px of full opacity per px of contour: the width of an opaque seam of equal area along the contour.
struct OpacityErrors {
  double contour_px = 0;  // silhouette pixels at its contour; 0: the errors are undefined, and 0
  std::array<double, kHaloBands_px.size()> halo_px{}, holes_px{};  // farther outside and inside than each band
};

/// `opacity`: [H, W] in [0, 1]; throws kNumeric for other values. Distances are chessboard distances; the image frame
/// is no contour. Pixels of `occluders` (no data: none) and within kOccluderMargin_px of them are not counted.
OpacityErrors opacity_errors(const std::vector<float>& opacity, MaskPlane silhouette, MaskPlane occluders = {});

}  // namespace ngs
