#include "charts.h"

#include <algorithm>
#include <limits>

#include "shared/page/html.h"

namespace ngs::cli {
namespace {

constexpr double kDecadesWithAllTicks = 3.2;  // above, tick labels would overlap
constexpr double kWidth = 560, kHeight = 300, kLeft = 78, kRight = 16, kTop = 14, kBottom = 48;

struct Axis {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  double step = 1;

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// Widens the range to round ticks, about four of them.
  void round_to_ticks() {
    if (!(high > low)) high = low + (low == 0 ? 1 : std::abs(low) * 0.1);
    const double rough = (high - low) / 4, power = std::pow(10, std::floor(std::log10(rough)));
    step = power * (rough / power < 1.5 ? 1 : rough / power < 3.5 ? 2 : rough / power < 7.5 ? 5 : 10);
    low = std::floor(low / step) * step;
    high = std::ceil(high / step) * step;
  }
  double share(double value) const { return (value - low) / (high - low); }
  int decimals() const { return std::clamp(int(-std::floor(std::log10(step) + 1e-9)), 0, 6); }
};

std::string text_svg(double x, double y, const char* anchor, const std::string& text) {
  return "<text x=" + decimal(x, 1) + " y=" + decimal(y, 1) + " text-anchor=" + anchor + ">" + escaped(text) +
         "</text>";
}

/// The k-th tick value of the series ..., 1, 2, 5, 10, 20, 50, ...; k = 0 is 1.
double tick_value(int k) {
  constexpr double kDigits[] = {1, 2, 5};
  const int power = int(std::floor(k / 3.0));
  return kDigits[k - 3 * power] * std::pow(10, power);
}
/// Index of the largest tick value <= `value` (> 0).
int last_tick_index(double value) {
  int k = 3 * int(std::floor(std::log10(value))) - 1;
  while (tick_value(k + 1) <= value * (1 + 1e-9)) ++k;
  return k;
}

struct Frame {
  Axis x, y;
  bool log_x = false;
  double across(double value) const { return log_x ? std::log10(value) : value; }
  double px(double value) const { return kLeft + x.share(across(value)) * (kWidth - kLeft - kRight); }
  double py(double value) const { return kHeight - kBottom - y.share(value) * (kHeight - kTop - kBottom); }
};

/// Ticks of the x axis; on a logarithmic axis 1, 2 and 5 of each decade.
std::vector<double> ticks_of(const Frame& frame) {
  std::vector<double> ticks;
  if (!frame.log_x)
    for (int i = 0; frame.x.low + i * frame.x.step <= frame.x.high + frame.x.step / 2; ++i)
      ticks.push_back(frame.x.low + i * frame.x.step);
  if (frame.log_x) {
    const bool powers_only = frame.x.high - frame.x.low > kDecadesWithAllTicks;
    for (int k = last_tick_index(std::pow(10, frame.x.low)); std::log10(tick_value(k)) <= frame.x.high + 1e-9; ++k)
      if (!powers_only || k % 3 == 0) ticks.push_back(tick_value(k));
  }
  return ticks;
}

std::string whiskers_svg(const PlotPoint& p, const Frame& frame) {
  const auto line = [](double x1, double y1, double x2, double y2) {
    return "<path class=whisker d=\"M" + decimal(x1, 1) + " " + decimal(y1, 1) + "L" + decimal(x2, 1) + " " +
           decimal(y2, 1) + "\" />";
  };
  std::string svg;
  if (p.x_low < p.x_high) svg += line(frame.px(p.x_low), frame.py(p.y), frame.px(p.x_high), frame.py(p.y));
  if (p.y_low < p.y_high) svg += line(frame.px(p.x), frame.py(p.y_low), frame.px(p.x), frame.py(p.y_high));
  return svg;
}

std::string axes_svg(const Plot& plot, const Frame& frame) {
  std::string svg;
  for (const double value : ticks_of(frame))
    svg += text_svg(frame.px(value), kHeight - kBottom + 18, "middle",
                    frame.log_x ? decimal(value, std::clamp(int(-std::floor(std::log10(value) + 1e-9)), 0, 6))
                                : decimal(value, frame.x.decimals()));
  for (int i = 0; frame.y.low + i * frame.y.step <= frame.y.high + frame.y.step / 2; ++i) {
    const double value = frame.y.low + i * frame.y.step, y = frame.py(value);
    svg += "<line class=grid x1=" + decimal(kLeft, 0) + " x2=" + decimal(kWidth - kRight, 0) + " y1=" + decimal(y, 1) +
           " y2=" + decimal(y, 1) + " />" + text_svg(kLeft - 8, y + 4, "end", decimal(value, frame.y.decimals()));
  }
  svg += text_svg((kLeft + kWidth - kRight) / 2, kHeight - 8, "middle", plot.x_label);
  svg += "<text transform=\"translate(14 " + decimal((kTop + kHeight - kBottom) / 2, 0) +
         ") rotate(-90)\" text-anchor=middle>" + escaped(plot.y_label) + "</text>";
  return svg;
}

struct Box {
  double left, top, right, bottom;
  bool overlaps(const Box& b) const { return left < b.right && b.left < right && top < b.bottom && b.top < bottom; }
};

/// Places labels next to their dots without overlap. One that does not fit remains the dot's tooltip only.
class Labels {
 public:
  Labels(const std::vector<PlotSeries>& series, const Frame& frame) {
    for (const PlotSeries& s : series)
      for (const PlotPoint& p : s.points)
        if (!s.line) taken_.push_back(around(frame.px(p.x), frame.py(p.y), kDotPx, kDotPx));
  }

