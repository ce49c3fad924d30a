#pragma once
// Handles renders that a user painted on in place instead of on a copy.
#include <string>
#include <vector>

namespace ngs::ngs_tool {

/// Writes hashes of the images in `folder` to the file `record`.
void record_pictures(const std::string& folder, const std::string& record);

/// Names of images in a folder of renders that are the user's work.
struct PaintedPictures {
  std::vector<std::string> in_place;  // differ from `record`: they must be rendered again, because strokes are read as
                                      // the difference
  std::vector<std::string> other_format;  // saved next to a render in another format: 0000.jpg
  std::vector<std::string> unknown;       // called like no render

  std::vector<std::string> all() const;  // in_place and other_format
};

/// Copies images in place and in another format to the folder `copies`. Finds none without a record.
PaintedPictures rescue_painted(const std::string& folder, const std::string& record, const std::string& copies);

/// `strokes` with images in `folder`, and the folder itself, replaced by their copies, plus the copies of `painted`
/// that are not among them.
std::vector<std::string> strokes_on_copies(const std::vector<std::string>& strokes, const std::string& folder,
                                           const std::string& copies, const PaintedPictures& painted);

/// `strokes` without the files in `folder`, which were painted in place.
std::vector<std::string> not_in_folder(const std::vector<std::string>& strokes, const std::string& folder);

}  // namespace ngs::ngs_tool
