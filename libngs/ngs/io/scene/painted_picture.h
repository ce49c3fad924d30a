#pragma once
// A picture on which the user has painted: green is the object (G >= 128, R < 128), red is background (R >= 128,
// G < 128). Painted pixels are detected in one of two ways:
//
// clang-format off
//   paint on the photo   The picture has the photo's size and mostly its pixels; pixels that differ are paint. In a
//                        compressed picture only nearly pure green or red is paint, because compression changes the
//                        colours around a stroke. The same holds for a picture of another size and the same shape.
//   markers alone        The rest is transparent, grey or of one colour, and each marker has one colour.
// clang-format on
//
// Any other picture is rejected: green leaves and red flowers of a photo are not paint.
#include <string>

#include "ngs/scene/hand_prompt.h"

namespace ngs::io {

/// The marks of the picture at `path`. `photo` is the view's photo file; empty: only markers alone are accepted.
/// kBadInput if nothing is marked or the picture is of neither kind; the message contains the pixel shares.
HandPrompt read_painted_picture(const std::string& path, const std::string& photo);

}  // namespace ngs::io
