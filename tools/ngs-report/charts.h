#pragma once
// Inline SVG without scripts. Colours come from the page's CSS classes.
#include <cmath>
#include <string>
#include <vector>

namespace ngs::cli {

/// A bar for a table cell: value as a share of `largest`.
std::string bar_svg(double value, double largest);

struct PlotPoint {
  double x = 0, y = 0;
  std::string label;  // written beside the point if not empty and there is room, else its tooltip
  // Whiskers of a dot; none where not given.
  double x_low = NAN, x_high = NAN, y_low = NAN, y_high = NAN;
};

struct PlotSeries {
  std::string name;
  std::vector<PlotPoint> points;
  bool line = true;  // else separate dots
};

struct Plot {
  std::string title, x_label, y_label;  // title is the text alternative too
  std::vector<PlotSeries> series;
  bool log_x = false;                // points at x <= 0 are left out
  std::vector<PlotPoint> room = {};  // not drawn; the axes have room for them
};

/// Axes with round ticks; points that are not finite are left out. Empty if nothing is left.
std::string plot_svg(const Plot& plot);

}  // namespace ngs::cli
