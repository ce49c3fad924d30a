#include "contact_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "ngs/io/image/image_file.h"
#include "ngs/ops/image/image_bytes.h"

namespace ngs::scene_tool {
namespace {

constexpr int kSide_px = 200;                     // longer side of a picture on the sheet
constexpr int kGap_px = 8, kLabel_px = 20;        // between pictures; height of the label below
constexpr int kDigitColumns = 3, kDigitRows = 5;  // of the font
constexpr int kDot_px = 3;                        // a dot of the font
constexpr std::uint8_t kPaper = 245, kInk = 20;

/// One row of three dots per octal digit, the top row first.
constexpr std::array<int, 10> kDigits{075557, 026227, 071747, 071717, 055711, 074717, 074757, 071122, 075757, 075717};

}  // namespace

ContactSheet::ContactSheet(std::size_t count, int width_px, int height_px) {
  const double scale = std::min(1.0, double(kSide_px) / std::max(width_px, height_px));
  width_px_ = std::max(1, int(std::lround(scale * width_px)));
  height_px_ = std::max(1, int(std::lround(scale * height_px)));
  columns_ = std::max(1, int(std::ceil(std::sqrt(1.5 * double(count)))));
  const int rows = std::max(1, (int(count) + columns_ - 1) / columns_);
  sheet_ = ImageU8(columns_ * (width_px_ + kGap_px) + kGap_px, rows * (height_px_ + kLabel_px + kGap_px) + kGap_px, 3);
  std::ranges::fill(sheet_.data, kPaper);
}

void ContactSheet::add(std::size_t index, const ImageF& picture, const std::string& label) {
  const int x = kGap_px + int(index % std::size_t(columns_)) * (width_px_ + kGap_px);
  const int y = kGap_px + int(index / std::size_t(columns_)) * (height_px_ + kLabel_px + kGap_px);
  const ImageU8 small = to_bytes(io::resize_area(picture, width_px_, height_px_));
  for (int row = 0; row < height_px_; ++row)
    for (int column = 0; column < width_px_; ++column)
      for (int c = 0; c < 3; ++c) sheet_.at(x + column, y + row, c) = small.at(column, row, c);
  draw_label(x, y + height_px_ + (kLabel_px - kDigitRows * kDot_px) / 2, label);
}

void ContactSheet::draw_label(int x, int y, const std::string& label) {
  for (const char digit : label) {
    if (digit < '0' || digit > '9') continue;
    if (x + kDigitColumns * kDot_px > sheet_.width_px) return;
    const int dots = kDigits[std::size_t(digit - '0')];
    for (int row = 0; row < kDigitRows * kDot_px; ++row)
      for (int column = 0; column < kDigitColumns * kDot_px; ++column) {
        const int bit = 3 * (kDigitRows - 1 - row / kDot_px) + (kDigitColumns - 1 - column / kDot_px);
        if ((dots >> bit & 1) == 0) continue;
        for (int c = 0; c < 3; ++c) sheet_.at(x + column, y + row, c) = kInk;
      }
    x += (kDigitColumns + 1) * kDot_px;
  }
}

}  // namespace ngs::scene_tool
