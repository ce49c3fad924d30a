#pragma once
// Handles renders that a user painted on in place instead of on a copy.
#include <string>
#include <vector>

namespace ngs::front {

/// Writes hashes of the images in `folder` to the file `record`.
void record_pictures(const std::string& folder, const std::string& record);

/// Copies images that differ from `record` to the folder `copies` and returns their names. They must be rendered again,
/// because strokes are read as the difference. Returns none without a record.
std::vector<std::string> rescue_painted(const std::string& folder, const std::string& record,
                                        const std::string& copies);

/// `strokes` with images in `folder` replaced by their copies, plus the copies of `painted` that are not among them.
std::vector<std::string> strokes_on_copies(const std::vector<std::string>& strokes, const std::string& folder,
                                           const std::string& copies, const std::vector<std::string>& painted);

/// `strokes` without the files in `folder`, which were painted in place.
std::vector<std::string> not_in_folder(const std::vector<std::string>& strokes, const std::string& folder);

}  // namespace ngs::front
