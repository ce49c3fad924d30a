#pragma once
// Pictures of a splat that somebody painted on in place, instead of on a copy.
#include <string>
#include <vector>

namespace ngs::front {

/// Writes down what the pictures in `folder` are, into the file `record`.
void record_pictures(const std::string& folder, const std::string& record);

/// Copies pictures that are no longer what `record` says to the folder `copies`, and returns their names. They have to
/// be made anew: the marks are what differs from them. None where there is no record.
std::vector<std::string> rescue_painted(const std::string& folder, const std::string& record,
                                        const std::string& copies);

/// `strokes` with the copies in place of pictures in `folder`, and with those of `painted` that are not among them.
std::vector<std::string> strokes_on_copies(const std::vector<std::string>& strokes, const std::string& folder,
                                           const std::string& copies, const std::vector<std::string>& painted);

}  // namespace ngs::front
