#pragma once
// A picture on which a person has painted: green is the object (G >= 128, R < 128), red the background (R >= 128,
// G < 128). Which pixels are paint is told in one of two ways:
//
//   paint on the photo   the picture has the photo's size and mostly its pixels; what differs is paint. Where it was
//                        compressed, only what is nearly pure green or red is, as compression makes colours beside a
//                        stroke
//   markers alone        transparent, grey or of one colour elsewhere, and each marker in its one colour
//
// Anything else is refused: a photo has green leaves and red flowers that nobody marked.
#include <string>

#include "ngs/scene/hand_prompt.h"

namespace ngs::io {

/// The marks of the picture at `path`. `photo` is the file of the view's photo, empty: none, then only markers alone
/// are understood. kBadInput where nothing is marked or the picture is neither of the two; the message has the shares.
HandPrompt read_painted_picture(const std::string& path, const std::string& photo);

}  // namespace ngs::io