  std::string place(double x, double y, const std::string& text) {
    const double half = 0.5 * kGlyphPx * double(text.size()), aside = half + 9;
    const bool left_half = x < kWidth / 2;
    for (const auto& [dx, dy] :
         {std::pair(left_half ? aside : -aside, 0.0), {left_half ? -aside : aside, 0.0}, {0.0, -14.0}, {0.0, 14.0}}) {
      const Box box = around(x + dx, y + dy, half, kLinePx / 2);
      if (box.left < kLeft || box.right > kWidth || box.top < 0 || box.bottom > kHeight - kBottom) continue;
      if (std::any_of(taken_.begin(), taken_.end(), [&](const Box& b) { return b.overlaps(box); })) continue;
      taken_.push_back(box);
      const char* anchor = dx > 0 ? "start" : dx < 0 ? "end" : "middle";
      return text_svg(dx > 0 ? box.left : dx < 0 ? box.right : x, y + dy + 4, anchor, text);
    }
    return {};
  }

 private:
  static constexpr double kGlyphPx = 8.3;  // mean glyph width of the wider system fonts
  static constexpr double kLinePx = 13, kDotPx = 5;
  static Box around(double x, double y, double half_x, double half_y) {
    return {x - half_x, y - half_y, x + half_x, y + half_y};
  }
  std::vector<Box> taken_;
};

std::string series_svg(const PlotSeries& series, const Frame& frame, std::size_t index, Labels& placed) {
  std::string points, labels;
  for (const PlotPoint& p : series.points) {
    const double x = frame.px(p.x), y = frame.py(p.y);
    points += decimal(x, 1) + "," + decimal(y, 1) + " ";
    if (series.line) continue;
    labels += whiskers_svg(p, frame) + "<circle r=5 cx=" + decimal(x, 1) + " cy=" + decimal(y, 1) + "><title>" +
              escaped(p.label) + "</title></circle>";
    if (!p.label.empty()) labels += placed.place(x, y, p.label);
  }
  std::string svg = "<g class=series" + std::to_string(index) + ">";
  if (series.line) {
    svg += "<polyline points=\"" + points + "\" />";
    const PlotPoint& last = series.points.back();
    labels = "<circle r=3.5 cx=" + decimal(frame.px(last.x), 1) + " cy=" + decimal(frame.py(last.y), 1) + " />";
    labels += text_svg(kWidth - kRight - 4, std::max(kTop + 12, frame.py(last.y) - 8), "end", series.name);
  }
  return svg + labels + "</g>";
}

}  // namespace

std::string bar_svg(double value, double largest) {
  const double share = largest > 0 && std::isfinite(value) ? std::clamp(value / largest, 0.0, 1.0) : 0;
  return "<svg class=bar viewBox=\"0 0 100 10\" preserveAspectRatio=none aria-hidden=true><rect width=" +
         decimal(std::max(100 * share, 0.4), 2) + " height=10 rx=0 /></svg>";
}

std::string plot_svg(const Plot& plot) {
  Frame frame;
  frame.log_x = plot.log_x;
  std::vector<PlotSeries> shown;
  for (PlotSeries series : plot.series) {
    std::erase_if(series.points, [&](const PlotPoint& p) {
      return !std::isfinite(p.x) || !std::isfinite(p.y) || (plot.log_x && !(p.x > 0));
    });
    for (const PlotPoint& p : series.points) {
      frame.x.include(frame.across(p.x));
      frame.y.include(p.y);
      if (p.x_low < p.x_high) {
        frame.x.include(frame.across(p.x_low));
        frame.x.include(frame.across(p.x_high));
      }
      if (p.y_low < p.y_high) {
        frame.y.include(p.y_low);
        frame.y.include(p.y_high);
      }
    }
    if (!series.points.empty()) shown.push_back(std::move(series));
  }
  if (shown.empty()) return {};
  for (const PlotPoint& p : plot.extent)
    if (std::isfinite(p.x) && std::isfinite(p.y) && (p.x > 0 || !plot.log_x)) {
      frame.x.include(frame.across(p.x));
      frame.y.include(p.y);
    }
  if (plot.log_x) {  // widen to the enclosing ticks
    frame.x.low = std::log10(tick_value(last_tick_index(std::pow(10, frame.x.low))));
    frame.x.high = std::log10(tick_value(last_tick_index(std::pow(10, frame.x.high)) + 1));
  } else {
    frame.x.round_to_ticks();
  }
  frame.y.round_to_ticks();
  std::string svg = "<svg class=plot role=img aria-label=\"" + escaped(plot.title) + "\" viewBox=\"0 0 " +
                    decimal(kWidth, 0) + " " + decimal(kHeight, 0) + "\"><title>" + escaped(plot.title) + "</title>" +
                    axes_svg(plot, frame);
  Labels labels(shown, frame);
  for (std::size_t i = 0; i < shown.size(); ++i) svg += series_svg(shown[i], frame, i, labels);
  return "<figure class=chart>" + svg + "</svg><figcaption>" + escaped(plot.title) + "</figcaption></figure>";
}

}  // namespace ngs::cli
