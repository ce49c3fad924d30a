#pragma once
// Charts as inline SVG, without scripts. Colours come from the page's CSS classes.
#include <cmath>
#include <string>
#include <vector>

namespace ngs::cli {

/// A bar for a table cell: value as a share of `largest`.
std::string bar_svg(double value, double largest);

struct PlotPoint {
  double x = 0, y = 0;
  std::string label;  // drawn next to the point if it fits, otherwise only its tooltip
  // Whiskers of a dot; NaN: none.
  double x_low = NAN, x_high = NAN, y_low = NAN, y_high = NAN;
};

struct PlotSeries {
  std::string name = {};
  std::vector<PlotPoint> points = {};
  bool line = true;  // false: separate dots
};

struct Plot {
  std::string title, x_label, y_label;  // the title is also the text alternative
  std::vector<PlotSeries> series;
  bool log_x = false;                  // points at x <= 0 are left out
  std::vector<PlotPoint> extent = {};  // not drawn; the axes include them
};

/// Axes with round ticks; non-finite points are left out. Empty without points.
std::string plot_svg(const Plot& plot);

}  // namespace ngs::cli
