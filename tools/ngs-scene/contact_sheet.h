#pragma once
// All renders of ngs-scene orbit on one picture, each with the number in its name, to choose those to mark.
#include <string>

#include "ngs/scene/views.h"

namespace ngs::scene_tool {

class ContactSheet {
 public:
  /// For `count` pictures of one size.
  ContactSheet(std::size_t count, int width_px, int height_px);

  /// Draws picture `index` with its label: digits, others are left out.
  void add(std::size_t index, const ImageF& picture, const std::string& label);
  const ImageU8& picture() const { return sheet_; }

 private:
  void draw_label(int x, int y, const std::string& label);

  int columns_ = 1, width_px_ = 1, height_px_ = 1;  // of one picture on the sheet
  ImageU8 sheet_;
};

}  // namespace ngs::scene_tool
